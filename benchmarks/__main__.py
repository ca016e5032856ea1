"""Measure, and write benchmarks/results: `python -m benchmarks [SECTION ...]`; other sections stay as they are.

python -m benchmarks diff [REVISION]                # what is worse or better than it was
python -m benchmarks mutants --sample 400 --seed 1  # do the tests notice faults?
"""

import os
import subprocess
import sys
from importlib import import_module

from . import results

SECTIONS = {
    "house": "The house itself",
    "wheel": "The wheel of a platform",
    "depth": "Depth",
    "texture": "Texture",
    "regions": "Regions that people draw",
    "photos": "Photographs",
    "drawings": "Drawings",
    "recognition": "Recognised by touch",
    "relief": "The relief of depth",
    "parts": "Parts of a picture",
    "export": "Export",
    "render": "Force laws",
    "methods": "Every method with its defaults",
    "servo": "The force loop",
    "servo_late": "How late the force loop is",
    "servo_faults": "Faults around the force loop",
    "batch": "Many scenes",
    "video": "Moving pictures",
    "record": "Recordings",
    "devices": "Devices",
    "ui": "The page",
    "page_to_send": "The sent page",
    "by_ear": "By ear",
    "study": "Studies with people",
    "tests": "The test run",
    "mutants": "Faults that the tests notice",
}


def main(names: list[str]) -> None:
    """Measure the named sections, or all; exit 1 if a promise is missed."""
    if names[:1] == ["diff"]:
        sys.exit(differences(*names[1:]))
    if names[:1] == ["mutants"] and names[1:]:
        sys.exit(import_module("benchmarks.mutants").main(names[1:]))
    if unknown := set(names) - set(SECTIONS):
        sys.exit(f"no section {', '.join(sorted(unknown))}; there are {', '.join(SECTIONS)}")
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # what is installed has its bytecode, and need not be compiled anew
    missed = False
    for name in names or SECTIONS:
        print(f"measuring {name} ...", file=sys.stderr)
        path = results.keep(name, SECTIONS[name], import_module(f"benchmarks.{name}").section())
        missed |= any(not met for _, _, met in results.promises(results.load(path)).values())
        print(path)
    sys.exit(missed)


def differences(revision: str = "HEAD") -> int:
    """Print what has changed since a revision; return 1 if something is worse, 2 for an unknown revision."""
    try:
        lines = list(results.diff(revision))
    except subprocess.CalledProcessError:
        print(f"no revision {revision}; name a commit, a branch or a tag", file=sys.stderr)
        return 2
    print("\n".join(lines) or f"every promise is met or missed as at {revision}")
    return int(any(line.startswith("WORSE") for line in lines))


if __name__ == "__main__":
    main(sys.argv[1:])

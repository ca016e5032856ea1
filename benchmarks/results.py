"""What was measured, as JSON: benchmarks/results/MACHINE/SECTION.json; and what has changed since a revision.

python -m benchmarks diff          # against the last commit
python -m benchmarks diff v0.1.0   # against a release
"""

import json
import os
import platform
import re
import subprocess
from collections.abc import Iterator
from datetime import date
from importlib.metadata import version
from pathlib import Path
from typing import Any

from tangible_bench.measuring.plan import machine
from tangible_core.files.writing import write_text

from .figures import table

ROOT = Path(__file__).parents[1]
RESULTS = Path(__file__).with_name("results")
VERSIONS = ("tangible-images", "numpy", "opencv-contrib-python-headless", "scikit-image", "numba", "pydantic", "typer")
JUDGED = ["what", "bound", "measured", ""]  # the columns of a table of promises (`figures.judged`)


def keep(name: str, title: str, markdown: str) -> Path:
    """Write a section that was measured on this machine now."""
    host = f"{machine()['processor']}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}"
    versions = {"python": platform.python_version()} | {each: version(each) for each in VERSIONS}
    result = {
        "title": title,
        "measured": str(date.today()),
        "machine": host,
        "versions": versions,
        "blocks": list(blocks(markdown)),
    }
    path = RESULTS / slug(host) / f"{name}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, as_text(result))
    return path


def load(path: Path) -> dict[str, Any]:
    """Read a section."""
    return json.loads(path.read_text("utf-8"))


def as_text(result: dict[str, Any]) -> str:
    """Write a result as JSON with a line for each row of a table.

    >>> print(as_text({"rows": [["1", "2"], ["3", "4"]]}), end="")
    {
     "rows": [
      ["1", "2"],
      ["3", "4"]
     ]
    }
    """
    text = json.dumps(result, indent=1, ensure_ascii=False)
    return re.sub(r"\[\n\s+([^\[\]{}]*?)\n\s+\]", lambda row: "[" + re.sub(r"\n\s+", " ", row[1]) + "]", text) + "\n"


def slug(host: str) -> str:
    """Return a folder's name for a machine.

    >>> slug("Intel(R) Xeon(R) Processor, 2 cores, Linux x86_64")
    'intel-xeon-2-cores'
    """
    kept = re.sub(r"\((r|tm)\)|processor|cpu|@.*?(?=,)", "", host.partition(" cores")[0].lower())
    return "-".join(re.findall(r"[a-z0-9]+", kept)) + "-cores"


def blocks(markdown: str) -> Iterator[dict[str, Any]]:
    """Yield the paragraphs and tables of a section in order.

    >>> list(blocks("Said.\\n\\n| a | b |\\n|---|---|\\n| 1 | 2 |"))
    [{'text': 'Said.'}, {'columns': ['a', 'b'], 'rows': [['1', '2']]}]
    """
    for paragraph in re.split(r"\n{2,}", markdown.strip()):
        lines = paragraph.splitlines()
        if len(lines) > 1 and lines[1].startswith("|---"):
            columns, _, *rows = [[cell.strip() for cell in line.strip()[1:-1].split("|")] for line in lines]
            yield {"columns": columns, "rows": rows}
        else:
            yield {"text": paragraph}


def newest() -> dict[str, dict[str, Any]]:
    """Return the newest result of each section, by its name."""
    results = [(path.stem, load(path)) for path in RESULTS.glob("*/*.json")]
    return dict(sorted(results, key=lambda named: named[1]["measured"]))


def promises(result: dict[str, Any]) -> dict[str, tuple[str, str, bool]]:
    """Return bound, measured figure and whether it is within the bound, of each promise of a section."""
    rows = [row for block in result["blocks"] if block.get("columns") == JUDGED for row in block["rows"]]
    return {what: (bound, measured, not missed) for what, bound, measured, missed in rows}


def markdown(result: dict[str, Any], level: str = "##") -> str:
    """Write a section to be read."""
    versions = ", ".join(f"{name} {each}" for name, each in result["versions"].items())
    parts = [f"{level} {result['title']}", f"{result['measured']}, {result['machine']}, {versions}."]
    for block in result["blocks"]:
        lines = block.get("text") or "\n".join(table(tuple(block["columns"]), map(tuple, block["rows"])))
        parts.append(re.sub(r"^#+", lambda marks: marks[0], lines))
    return "\n\n".join(parts)


def diff(revision: str = "HEAD") -> Iterator[str]:
    """Yield a line for each promise that was met and is missed since a revision, then for each that is met again.

    Raises: CalledProcessError for a revision that git does not know.
    """
    subprocess.run(["git", "rev-parse", "--verify", "-q", f"{revision}^{{commit}}"], cwd=ROOT, check=True, stdout=-3)
    lines: list[tuple[bool, str]] = []
    for path in sorted(RESULTS.glob("*/*.json")):
        place = path.relative_to(ROOT).as_posix()
        shown = subprocess.run(["git", "show", f"{revision}:{place}"], cwd=ROOT, capture_output=True, check=False)
        before = promises(json.loads(shown.stdout)) if shown.returncode == 0 else {}
        for what, (bound, measured, met) in promises(load(path)).items():
            _, was, was_met = before.get(what, (bound, measured, met))
            if met != was_met:
                lines.append(
                    (met, f"{'better' if met else 'WORSE'}: {path.stem}: {what} ({bound}): {was} -> {measured}")
                )
    yield from (line for _, line in sorted(lines))

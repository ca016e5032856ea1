"""Things of the house, each added to a copy of it: how many files one touches, and that they are enough."""

import os
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from .house_words import ROOT

Edit = Callable[[str], str]
COPIED = (
    "tangible",
    "tangible_core",
    "plugins/*/tangible_*",
    "examples/device",
    "pyproject.toml",
    "docs/how-to/export.md",
    "docs/how-to/devices.md",
)


def example(path: str) -> Edit:
    """Return the file of an example package, which stands in the house as it is; its maker's library is installed."""
    text = (ROOT / "examples" / path).read_text("utf-8").replace("from .maker", "from acme_handle.maker")
    return lambda _: text


def swap(old: str, new: str) -> Edit:
    """Return an edit of the one place where a text stands. Raises (the edit): ValueError if there is another number."""

    def edit(text: str) -> str:
        if text.count(old) != 1:
            raise ValueError(f"{old!r} stands {text.count(old)} times")
        return text.replace(old, new)

    return edit


def entry(kind: str, line: str, floor: str = "") -> Edit:
    """Return the edit of `pyproject.toml`: an entry point, and the floor of a family whose floors are listed."""
    head = f'[project.entry-points."tangible.{kind}"]\n'
    point = swap(head, f"{head}{line}\n")
    return lambda text: (swap(floor, f"contours | {floor}") if floor else str)(point(text))


# The edits that add a thing, by the files that they touch; texts in other languages are in the catalogue.
THINGS: Mapping[str, Mapping[str, Edit]] = {
    "device": {
        "plugins/devices/tangible_devices/handle.py": example("device/acme_handle/handle.py"),
        "pyproject.toml": entry("device", 'handle = "tangible_devices.handle:Handle"'),
        "docs/how-to/devices.md": lambda text: f"{text}\n## Acme's handle\n",
    },
    "exporter": {
        "plugins/export/tangible_export/contours.py": example("exporter/acme_contours/contours.py"),
        "pyproject.toml": entry("export", 'contours = "tangible_export.contours:Contours"', "glb | heights"),
        "docs/how-to/export.md": lambda text: f"{text}\n## Contours\n",
    },
    "option of a force law": {
        "plugins/render/tangible_render/penalty.py": lambda text: swap(
            '    dequantise: Filter = "auto"\n',
            "    share: Annotated[float, Field(gt=0, le=1)] = 1.0\n"
            '    """Share of the stiffness."""\n    dequantise: Filter = "auto"\n',
        )(swap("surface, self.stiffness_n_per_m)", "surface, self.share * self.stiffness_n_per_m)")(text))
    },
}


def add(thing: str, folder: Path) -> dict[str, str]:
    """Copy the house into a folder and add a thing there; return the environment in which the copy runs."""
    listed = subprocess.run(["git", "ls-files", "-z", *COPIED], cwd=ROOT, capture_output=True, text=True, check=True)
    for name in filter(None, listed.stdout.split("\0")):
        if (ROOT / name).exists():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / name, folder / name)
    for name, edit in THINGS[thing].items():
        path = folder / name
        path.write_text(edit(path.read_text("utf-8") if path.exists() else ""), "utf-8")
    _install(folder)
    packages = [folder, *sorted((folder / "plugins").iterdir()), folder / "examples/device"]
    return {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(map(str, packages)),
        "TANGIBLE_CACHE_DIR": str(folder / "cache"),
    }


def _install(folder: Path) -> None:
    project = tomllib.loads((folder / "pyproject.toml").read_text("utf-8"))["project"]
    info = folder / f"tangible_images-{project['version']}.dist-info"
    info.mkdir()
    head = f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n"
    (info / "METADATA").write_text(head, "utf-8")
    groups = [
        "\n".join([f"[{group}]", *(f"{name} = {target}" for name, target in points.items())])
        for group, points in project["entry-points"].items()
    ]
    (info / "entry_points.txt").write_text("\n".join(groups), "utf-8")


def fault(thing: str, command: Sequence[str], folder: Path) -> str:
    """Return the output of a command, or of the check of floors, that fails in a copy with a thing; or nothing."""
    environment = add(thing, folder)
    floors = "from importlinter.cli import lint_imports as lint; raise SystemExit(lint(no_cache=True, no_logo=True))"
    main = "from tangible_core.cli import main; main()"
    for words in (("-c", main, *command), ("-c", floors)):
        ran = subprocess.run(
            [sys.executable, *words], cwd=folder, env=environment, capture_output=True, text=True, check=False
        )
        if ran.returncode:
            return ran.stdout + ran.stderr
    return ""

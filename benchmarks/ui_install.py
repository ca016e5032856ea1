"""What the page adds to `pip install .`: built with npm, or left out where npm's registry cannot be reached."""

import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from pathlib import Path

from .figures import Figure, part

ROOT = Path(__file__).parents[1]
STATIC = "plugins/ui/tangible_ui/static"
RUNS = 3
NOWHERE = {"npm_config_registry": "http://127.0.0.1:9"}
"""Nobody listens there."""


def installing() -> Iterator[Figure]:
    """Seconds that a wheel takes, against one whose page is there already; in turn, medians of differences."""
    with tempfile.TemporaryDirectory(prefix="tangible-bench-") as folder:
        built, bare = Path(folder) / "built", Path(folder) / "bare"
        for tree in (built, bare):
            _copy(tree)
        shutil.copytree(ROOT / STATIC, built / STATIC)
        _build(built, {})
        times = [part(f"install {n + 1}", lambda: _round(built, bare)) for n in range(RUNS)]
    for what, bound_s, column in (("npm", 10, 1), ("npm's registry out of reach", 5, 2)):
        more_s = statistics.median(each[column] - each[0] for each in times)
        yield Figure(f"`pip install .`: {what}", f"<= {bound_s} s more", f"{more_s:+.1f} s", more_s <= bound_s)


def _round(built: Path, bare: Path) -> tuple[float, float, float]:
    return _build(built, {}), _build(bare, {}), _build(bare, NOWHERE)


def _copy(tree: Path) -> None:
    """Return the files of the project, without what was built."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True, text=True).stdout
    for name in filter(None, listed.split("\0")):
        (tree / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tree / name)


def _build(tree: Path, env: Mapping[str, str]) -> float:
    """Seconds to a wheel, in an environment that pip makes for it; the page is left as it was."""
    had_page = (tree / STATIC).is_dir()
    required = {name: value for name, value in os.environ.items() if name != "TANGIBLE_UI_REQUIRED"}
    with tempfile.TemporaryDirectory() as out:
        begun_s = time.monotonic()
        words = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", out, str(tree)]
        subprocess.run(words, env={**required, **env}, check=True)
        taken_s = time.monotonic() - begun_s
    if not had_page:
        shutil.rmtree(tree / STATIC, ignore_errors=True)
    return taken_s

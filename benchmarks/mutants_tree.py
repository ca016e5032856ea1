"""A tree of its own for each mutant, with an interpreter that knows no other, and what runs in it."""

import os
import shutil
import signal
import subprocess
import sys
import threading
import tomllib
import venv
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple, final

from .mutants_lists import Mutant, mutated

STARTS = """#!{python}
import sys
from {module} import {function}
sys.exit({function}())
"""


# The built page, which git does not know: tests of what is made of it need it.
BUILT = "plugins/web/tangible_web/static"


class Ended(NamedTuple):
    """How a program ended, None when it was not done in time, and what it said."""

    code: int | None
    said: str


def copy_of(root: Path, tree: Path) -> None:
    """Copy all that git knows or would add, as it stands in a checkout, and the built page; times are kept."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=root, check=True, capture_output=True).stdout
    for name in os.fsdecode(listed).split("\0"):
        if (root / name).is_file():
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / name, tree / name)
    if (root / BUILT).is_dir():
        shutil.copytree(root / BUILT, tree / BUILT)


@final
class Tree:
    """A copy of the sources in an environment of its own, as a test may start a program without our `PYTHONPATH`."""

    def __init__(self, folder: Path, shared: Path) -> None:
        """shared: where its force loops have their memory; a mutant may take away whatever lies there."""
        self.sources, self._venv, self._temporary = folder / "tree", folder / "venv", folder / "tmp"
        self._shared = shared

    def make(self) -> None:
        """Return the environment of the sources there: their folders first, then what is installed here."""
        self._temporary.mkdir()
        self._shared.mkdir()
        venv.create(self._venv, symlinks=True)
        (site,) = self._venv.glob("lib/python*/site-packages")
        installed = [each for each in sys.path if Path(each).name in ("site-packages", "dist-packages")]
        lines = [*(str(self.sources / each) for each in self._own()), *installed]
        (site / "tree.pth").write_text("\n".join(lines), encoding="utf-8")
        for name, target in self._config().get("project", {}).get("scripts", {}).items():
            module, _, function = target.partition(":")
            script = self._venv / "bin" / name
            script.write_text(STARTS.format(python=self.python, module=module, function=function), encoding="utf-8")
            script.chmod(0o755)

    def _own(self) -> list[str]:
        return self._config().get("tool", {}).get("hatch", {}).get("build", {}).get("dev-mode-dirs", ["."])

    def _config(self) -> dict[str, Any]:
        path = self.sources / "pyproject.toml"
        return tomllib.loads(path.read_text(encoding="utf-8")) if path.exists() else {}

    @property
    def python(self) -> Path:
        """Its interpreter."""
        return self._venv / "bin" / "python"

    def environ(self) -> dict[str, str]:
        """Chance is the same each time; bytecode is written: each tree begins with that of the tree without a fault."""
        places = {"TMPDIR": str(self._temporary), "TANGIBLE_SHARED_DIR": str(self._shared)}
        ours = {**places, "CI": "1", "PYTEST_TIMEOUT": "120"}
        unset = ("PYTHONPATH", "NUMBA_CACHE_DIR", "PYTHONDONTWRITEBYTECODE")
        return {k: v for k, v in os.environ.items() if k not in unset} | ours

    def pytest(self, programs: "Programs", tests: Sequence[str], limit_s: float) -> Ended:
        """Run the tests until the first failure."""
        command = [str(self.python), "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests]
        return programs.run(command, self.sources, self.environ(), limit_s)

    def put_in(self, mutant: Mutant) -> None:
        """Write the fault into a file of another time: what was compiled of it before is then not used."""
        path, text = self.sources / mutant.file, mutated(self.sources, mutant)
        later_ns = path.stat().st_mtime_ns + 2_000_000_000
        path.write_text(text, encoding="utf-8")
        os.utime(path, ns=(later_ns, later_ns))

    def owns(self, programs: "Programs", files: Iterable[str]) -> bool:
        """Whether the packages of these files are imported from here; a file in no package, as of docs, is read."""
        packages = {found for file in files if (found := self._package(Path(file)))}
        code = "import importlib, sys\nfor name in sys.argv[1:]: print(importlib.import_module(name).__file__)"
        ended = programs.run([str(self.python), "-c", code, *packages], self.sources, self.environ(), 60)
        return ended.code == 0 and all(Path(line).is_relative_to(self.sources) for line in ended.said.splitlines())

    def _package(self, file: Path) -> str:
        home = max((each for each in map(Path, self._own()) if file.is_relative_to(each)), key=lambda at: len(at.parts))
        first = file.relative_to(home).parts[0]
        is_package = first.endswith(".py") or (self.sources / home / first / "__init__.py").exists()
        return first.removesuffix(".py") if is_package else ""


@final
class Programs:
    """What is running, each with all that it started: `stop` ends every one, and lets no other begin."""

    def __init__(self) -> None:
        self._running: set[subprocess.Popen[bytes]] = set()
        self._lock = threading.Lock()
        self._stopped = False

    def run(self, command: Sequence[str], cwd: Path, environ: dict[str, str], limit_s: float) -> Ended:
        """Run a command with its output in a file: a pipe would wait for processes that it left behind."""
        with (Path(environ["TMPDIR"]) / "said.txt").open("w+b") as said:
            with self._lock:
                if self._stopped:
                    return Ended(None, "")
                program = subprocess.Popen(
                    command, cwd=cwd, env=environ, stdin=subprocess.DEVNULL, stdout=said, stderr=subprocess.STDOUT,
                    start_new_session=True,
                )  # fmt: skip
                self._running.add(program)
            try:
                code = program.wait(limit_s)
            except subprocess.TimeoutExpired:
                code = None
            finally:
                self._end(program)
            said.seek(0)
            return Ended(code, said.read().decode(errors="replace"))

    def stop(self) -> None:
        """End them all."""
        with self._lock:
            self._stopped = True
            for program in self._running:
                _kill(program)

    def _end(self, program: subprocess.Popen[bytes]) -> None:
        _kill(program)
        program.wait()
        with self._lock:
            self._running.discard(program)


def _kill(program: subprocess.Popen[bytes]) -> None:
    with suppress(ProcessLookupError):  # it is gone, and so is all that it started
        os.killpg(program.pid, signal.SIGKILL)

"""Machine code that comes with a wheel. Otherwise a first run waits for a compiler, or runs code that does not fit."""

import importlib
import json
import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from llvmlite import binding

from tangible_core.provenance import machine_code
from tangible_core.provenance.machine_code import CODE, FEATURES, INDEX, MANIFEST

BUILDER = Path(__file__).parents[3] / "deploy" / "platform_wheel.py"
KERNEL = "import numba\n\n@numba.njit('float64(float64)', cache=True)\ndef law(x):\n    return x * 3.0\n"
CALL = """
import logging, pathlib, tangible_core
from tangible_core.provenance import machine_code
logging.basicConfig(format="%(message)s")
machine_code.MACHINE_CODE = pathlib.Path("code")
from acme import law
print(law(2.0), "compiled" if law.stats.cache_misses else "loaded")
"""


class Machine:
    """A folder with a package, whose kernel is compiled into `cache`, and the machine code of a wheel in `code`."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.code, self.cache = folder, folder / "code", folder / "cache"
        (folder / "acme.py").write_text(KERNEL)
        self.run()
        program = [sys.executable, BUILDER, "--collect", self.cache, self.code]
        assert subprocess.check_output(program, text=True) == "1\n"
        self.cache.rename(folder / "builders")
        (index,) = self.code.glob(f"*{INDEX}")
        self.keys = pickle.loads(index.read_bytes())

    def run(self) -> tuple[str, str]:
        """Call the kernel in a process of its own: its words, and its warnings."""
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(self.cache), "PYTHONDONTWRITEBYTECODE": "1"}
        ran = subprocess.run(
            [sys.executable, "-c", CALL], cwd=self.folder, env=environment, text=True, capture_output=True, check=True
        )
        return ran.stdout.strip(), ran.stderr

    def loads(self) -> bool:
        """Whether a process that begins now would load the kernel from the wheel."""
        importlib.reload(machine_code)
        machine_code.MACHINE_CODE = self.code
        (index,) = self.code.glob(f"*{INDEX}")
        ((signature, hashes),) = self.keys
        return machine_code.find(index.name.removesuffix(INDEX), signature, hashes) is not None

    def change(self, **values: object) -> None:
        manifest = json.loads((self.code / MANIFEST).read_text())
        (self.code / MANIFEST).write_text(json.dumps(manifest | values))


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Machine:
    return Machine(tmp_path_factory.mktemp("machine"))


@pytest.fixture
def machine(built: Machine) -> Iterator[Machine]:
    """The machine, whose files are as they were after each test."""
    before = {path: path.read_bytes() for path in (*built.code.iterdir(), built.folder / "acme.py")}
    yield built
    for path, content in before.items():
        path.write_bytes(content)
    importlib.reload(machine_code)


def test_kernel_of_the_wheel_is_loaded_and_nothing_is_written(machine: Machine):
    before = {path: path.read_bytes() for path in machine.code.iterdir()}
    assert machine.loads()
    assert machine.run() == ("6.0 loaded", "")
    assert not [path for path in machine.cache.rglob("*") if path.is_file()]
    assert {path: path.read_bytes() for path in machine.code.iterdir()} == before


def flip(ending: str) -> Callable[[Machine], object]:
    def change(machine: Machine) -> None:
        (path,) = machine.code.glob(f"*{ending}")
        content = bytearray(path.read_bytes())
        content[len(content) // 2] ^= 1
        path.write_bytes(content)

    return change


DAMAGES: dict[str, Callable[[Machine], object]] = {
    "one bit of machine code": flip(CODE),
    "one bit of an index": flip(INDEX),
    "cut manifest": lambda machine: (machine.code / MANIFEST).write_text("{"),
    "unknown processor": lambda machine: machine.change(processor="abacus"),
    "code that is gone": lambda machine: next(machine.code.glob(f"*{CODE}")).unlink(),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_code_is_reported_and_not_loaded(machine: Machine, damage: str, caplog: pytest.LogCaptureFixture):
    DAMAGES[damage](machine)
    assert not machine.loads()
    assert str(machine.code) in caplog.text


def test_code_that_does_not_fit_is_not_loaded(machine: Machine, monkeypatch: pytest.MonkeyPatch):
    manifest = json.loads((machine.code / MANIFEST).read_text())
    for requirement in manifest["requirements"]:
        machine.change(requirements=manifest["requirements"] | {requirement: "another"})
        assert not machine.loads(), requirement
    machine.change(**manifest)
    monkeypatch.setattr(binding, "get_host_cpu_features", lambda: {"sse2": True})
    assert machine.loads() == (not FEATURES[manifest["processor"]])
    monkeypatch.undo()
    assert machine.loads()
    monkeypatch.setenv("NUMBA_OPT", "2")
    assert not machine.loads()


def test_edited_kernel_is_compiled_here(machine: Machine):
    (machine.folder / "acme.py").write_text(KERNEL.replace("3.0", "4.0"))
    assert machine.run() == ("8.0 compiled", "")


def test_kernel_whose_code_is_damaged_is_compiled_here(machine: Machine):
    flip(CODE)(machine)
    words, warning = machine.run()
    assert words == "6.0 compiled"
    assert "damaged" in warning

"""Errors of plugins. Otherwise the wrong package would be blamed, or a lack of memory would look like a fault."""

import re
import subprocess
import sys
from importlib import import_module
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest

from command_line import tangible
from tangible_core import Force, Relief
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.pipeline.engine.cache import Cache
from tangible_core.plugins import PlainTouch
from tangible_core.plugins.failures import Place, find_place, missing_package, sentence
from tangible_core.plugins.registry import Registry
from tangible_core.session.recording.files import READERS, read
from tangible_export import Heights
from tangible_report import Sheet


class Law(PlainTouch):
    """A force law that calls another one, or fails."""

    def __init__(self, other: PlainTouch | None = None) -> None:
        self.other = other

    def force(self, state: object) -> Force:
        return [][0] if self.other is None else self.other.force(state)  # pyright: ignore[reportArgumentType]


class Outer(Law):
    """A wrapper of another force law."""


@pytest.mark.usefixtures("unchecked_shapes")
def test_error_in_nested_plugins_names_the_innermost():
    with pytest.raises(IndexError) as raised:
        Outer(Law()).force((0, 0, 0))
    assert find_place(raised.value) == Place("render", __name__, "Law", "force")
    with pytest.raises(TypeError) as raised:
        CompiledTouch(None, ()).force((0, 0, 0))  # pyright: ignore[reportArgumentType]
    assert find_place(raised.value) is None, "an error of the core"


def test_missing_package_is_named_with_the_command_that_installs_it(monkeypatch: pytest.MonkeyPatch):
    gone = ModuleNotFoundError("No module named 'cv2.gone'", name="cv2.gone")
    assert missing_package(gone) is None, "its package is installed"
    monkeypatch.setattr("tangible_core.plugins.failures.find_spec", lambda name: None)
    for module, package in (("cv2.ximgproc", "opencv-contrib-python-headless"), ("acme", "acme")):
        error = ModuleNotFoundError(f"No module named {module!r}", name=module)
        assert sentence(error).endswith(f"{package}, which is not installed; pip install {package}")


def test_recording_without_scipy_is_not_called_damaged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "hand.nc").write_bytes(b"CDF\x02")
    monkeypatch.setitem(READERS, ".nc", lambda path: import_module("acme_that_is_not_there"))
    with pytest.raises(ModuleNotFoundError, match="acme"):
        read(tmp_path / "hand.nc")


WITHOUT_MEMORY = """
import resource
from tangible_core.plugins.failures import sentence
import numpy
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + (3 << 20),) * 2)
for fail in (lambda: numpy.zeros(10**8), lambda: __import__("cv2")):
    try:
        fail()
    except Exception as error:
        print(sentence(error))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux bounds the memory of a process")
def test_array_and_import_that_lack_memory_say_so_with_the_cure():
    done = subprocess.run([sys.executable, "-c", WITHOUT_MEMORY], capture_output=True, text=True)
    array, imported = done.stdout.splitlines()
    for line, kind in ((array, "MemoryError"), (imported, "ImportError")):
        assert re.match(rf"tangible ran out of memory \(_?(Array)?{kind}: ", line)
        assert line.endswith("end other programs, choose a smaller picture, or allow more memory")


def unmapped(*_: object) -> None:
    raise ImportError("_backend_agg.so: failed to map segment from shared object")


def test_lack_of_memory_is_a_mistake_and_keeps_what_is_made_or_cached(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    np.save(tmp_path / "h.npy", np.eye(8))
    monkeypatch.setattr(Sheet, "draw", unmapped)
    monkeypatch.setattr(Heights, "write", unmapped)
    done = tangible("run", "h.npy", "--set", "want=relief", "--out", "out", cwd=tmp_path)
    assert (done.returncode, done.stderr.count("ran out of memory")) == (2, 1)
    assert (tmp_path / "out/relief.npz").stat().st_size > 0
    done = tangible("export", "h.npy", "--to", "heights", "--out", "here", cwd=tmp_path)
    assert (done.returncode, done.stderr.count("ran out of memory")) == (2, 1)
    monkeypatch.setattr(EntryPoint, "load", unmapped)
    with pytest.raises(ImportError, match="failed to map segment"):
        Registry().load("depth", "semi-global")

    def no_memory(*_: object) -> None:
        raise MemoryError

    cache = Cache(tmp_path)
    cache.put("ab" * 32, Relief(np.zeros((2, 2), np.float32), (1.0, 1.0)))
    with monkeypatch.context() as patch, pytest.raises(MemoryError):
        patch.setattr(np, "empty", no_memory)
        cache.entry("ab" * 32)
    assert cache.entry("ab" * 32) is not None

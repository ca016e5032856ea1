"""The plugin that an error came from: the innermost one, or none for a fault of the core."""

from importlib import import_module
from pathlib import Path

import pytest

from tangible_core import Force
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.plugins import PlainTouch
from tangible_core.plugins.failures import Place, missing_package, place_of, sentence
from tangible_core.session.recording.files import READERS, read


class Law(PlainTouch):
    """A force law that calls another one, or fails."""

    def __init__(self, other: PlainTouch | None = None) -> None:
        self.other = other

    def force(self, state: object) -> Force:
        return [][0] if self.other is None else self.other.force(state)  # pyright: ignore[reportArgumentType]


class Outer(Law):
    """A wrapper of another force law."""


def test_error_in_nested_plugins_names_the_innermost():
    with pytest.raises(IndexError) as raised:
        Outer(Law()).force((0, 0, 0))
    assert place_of(raised.value) == Place("render", __name__, "Law", "force")


@pytest.mark.usefixtures("unchecked_shapes")
def test_error_of_the_core_has_no_plugin():
    touch = CompiledTouch(None, ())  # pyright: ignore[reportArgumentType]
    with pytest.raises(TypeError, match="'NoneType' object is not callable") as raised:
        touch.force((0, 0, 0))  # pyright: ignore[reportArgumentType]
    assert place_of(raised.value) is None


@pytest.mark.parametrize(("module", "package"), [("cv2.ximgproc", "opencv-contrib-python-headless"), ("acme", "acme")])
def test_missing_package_is_named_with_the_command_that_installs_it(
    module: str, package: str, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("tangible_core.plugins.failures.find_spec", lambda name: None)
    error = ModuleNotFoundError(f"No module named {module!r}", name=module)
    assert sentence(error) == f"tangible needs the package {package}, which is not installed; pip install {package}"


def test_missing_module_of_an_installed_package_is_no_missing_package():
    assert missing_package(ModuleNotFoundError("No module named 'cv2.gone'", name="cv2.gone")) is None


def test_recording_without_scipy_is_not_called_damaged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "hand.nc").write_bytes(b"CDF\x02")
    monkeypatch.setitem(READERS, ".nc", lambda path: import_module("acme_that_is_not_there"))
    with pytest.raises(ModuleNotFoundError, match="acme"):
        read(tmp_path / "hand.nc")

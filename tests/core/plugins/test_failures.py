"""The plugin that an error came from: the innermost one, or none for a fault of the core."""

import pytest

from tangible_core import Force
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.plugins import PlainTouch
from tangible_core.plugins.failures import Place, place_of


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

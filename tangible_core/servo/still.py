"""No force anywhere: what a loop begins with before there is a scene, so that it runs when the scene is made."""

from typing import Any, cast, final

from ..data import NO_FORCE, Force, HapticState
from ..plugins.interfaces import Touch
from ..plugins.touch import PlainTouch


def still() -> Touch:
    """A touch of no force, to start a `Servo` with and `swap` a scene in later. It imports no numba here.

    In the loop's process it is a kernel: while the scene is made ready there, no tick waits for Python.
    """
    return _Still()


@final
class _Still(PlainTouch):
    stiffness_n_per_m = 0.0

    def __reduce__(self) -> tuple[Any, ...]:
        return compiled, ()

    def force(self, state: HapticState) -> Force:
        return NO_FORCE


def compiled() -> Touch:
    """The same as a kernel."""
    from ..compiled.touch import CompiledTouch
    from . import still_kernels

    return CompiledTouch(cast(Any, still_kernels).tick, (), stiffness=0.0)

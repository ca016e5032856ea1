"""The null force law, with which a loop can start before its scene is made."""

from typing import Any, cast, final

from ...data import NO_FORCE, Force, HapticState
from ...plugins.interfaces import Touch
from ...plugins.touch import PlainTouch


def null_touch() -> Touch:
    """Return a touch without force, to start a `Servo` with and `swap` a scene in later; imports no numba."""
    return _NullTouch()


@final
class _NullTouch(PlainTouch):
    stiffness_n_per_m = 0.0

    def __reduce__(self) -> tuple[Any, ...]:
        return compile_null_touch, ()

    def force(self, state: HapticState) -> Force:
        return NO_FORCE


def compile_null_touch() -> Touch:
    """Return the null touch as a kernel."""
    from ...compiled.touch import CompiledTouch
    from . import null_law_kernels

    return CompiledTouch(cast(Any, null_law_kernels).tick, (), stiffness=0.0)

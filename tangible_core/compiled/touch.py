"""A touch and a link made of kernels: a tick of a force loop is then one compiled call without Python's lock."""

from abc import abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple, cast, final

import numpy as np
from jaxtyping import Float64

from ..data import Force, HapticState
from ..plugins.link import Link
from ..plugins.touch import Touch, path_arrays
from ..runtime.child_process import import_from, place

Tick = Callable[..., tuple[float, float, float]]
RISE_M, FRAME = 0, 1
"""The indices in `moving`: the rise of the surface under the proxy in this tick, m, and the number of the frame that
it moves to."""


@final
class CompiledTouch(Touch):
    """Forces from a kernel `tick(*fixed, x, y, z, vx, vy, vz) -> (fx, fy, fz)`, metres, metres per second, newtons.

    The kernel is a module's function under `numba.njit` with one given signature, `nogil=True` and `cache=True`. The
    state from tick to tick is `memory`, one of the fixed arguments, which the kernel writes to; its first three numbers
    are the proxy, with z NaN without contact. A touch without memory has no proxy. The motion of a moving surface is
    `moving` (`RISE_M`, `FRAME`), another of the fixed arguments; a static surface has rise 0 and frame NaN.

    Along a path, the velocity is the step from the position before divided by the period: 0 at the first one.
    """

    def __init__(
        self,
        tick: Tick,
        fixed: tuple[Any, ...],
        memory: Float64[np.ndarray, "n"] | None = None,
        stiffness: float | None = None,
        moving: Float64[np.ndarray, "2"] | None = None,
    ) -> None:
        self.tick = tick
        self.fixed = fixed
        self.memory: np.ndarray = np.full(3, np.nan) if memory is None else memory
        self.stiffness_n_per_m = stiffness
        self.moving: np.ndarray = _still() if moving is None else moving
        self._address: Any = None

    def __repr__(self) -> str:
        function = self.tick.py_func  # pyright: ignore[reportFunctionMemberAccess]
        return f"CompiledTouch({function.__module__}.{function.__qualname__})"

    def __reduce__(self) -> tuple[Any, ...]:
        function = self.tick.py_func  # pyright: ignore[reportFunctionMemberAccess]
        kernel = place(function.__module__, function.__qualname__)
        return _revive, (*kernel, self.fixed, self.memory, self.stiffness_n_per_m, self.moving)

    def force(self, state: HapticState) -> Force:
        """Return the force on the hand, N: always finite, zero in free air and for a state that is not finite."""
        return Force(*self.tick(*self.fixed, *state.position_m, *state.velocity_m_per_s))

    def path(self, positions_m: Float64[np.ndarray, "n 3"], period_s: float = 0.001) -> Float64[np.ndarray, "n 3"]:
        """Return the forces along positions one period apart."""
        from . import kernels

        positions, forces = path_arrays(positions_m, period_s)
        cast(Any, kernels).along(self.fixed, self.address(), positions, float(period_s), forces)
        return forces

    def address(self) -> Any:
        """Return the kernel as an argument of another one, which calls it with `*fixed` and a state."""
        if self._address is None:  # cached, as to find it takes half a millisecond
            from . import kernels

            self._address = kernels.Address(self.tick, kernels.signature(self.tick, (*self.fixed, *[0.0] * 6)))
        return self._address


def _still() -> Float64[np.ndarray, "2"]:
    return np.array([0.0, np.nan])


def motion_array(touch: Touch) -> Float64[np.ndarray, "2"]:
    """Return the motion of a touch's surface; that of a static surface if the touch has none."""
    return touch.moving if isinstance(touch, CompiledTouch) else _still()


def _revive(module: str, name: str, file: str, *arguments: Any) -> CompiledTouch:
    return CompiledTouch(import_from(module, name, file), *arguments)


class LinkKernels(NamedTuple):
    """The kernels of a device that a compiled loop calls, in the form that `CompiledTouch` takes."""

    read: Callable[..., int]
    """`read(*fixed, state) -> int` writes a fresh state, float64 (7,): x, y, z, vx, vy, vz, buttons; 0 without one."""
    write: Callable[..., None]
    """`write(*fixed, fx, fy, fz)` sets the force, which the device must be able to give."""
    fixed: tuple[Any, ...]


class CompiledLink(Link):
    """A link that decodes positions and encodes forces by kernels, in its own buffers."""

    @abstractmethod
    def kernels(self) -> LinkKernels:
        """Return the kernels, always the same while the link is open."""

    @property
    @abstractmethod
    def exchanges(self) -> bool:
        """True if `exchange` transfers the buffers; if not, another process does, and the loop needs no Python."""

    @abstractmethod
    def _exchange(self) -> None:
        """Do `exchange` on an open link. Raises: DeviceError if the device stopped answering."""

    @final
    def exchange(self) -> None:
        """Send the written data and fetch the data to read; once in a tick."""
        self._check_open()
        self._exchange()

"""A touch and a link made of kernels: a servo's tick is then one compiled call that holds no lock of Python's."""

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
"""Where, of what a touch tells of a surface that moves, stand: by how much it rose under the proxy in this tick, and
the number of the frame that it goes to."""


@final
class CompiledTouch(Touch):
    """Forces from a kernel `tick(*fixed, x, y, z, vx, vy, vz) -> (fx, fy, fz)`, metres, metres per second, newtons.

    The kernel is a module's function under `numba.njit` with one signature given, `nogil=True` and `cache=True`. What
    a touch remembers from tick to tick is `memory`, one of the fixed arguments, which the kernel writes to; its first
    three numbers are the proxy, with z NaN where nothing is touched. A touch without memory has no proxy. Of a surface
    that moves, the kernel tells in `moving` (`RISE_M`, `FRAME`), another of the fixed arguments; one that stands still
    has risen by 0, and is of frame NaN.

    Along a path the velocity is the step from the position before divided by the period: 0 at the first one.
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
        self.memory = np.full(3, np.nan) if memory is None else memory
        self.stiffness_n_per_m = stiffness
        self.moving = _still() if moving is None else moving
        self._address: Any = None

    def __reduce__(self) -> tuple[Any, ...]:
        function = self.tick.py_func  # pyright: ignore[reportFunctionMemberAccess]
        kernel = place(function.__module__, function.__qualname__)
        return _revive, (*kernel, self.fixed, self.memory, self.stiffness_n_per_m, self.moving)

    def force(self, state: HapticState) -> Force:
        """Newtons on the hand, always finite; zero in free air, and zero for a state that is not finite."""
        return Force(*self.tick(*self.fixed, *state.position_m, *state.velocity_m_per_s))

    def path(self, positions_m: Float64[np.ndarray, "n 3"], period_s: float = 0.001) -> Float64[np.ndarray, "n 3"]:
        """Forces along positions one period apart.

        Raises: GeometryError if the positions are not (n, 3), or the period is not above 0.
        """
        from . import kernels

        positions, forces = path_arrays(positions_m, period_s)
        cast(Any, kernels).along(self.fixed, self.address(), positions, float(period_s), forces)
        return forces

    def address(self) -> Any:
        """The kernel as an argument of another one, which calls it with `*fixed` and a state."""
        if self._address is None:  # kept, as finding it takes half a millisecond
            from . import kernels

            self._address = kernels.Address(self.tick, kernels.signature(self.tick, (*self.fixed, *[0.0] * 6)))
        return self._address


def _still() -> Float64[np.ndarray, "2"]:
    return np.array([0.0, np.nan])


def moving_of(touch: Touch) -> Float64[np.ndarray, "2"]:
    """What a touch tells of a surface that moves; of one that tells nothing, that it stands still."""
    return touch.moving if isinstance(touch, CompiledTouch) else _still()


def _revive(
    module: str,
    name: str,
    file: str,
    fixed: tuple[Any, ...],
    memory: np.ndarray,
    stiffness: float | None,
    moving: np.ndarray,
) -> CompiledTouch:
    return CompiledTouch(import_from(module, name, file), fixed, memory, stiffness, moving)


class LinkKernels(NamedTuple):
    """What a compiled loop calls of a device; kernels as `CompiledTouch` takes them."""

    read: Callable[..., int]
    """`read(*fixed, state) -> int` writes a fresh state, float64 (7,): x, y, z, vx, vy, vz, buttons; 0 if none is."""
    write: Callable[..., None]
    """`write(*fixed, fx, fy, fz)` sets the force, whose magnitude the device allows."""
    fixed: tuple[Any, ...]


class CompiledLink(Link):
    """A link that decodes positions and encodes forces by kernels, on buffers of its own."""

    @abstractmethod
    def kernels(self) -> LinkKernels:
        """The same for as long as the link is open."""

    @property
    @abstractmethod
    def exchanges(self) -> bool:
        """Whether the buffers travel by `exchange`; if not, others fill and empty them, and a loop needs no Python."""

    @abstractmethod
    def _exchange(self) -> None:
        """As `exchange`, of a link that is open. Raises: DeviceError if the device stopped answering."""

    @final
    def exchange(self) -> None:
        """Send what was written and fetch what is to be read; once a tick.

        Raises: DeviceError if the device stopped answering or the link is closed.
        """
        self._check_open()
        self._exchange()

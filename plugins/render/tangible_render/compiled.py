"""A touch of one compiled law, with the surface that it was compiled for."""

from collections.abc import Callable
from typing import Any, final

import numpy as np
from jaxtyping import Float64

from tangible_core.data import Force, HapticState
from tangible_core.errors import GeometryError
from tangible_core.interfaces import Touch


@final
class CompiledTouch(Touch):
    """Forces from `tick(*fixed, x, y, z, vx, vy, vz)` and, along a path, from `along(*fixed, positions, period, out)`.

    What a touch remembers from tick to tick is an array among the fixed arguments, which the law writes to. A compiled
    loop may call `tick` itself: like `along` it holds no lock of Python's.

    Along a path the velocity is the step from the position before divided by the period: 0 at the first one.
    """

    def __init__(
        self, tick: Callable[..., tuple[float, float, float]], along: Callable[..., None], fixed: tuple[Any, ...]
    ) -> None:
        self.tick = tick
        self.along = along
        self.fixed = fixed

    def force(self, state: HapticState) -> Force:
        """Newtons on the hand, always finite; zero in free air, and zero for a state that is not finite."""
        return Force(*self.tick(*self.fixed, *state.position_m, *state.velocity_m_per_s))

    def path(self, positions_m: Float64[np.ndarray, "n 3"], period_s: float = 0.001) -> Float64[np.ndarray, "n 3"]:
        """Forces along positions one period apart.

        Raises: GeometryError if the positions are not (n, 3), or the period is not above 0.
        """
        positions, forces = path_arrays(positions_m, period_s)
        self.along(*self.fixed, positions, period_s, forces)
        return forces


def path_arrays(
    positions_m: np.ndarray, period_s: float
) -> tuple[Float64[np.ndarray, "n 3"], Float64[np.ndarray, "n 3"]]:
    """The positions as a kernel reads them, and an array for the forces.

    Raises: GeometryError if the positions are not (n, 3), or the period is not above 0.
    """
    positions = np.ascontiguousarray(positions_m, np.float64)
    if positions.ndim != 2 or positions.shape[1] != 3:
        raise GeometryError(f"a path is (n, 3) positions in metres, not {positions.shape}")
    if not 0 < period_s < np.inf:
        raise GeometryError(f"a path's positions are period_s > 0 seconds apart, not {period_s}")
    return positions, np.empty_like(positions)

"""A film of `proxy`: the surface under it moves from one relief to the next within the ticks."""

from typing import Any, final

import numpy as np
from jaxtyping import Float32, Float64

from tangible_core.compiled import CompiledTouch, Tick
from tangible_core.data import HapticSurface, Relief
from tangible_core.errors import GeometryError
from tangible_core.plugins import Film

from ..surface.coefficients import BORDER, spline_coefficients
from ..surface.jumps import ROUNDING
from .filter_kernels import filter_coefficients, mark_jumps
from .scratch import MARGIN, TAPS, Scratch
from .slots import DROPPED, SPEED_M_PER_S, STEP_N, Slots
from .steady import initial_memory

# The bound of heights, m: float32 can take their differences, and no hand reaches them.
HIGHEST_M = 1e6


@final
class SplineFilm(Film):
    """A film whose memory is arrays read by the touch: one process may show frames and another render forces."""

    def __init__(self, touch: CompiledTouch, slots: Slots, extent_m: tuple[float, float], most_m: float) -> None:
        """Wrap the touch and its slots. most_m: the longest way of any place of the surface in a frame."""
        self._touch, self._slots, self._extent_m, self._most_m = touch, slots, extent_m, most_m
        self._scratch: Scratch | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        return SplineFilm, (self._touch, self._slots, self._extent_m, self._most_m)

    @property
    def touch(self) -> CompiledTouch:
        """The touch for a servo loop."""
        return self._touch

    def show(self, relief: Relief, frame: int) -> None:
        """Move the surface towards this relief, as far as it may go in a frame. Raises: GeometryError."""
        self._check(relief)
        if self._scratch is None:
            self._scratch = Scratch.of(*relief.height_m.shape)
        coefficients = quick_coefficients(relief.height_m, self._scratch)
        self._slots.show(coefficients, frame, self._most_m, self._scratch.ends)

    @property
    def arrived(self) -> bool:
        """True if the surface is the relief shown last, or moves all the way to it."""
        return self._slots.arrived

    @property
    def dropped(self) -> int:
        """The number of frames replaced by another before the loop reached them."""
        return int(self._slots.host_state[DROPPED])

    def _check(self, relief: Relief) -> None:
        rows, columns = self._slots.pairs.shape[1:3]
        shape = rows - 2 * BORDER, columns - 2 * BORDER
        if relief.height_m.shape == shape and tuple(relief.extent_m) == self._extent_m:
            return
        new, first = _grid(relief.height_m.shape, relief.extent_m), _grid(shape, self._extent_m)
        raise GeometryError(f"a frame has {new}, the first one {first}; all frames of a film need the same grid")


def create_film(
    surface: HapticSurface,
    tick: Tick,
    arguments: tuple[Any, ...],
    memory: Float64[np.ndarray, "n"],
    spring: tuple[float, float],
    period_s: float,
    frame_s: float,
) -> SplineFilm:
    """Return a film at rest on this surface. arguments, memory: the force law's; spring: its stiffness and damping."""
    (rows, columns), (width_m, length_m) = surface.height_m.shape, map(float, surface.extent_m)
    coefficients = quick_coefficients(surface.height_m, Scratch.of(rows, columns))
    count = max(1, round(frame_s / period_s))
    slots, moving = Slots.still(coefficients, count), np.zeros(2)
    shape = width_m, length_m, columns / width_m, rows / length_m
    film_arguments = slots.pairs, slots.tiles_m, slots.frames, slots.shared, float(count)
    touch = CompiledTouch(
        tick, (*film_arguments, *shape, *arguments, initial_memory(*spring), moving), memory, spring[0], moving
    )
    speed_m_per_s = min(SPEED_M_PER_S, STEP_N / (spring[0] * period_s))
    return SplineFilm(touch, slots, surface.extent_m, speed_m_per_s * count * period_s)


def _grid(shape: tuple[int, ...], extent_m: tuple[float, float]) -> str:
    (rows, columns), (width_m, length_m) = shape, extent_m
    return f"{columns} x {rows} cells over {1000 * width_m:.6g} x {1000 * length_m:.6g} mm"


def quick_coefficients(height_m: Float32[np.ndarray, "h w"], scratch: Scratch) -> Float32[np.ndarray, "h4 w4"]:
    """Compute `spline_coefficients` within a hundred-thousandth of the heights; jumps are detected and eased alike."""
    height_m, highest_m = np.ascontiguousarray(height_m), height_m.max()
    if highest_m > HIGHEST_M:
        height_m, highest_m = np.minimum(height_m, np.float32(HIGHEST_M)), np.float32(HIGHEST_M)
    if min(height_m.shape) <= MARGIN:
        return spline_coefficients(height_m)
    # By 21 taps in float32 in place of a recursion in float64 (Unser, Aldroubi & Eden 1993, sec. II-B), within
    # milliseconds; the result is the scratch's own array.
    mark_jumps(height_m, highest_m * ROUNDING, *scratch[:3])
    # Of a height in the coefficients of its own cell and of its neighbours; their sum is 1.
    weights = (np.sqrt(3) - 2) ** np.arange(TAPS + 1)
    taps = np.asarray(weights / (2 * weights.sum() - 1), np.float32)
    filter_coefficients(height_m, scratch.near, taps, scratch.values, scratch.smooth, scratch.coefficients)
    return scratch.coefficients

"""A film of `proxy`: the surface under it moves from one relief to the next within the ticks."""

import math
from typing import Any, final

from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import Relief
from tangible_core.data.arguments import as_number
from tangible_core.errors import ConfigError, GeometryError
from tangible_core.plugins.interfaces import Film

from ..surface.coefficients import BORDER
from .coefficients import Scratch, quick_coefficients
from .slots import DROPPED, Slots

SPEED_M_PER_S = 0.1
"""No place of a surface moves faster: a hand does not."""
STEP_N = 0.08
"""Nor so fast that the spring on a hand at rest changes by more in a tick, which a hand would feel as a knock."""


def checked(period_s: float, frame_s: float) -> tuple[float, float]:
    """Both as numbers. Raises: ConfigError if either is not positive and finite."""
    for name, value in (("period_s", period_s), ("frame_s", frame_s)):
        if not 0 < as_number(name, value) < math.inf:
            raise ConfigError(f"{name} is {value}; a film needs a positive number of seconds")
    return float(period_s), float(frame_s)


def most_m(stiffness_n_per_m: float, period_s: float, count: int) -> float:
    """How far any place of a surface may go in this many ticks, under a spring of this stiffness."""
    return min(SPEED_M_PER_S, STEP_N / (stiffness_n_per_m * period_s)) * count * period_s


@final
class SplineFilm(Film):
    """A film whose memory is arrays alone, which the touch reads: it may be shown in one process and felt in another.

    One at a time shows.
    """

    def __init__(self, touch: CompiledTouch, slots: Slots, extent_m: tuple[float, float], most_m: float) -> None:
        """most_m: how far any place of the surface may go in the time of a frame."""
        self._touch, self._slots, self._extent_m, self._most_m = touch, slots, extent_m, most_m
        self._scratch: Scratch | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        return SplineFilm, (self._touch, self._slots, self._extent_m, self._most_m)

    @property
    def touch(self) -> CompiledTouch:
        """What a loop feels."""
        return self._touch

    def show(self, relief: Relief, frame: int) -> None:
        """Where the surface goes from here, as far as it may in the time of a frame.

        Raises: GeometryError for a relief of another grid or extent than the first.
        """
        self._check(relief)
        if self._scratch is None:
            self._scratch = Scratch.of(*relief.height_m.shape)
        coefficients = quick_coefficients(relief.height_m, self._scratch)
        self._slots.show(coefficients, frame, self._most_m, self._scratch.ends)

    @property
    def arrived(self) -> bool:
        """Whether the surface is what was shown last, or goes all the way there."""
        return self._slots.arrived

    @property
    def dropped(self) -> int:
        """How many frames another took the place of before the loop went to them."""
        return int(self._slots.told[DROPPED])

    def _check(self, relief: Relief) -> None:
        rows, columns = self._slots.pairs.shape[1:3]
        shape = rows - 2 * BORDER, columns - 2 * BORDER
        if relief.height_m.shape == shape and tuple(relief.extent_m) == self._extent_m:
            return
        given, first = _grid(relief.height_m.shape, relief.extent_m), _grid(shape, self._extent_m)
        raise GeometryError(f"a frame has {given}, the first one {first}; all frames of a film need the same grid")


def _grid(shape: tuple[int, ...], extent_m: tuple[float, float]) -> str:
    (rows, columns), (width_m, length_m) = shape, extent_m
    return f"{columns} x {rows} cells over {1000 * width_m:.6g} x {1000 * length_m:.6g} mm"

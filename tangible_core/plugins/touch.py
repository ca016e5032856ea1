"""The touch: a force law on one surface, still or moving."""

from abc import ABC, abstractmethod
from functools import wraps
from typing import Any, final

import numpy as np
from jaxtyping import Float64

from ..data import Force, HapticState, HapticSurface, Relief
from ..data.arguments import as_force, as_state
from ..errors import GeometryError
from .naming import wrong_result


def guard_force(cls: type) -> None:
    """Wrap the `force` that a class of touches defines: three numbers do for a state and for a force."""
    own = cls.__dict__.get("force")
    if own is None or getattr(own, "__isabstractmethod__", False):
        return

    @wraps(own)
    def force(self: Any, state: HapticState) -> Force:
        result = own(self, state if type(state) is HapticState else as_state(state))
        if type(result) is Force:
            return result
        if (checked_force := as_force(result)) is None:
            raise wrong_result(self, "render", "force", result, Force)
        return checked_force

    setattr(cls, "force", force)  # noqa: B010 - the class is being made


class Touch(ABC):
    """A force law compiled for one surface; it may keep a state between calls, such as a proxy.

    A force law in plain Python is a `PlainTouch`, a law of kernels a `CompiledTouch`: both implement `path`.
    """

    stiffness_n_per_m: float | None = None
    """The greatest growth of the force with depth on level ground, N/m; 0 for a force law without a spring.

    The force of a law that is stiffer than the device renders stably is scaled by this number. With None, a copy is
    probed all over before the device is opened, and the steepest growth counts, that on slopes included.
    """

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        guard_force(cls)

    @abstractmethod
    def force(self, state: HapticState) -> Force:
        """Return the force on the hand in newtons, always finite: zero in free air, and for a state with NaN or inf."""

    @abstractmethod
    def path(self, positions_m: Float64[np.ndarray, "n 3"], period_s: float = 0.001) -> Float64[np.ndarray, "n 3"]:
        """Return the forces along positions one period apart, as `force` gives them in turn with its state.

        The velocity at each position is the step to it over the period; 0 at the first, and where it is not finite.
        """


class PlainTouch(Touch):
    """The base of a force law in plain Python, which implements `force` alone."""

    @final
    def path(self, positions_m: Float64[np.ndarray, "n 3"], period_s: float = 0.001) -> Float64[np.ndarray, "n 3"]:
        """Return the forces along positions one period apart, the first at time 0.

        Raises: GeometryError if the positions are not (n, 3), or the period is not positive and finite.
        """
        positions, forces = path_arrays(positions_m, period_s)
        with np.errstate(all="ignore"):
            velocities = np.diff(positions, axis=0, prepend=positions[:1]) / period_s
        velocities[~np.isfinite(velocities).all(axis=1)] = 0.0
        for i, ((x, y, z), (vx, vy, vz)) in enumerate(zip(positions.tolist(), velocities.tolist(), strict=True)):
            forces[i] = self.force(HapticState((x, y, z), (vx, vy, vz), i * period_s))
        return forces


def path_arrays(
    positions_m: np.ndarray, period_s: float
) -> tuple[Float64[np.ndarray, "n 3"], Float64[np.ndarray, "n 3"]]:
    """Return the positions in the layout of the kernels, and an array for the forces."""
    positions = np.ascontiguousarray(positions_m, np.float64)
    if positions.ndim != 2 or positions.shape[1] != 3:
        raise GeometryError(f"a path is (n, 3) positions in metres, not {positions.shape}")
    if not 0 < period_s < np.inf:
        raise GeometryError(f"period_s: is {period_s}; it must be positive and finite")
    return positions, np.empty_like(positions)


class Film(ABC):
    """A touch on a moving surface, which goes from one relief to the next within the ticks, without a jump.

    A loop takes it like a touch, and it can be sent to another process: the processes share its arrays, so that
    showing the next relief and the force loop never wait for each other.
    """

    @property
    @abstractmethod
    def touch(self) -> Touch:
        """The touch for the force loop."""

    @abstractmethod
    def show(self, relief: Relief, frame: int) -> None:
        """Move the surface to this relief within the time of a frame; an earlier relief that waits is dropped.

        A surface that would have to move too fast goes as far as it may, and has not arrived (`arrived`): then the
        same relief is to be shown again. frame: its number from 0, which ticks and recordings have.
        Raises: GeometryError for a relief of another grid or extent than the first.
        """

    @property
    @abstractmethod
    def arrived(self) -> bool:
        """True if the surface is at the relief that was shown last, or will be within the time of a frame."""

    @property
    @abstractmethod
    def dropped(self) -> int:
        """The number of frames that were replaced by a later one before the loop went to them."""


def as_touch(touch: Touch | Film) -> Touch:
    """Return the touch of a still or moving surface."""
    return touch.touch if isinstance(touch, Film) else touch


class Filming(ABC):
    """The capability of a force law to render a moving surface."""

    @abstractmethod
    def film(self, surface: HapticSurface, period_s: float = 0.001, frame_s: float = 1 / 30) -> Film:
        """Make a film that begins with this surface; its labels and materials stay in place.

        period_s: of the force loop. frame_s: the time in which the surface goes from one relief to the next.
        Raises: ConfigError if either is not positive and finite.
        """

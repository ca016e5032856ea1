"""A force law at work on one surface."""

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
    """Around a touch's `force`, if the class has one of its own: three numbers do for a state and for a force."""
    own = cls.__dict__.get("force")
    if own is None or getattr(own, "__isabstractmethod__", False):
        return

    @wraps(own)
    def force(self: Any, state: HapticState) -> Force:
        found = own(self, state if type(state) is HapticState else as_state(state))
        if type(found) is Force:
            return found
        if (made := as_force(found)) is None:
            raise wrong_result(self, "render", "force", found, Force)
        return made

    setattr(cls, "force", force)  # noqa: B010 - of a class that is made now


class Touch(ABC):
    """A renderer compiled for one surface; it may remember what it touched last, such as a proxy.

    A law in plain Python is a `PlainTouch`, one of kernels a `CompiledTouch`: both know the way along a path.
    """

    stiffness_n_per_m: float | None = None
    """The greatest by which its force grows with depth on level ground; 0 for a law that is no spring.

    A law stiffer than the device holds is softened by this number. None says nothing: then a copy is felt all over
    before the device is opened, and the steepest slope found counts, that of steep ground too.
    """

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        guard_force(cls)

    @abstractmethod
    def force(self, state: HapticState) -> Force:
        """Newtons on the hand, always finite; zero in free air, and zero for a state that is not finite."""

    @abstractmethod
    def path(self, positions_m: Float64[np.ndarray, "n 3"], period_s: float = 0.001) -> Float64[np.ndarray, "n 3"]:
        """Forces along positions one period apart, as `force` gives them one by one, state carried along.

        The velocity at each position is the step to it over the period; 0 at the first, and where it is not finite.
        """


class PlainTouch(Touch):
    """A law in plain Python, which is `force` alone."""

    @final
    def path(self, positions_m: Float64[np.ndarray, "n 3"], period_s: float = 0.001) -> Float64[np.ndarray, "n 3"]:
        """Forces along positions one period apart, the first at time 0.

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
    """The positions as a kernel reads them, and an array for the forces.

    Raises: GeometryError if the positions are not (n, 3), or the period is not positive and finite.
    """
    positions = np.ascontiguousarray(positions_m, np.float64)
    if positions.ndim != 2 or positions.shape[1] != 3:
        raise GeometryError(f"a path is (n, 3) positions in metres, not {positions.shape}")
    if not 0 < period_s < np.inf:
        raise GeometryError(f"period_s: is {period_s}; it must be positive and finite")
    return positions, np.empty_like(positions)


class Film(ABC):
    """A touch on a surface that goes from one relief to the next within the ticks, without a jump.

    It is given to a loop as a touch is, and can be sent to another process: its arrays are then the memory of both, so
    that whoever shows the next relief and the loop that feels it need not wait for each other.
    """

    @property
    @abstractmethod
    def touch(self) -> Touch:
        """What a loop feels."""

    @abstractmethod
    def show(self, relief: Relief, frame: int) -> None:
        """Where the surface goes from here, within the time of a frame; one that was shown before is dropped.

        Where it would have to move too fast for that, it goes as far as it may, and is not there yet (`arrived`): then
        the same is to be shown again. frame: its number, from 0, which ticks and recordings tell.
        Raises: GeometryError for a relief of another grid or extent than the first.
        """

    @property
    @abstractmethod
    def arrived(self) -> bool:
        """Whether the surface is, or will be within the time of a frame, what was shown last."""

    @property
    @abstractmethod
    def dropped(self) -> int:
        """How many frames were shown that the loop never went to, as a later one took their place."""


def touch_of(felt: Touch | Film) -> Touch:
    """What a loop feels, of a surface that stands still or moves."""
    return felt.touch if isinstance(felt, Film) else felt


class Filming(ABC):
    """For a force law that can be felt on a surface that moves."""

    @abstractmethod
    def film(self, surface: HapticSurface, period_s: float = 0.001, frame_s: float = 1 / 30) -> Film:
        """A film that begins with this surface, whose labels and materials stay where they are.

        period_s: of the loop that feels it. frame_s: the time in which the surface goes from one relief to the next.
        Raises: ConfigError if either is not positive and finite.
        """

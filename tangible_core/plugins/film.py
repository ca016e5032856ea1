"""A surface that moves under the hand: pictures that follow one another, felt."""

from abc import ABC, abstractmethod

from ..data import HapticSurface, Relief
from .touch import Touch


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

"""The capabilities: what a method may do next to the verb of its kind. A method has one by inheriting from it."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Self

import numpy as np
from jaxtyping import Float64, Int64
from pydantic import BaseModel

from ..data import DisparityMap, Finding, HapticSurface, Record, Unit, Views, Work


class Drawing(ABC):
    """The capability of an exporter that draws: the sheet of a run, and single products."""

    @abstractmethod
    def draw(self, work: Work, path: Path) -> str:
        """Draw all products of a work into a file, and return a description of the drawing. Raises: OutputError."""

    @abstractmethod
    def show(self, product: Record, axes: Any = None, **others: Any) -> Any:
        """Draw one product into matplotlib's axes, new ones for None, and return these.

        Raises: OutputError for a product without a picture.
        """


class Skippable(ABC):
    """For a depth or texture method that can tell that a scene does not need it."""

    @abstractmethod
    def skip(self, views: Views) -> str | None:
        """A reason, in words, not to run on these views; None to run. Cheap: it is asked for every plan."""


class Following(ABC):
    """For a depth method that looks for something before it matches, such as the range: a film has it found once."""

    @abstractmethod
    def follow(self, views: Views) -> Callable[[Views], DisparityMap]:
        """`estimate` for the frames of a film that these views begin.

        What they show of the cameras is kept for all that follow, which is quicker, and steadier: what is called may
        remember what it saw. It is called for the first frame as well.
        Raises: TangibleError as `estimate`.
        """


class Reshaping(ABC):
    """For a force law that feels another surface than the one that it is given: `preflight` judges the one felt."""

    @abstractmethod
    def felt(self, surface: HapticSurface) -> HapticSurface:
        """The surface as it is felt, of the same extent."""


class Serviceable(ABC):
    """For a device that can be looked for and examined without being opened for use."""

    @abstractmethod
    def connected(self) -> tuple[Unit, ...]:
        """The units that are there now. Raises: DeviceError if they cannot be looked for."""

    @abstractmethod
    def examine(self) -> Iterator[Finding]:
        """Everything that must be right before `open` succeeds, in the order in which to put it right."""


class Attended(ABC):
    """For a device whose hand is another program."""

    @abstractmethod
    def unattended(self) -> str | None:
        """In one line that nobody moves it now, and what to do; None if somebody does. Asked while it is open."""


class Scripted(ABC):
    """For a device whose hand follows a path that it knows."""

    @abstractmethod
    def over(self, extent_m: tuple[float, float]) -> Self:
        """The same, with a path within this width and length about its centre, where its options leave that open."""

    @abstractmethod
    def wanted(self, ticks: Int64[np.ndarray, " n"]) -> Float64[np.ndarray, "n 3"] | None:
        """Where its hand wants to be at these reads, the first of which is 0; None where that depends on more."""


class Adjustable(ABC):
    """For a device that its user must set up by hand."""

    @abstractmethod
    def home(self, say: Callable[[str], None]) -> None:
        """Guide the user until the device knows where it is; no force meanwhile.

        Raises: DeviceError if it is not there, or was not homed in time.
        """

    @abstractmethod
    def calibrate(self, ask: Callable[[str], str]) -> tuple[str, BaseModel]:
        """Measure this unit with the user's help: its serial number, and what to keep for it.

        `ask` shows a text and returns what the user answers. Raises: DeviceError as `open`, or if an answer or a
        measurement makes no sense.
        """

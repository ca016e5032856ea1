"""The capabilities: optional interfaces of methods next to that of their kind, acquired by inheritance."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Self

import numpy as np
from jaxtyping import Float64, Int64, UInt8
from pydantic import BaseModel

from ..data import DisparityMap, Finding, HapticSurface, Record, SegmentTree, Unit, Views, Work


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


class Previewing(ABC):
    """The capability of an exporter to show what its files would hold, without writing them."""

    @abstractmethod
    def preview(self, work: Work) -> UInt8[np.ndarray, "h w"]:
        """Return a picture of the files for eyes, white and black being 255 and 0. Raises: TangibleError as `write`."""


class Skippable(ABC):
    """The capability of a depth or texture method to detect that a scene does not need it."""

    @abstractmethod
    def skip(self, views: Views) -> str | None:
        """Return a reason, in words, not to run on these views; None to run. It must be cheap: every plan calls it."""


class Following(ABC):
    """The capability of a depth method to find the geometry of a film, such as its range, once for all frames."""

    @abstractmethod
    def follow(self, views: Views) -> Callable[[Views], DisparityMap]:
        """Return an `estimate` for the frames of a film, of which these views are the first.

        It keeps the geometry of the cameras, which is quicker and steadier, and may keep a state from frame to frame.
        It is called for the first frame as well.
        Raises: TangibleError as `estimate`.
        """


class Hierarchical(ABC):
    """The capability of a texture method to divide a picture into any number of segments at once."""

    @abstractmethod
    def tree(self, picture: np.ndarray) -> SegmentTree:
        """Return the regions of the picture, joined pair by pair. Raises: TangibleError as `segment`."""


class Reshaping(ABC):
    """The capability of a force law to render another surface than its argument; `preflight` checks that one."""

    @abstractmethod
    def felt(self, surface: HapticSurface) -> HapticSurface:
        """Return the rendered surface, of the same extent."""


class Serviceable(ABC):
    """The capability of a device to be found and examined without being opened for use."""

    @abstractmethod
    def connected(self) -> tuple[Unit, ...]:
        """Return the units that are connected now. Raises: DeviceError if they cannot be looked for."""

    @abstractmethod
    def examine(self) -> Iterator[Finding]:
        """Check everything that `open` needs, in the order in which to correct it."""


class Attended(ABC):
    """The capability of a device whose hand is another program."""

    @abstractmethod
    def unattended(self) -> str | None:
        """Return in one line that no program moves it now, with the cure, or None. Called while it is open."""


class Scripted(ABC):
    """The capability of a device whose hand follows a known path."""

    @abstractmethod
    def over(self, extent_m: tuple[float, float]) -> Self:
        """Return the device with a path of this width and length about its centre, where its options leave it open."""

    @abstractmethod
    def wanted(self, ticks: Int64[np.ndarray, " n"]) -> Float64[np.ndarray, "n 3"] | None:
        """Return the positions of the path at these reads, counted from 0; None where they depend on more than that."""


class Adjustable(ABC):
    """The capability of a device that its user must set up by hand."""

    @abstractmethod
    def home(self, say: Callable[[str], None]) -> None:
        """Guide the user until the device knows its position, without force.

        Raises: DeviceError if it is absent, or was not homed in time.
        """

    @abstractmethod
    def calibrate(self, ask: Callable[[str], str]) -> tuple[str, BaseModel]:
        """Measure this unit with the user's help, and return its serial number and its calibration.

        `ask` shows a text and returns the user's answer. Raises: DeviceError as `open`, or if an answer or a
        measurement makes no sense.
        """

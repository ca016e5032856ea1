"""The interfaces: a method is its options, a frozen model with one verb.

Methods are stateless; what keeps state is a session: `Touch` for a renderer, `Link` for a device.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from jaxtyping import Float64, Int64
from pydantic import BaseModel, ConfigDict

from ..data import (
    DeviceSpec,
    DisparityMap,
    Finding,
    HapticSurface,
    Kind,
    Record,
    SegmentMap,
    Unit,
    Views,
    Work,
)
from ..data.arguments import as_picture
from ..data.quantities import Quantities
from .film import Film as Film
from .film import Filming as Filming
from .film import touch_of as touch_of
from .link import Link as Link
from .touch import PlainTouch as PlainTouch
from .touch import Touch as Touch
from .verbs import guard_verb, taking


class Method(Quantities, ABC):
    """A named way of doing one stage; its fields are its options, and each has a default."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    version: ClassVar[int] = 1
    """Raise it when results change: it is part of the cache key."""
    expected_failures: ClassVar[Mapping[str, str]] = {}
    """Checks of the conformance kit that it does not keep, by name, each with the reason; they must then fail."""

    def reads(self) -> tuple[Path, ...]:
        """Files whose content its results depend on: those that its options name, unless it says more."""
        return tuple(value for _, value in self if isinstance(value, Path))


class DepthEstimator(Method):
    """Makes a disparity map from one picture or two."""

    needs_pair: ClassVar[bool] = False
    """True for a method that finds nothing without a right view: then a plan says so, and nothing is begun."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        guard_verb(cls, "depth", "estimate", DisparityMap, taking("views", Views, ", such as Views(left, right)"))

    @abstractmethod
    def estimate(self, views: Views) -> DisparityMap:
        """Disparity of the left view. Raises: TangibleError if these views do not allow it."""


class Segmenter(Method):
    """Divides a picture into parts of one texture each."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        guard_verb(cls, "texture", "segment", SegmentMap, partial(as_picture, "picture"))

    @abstractmethod
    def segment(self, picture: np.ndarray) -> SegmentMap:
        """Labels of the picture's own size. Raises: PictureError if it is no picture or holds NaN or infinity."""


class ForceRenderer(Method):
    """Turns positions into forces on a surface."""

    uses_materials: ClassVar[bool] = True
    """False for a law that feels heights alone: then no texture is segmented for it."""
    renders_materials: ClassVar[bool] = False
    """True for a law that renders friction, damping and fine textures of materials by itself."""
    is_lateral: ClassVar[bool] = False
    """True for a law of lateral forces alone: the normal force is the table's, under the hand."""
    why_still: ClassVar[str] = ""
    """Why it is no `Filming`, where one may wonder: words that go on "it feels no surface that moves"."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        guard_verb(cls, "render", "touch", Touch, taking("surface", HapticSurface, ", such as from_heights makes"))

    @abstractmethod
    def touch(self, surface: HapticSurface) -> Touch:
        """A new touch on this surface, free of contact."""


class HapticDevice(Method):
    """Something that has a position and gives a force."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        guard_verb(cls, "device", "spec", DeviceSpec)
        guard_verb(cls, "device", "open", Link)

    @abstractmethod
    def spec(self) -> DeviceSpec:
        """What the device can do; asks nothing of the hardware."""

    @abstractmethod
    def open(self) -> Link:
        """Raises: DeviceError if it is not there, not permitted or in use."""


Medium = Literal["swell", "print", "pins", "force"]
"""What a finger reads: swell paper, a solid that was printed, pins that rise, or a force device."""


class Exporter(Method):
    """Writes what was made as files for others: a printer, a pin display, a reader."""

    needs: ClassVar[tuple[str, ...]] = ()
    """Products that it writes or reads, such as `relief`: these are made for it, and no others."""
    medium: ClassVar[Medium | None] = None
    """What a finger reads of it, by whose rules it is checked before it is written; None for what is not felt."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        guard_verb(cls, "export", "write", tuple)

    def picture_width_m(self, aspect: float) -> float | None:
        """The width of the whole picture in the files, for which the products are made; None for the workspace's.

        aspect: width through length of the picture.
        """
        return None

    @abstractmethod
    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        """Write the files, and return their paths: `stem` with endings of its own, such as `stem.with_suffix`.

        It writes into a folder of its own; the files are moved to their place once all are there.
        Raises: TangibleError for what cannot be written of this work.
        """


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
    def over(self, extent_m: tuple[float, float]) -> HapticDevice:
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


KINDS: dict[Kind, type[Method]] = {
    "depth": DepthEstimator,
    "texture": Segmenter,
    "render": ForceRenderer,
    "device": HapticDevice,
    "export": Exporter,
}
"""What each kind of plugin must be."""

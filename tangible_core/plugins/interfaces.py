"""The interfaces of methods: a method is its options, a frozen model with one verb.

Methods are stateless; the state is in a session: `Touch` for a force law, `Link` for a device.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from functools import partial, wraps
from pathlib import Path
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np

from ..data import NO_FORCE as NO_FORCE
from ..data import DeviceSpec as DeviceSpec
from ..data import DisparityMap, HapticSurface, Kind, SegmentMap, Views
from ..data import Outcome as Outcome
from ..data import Plan as Plan
from ..data import Work as Work
from ..data.arguments import as_picture
from ..data.quantities import Quantities
from ..errors import wrong_argument
from ..runtime.threads import limited_threads
from .capabilities import Adjustable as Adjustable
from .capabilities import Attended as Attended
from .capabilities import Drawing as Drawing
from .capabilities import Following as Following
from .capabilities import Hierarchical as Hierarchical
from .capabilities import Previewing as Previewing
from .capabilities import Reshaping as Reshaping
from .capabilities import Scripted as Scripted
from .capabilities import Serviceable as Serviceable
from .capabilities import Skippable as Skippable
from .link import Link as Link
from .naming import wrong_result
from .touch import Film as Film
from .touch import Filming as Filming
from .touch import PlainTouch as PlainTouch
from .touch import Touch as Touch
from .touch import as_touch as as_touch

Convert = Callable[[Any], Any]


def taking(name: str, cls: type, hint: str = "") -> Convert:
    """Return a check of an argument's type. hint: how to make an object of it."""

    def convert(value: Any) -> Any:
        if not isinstance(value, cls):
            raise wrong_argument(name, value, f"a {cls.__name__}{hint}")
        return value

    return convert


class Verb(NamedTuple):
    """A verb of a kind of plugin, with the types of its argument and its result."""

    kind: str
    name: str
    returns: type
    # The conversion of each argument; None for a verb without arguments or with arbitrary ones.
    take: Convert | None = None


def guard_verb(cls: type, verb: Verb) -> None:
    """Wrap the verb that a class defines, if it does: arguments are converted, and the result's type is checked."""
    own = cls.__dict__.get(verb.name)
    if own is None or getattr(own, "__isabstractmethod__", False):
        return

    @wraps(own)
    def call(self: Any, *args: Any, **by_name: Any) -> Any:
        if verb.take is not None:
            args, by_name = tuple(map(verb.take, args)), {name: verb.take(value) for name, value in by_name.items()}
        with limited_threads():
            result = own(self, *args, **by_name)
        if not isinstance(result, verb.returns):
            raise wrong_result(self, verb.kind, verb.name, result, verb.returns)
        return result

    setattr(cls, verb.name, call)


class Method(Quantities, ABC):
    """A named way to do one stage; its fields are its options, each with a default."""

    version: ClassVar[int] = 1
    """A number to raise when a file that the method reads has changed: results are cached under it and the code."""
    expected_failures: ClassVar[Mapping[str, str]] = {}
    """Names of conformance checks that it does not pass, each with the reason; they must then fail."""
    verbs: ClassVar[tuple[Verb, ...]] = ()
    """The verbs of its kind, whose arguments and results are checked on every call."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        for verb in cls.verbs:
            guard_verb(cls, verb)

    def reads(self) -> tuple[Path, ...]:
        """Return the files whose content its results depend on: by default those that its options name."""
        return tuple(value for _, value in self if isinstance(value, Path))


class DepthEstimator(Method):
    """The interface of a method that makes a disparity map from one picture or two."""

    verbs: ClassVar[tuple[Verb, ...]] = (
        Verb("depth", "estimate", DisparityMap, taking("views", Views, ", such as Views(left, right)")),
    )

    needs_pair: ClassVar[bool] = False
    """True for a method that finds nothing without a right view: the plan then refuses it before anything is made."""
    finds_depth: ClassVar[bool] = True
    """False for a method that takes one picture's brightness for nearness: its surface is low and smooth by default."""

    @abstractmethod
    def estimate(self, views: Views) -> DisparityMap:
        """Estimate the disparity of the left view. Raises: TangibleError if these views do not allow it."""

    def rehearse(self) -> None:
        """Run late steps, which begin by `wait_for(LATE_STEPS)`, on made-up matches: another process compiles them."""


class Segmenter(Method):
    """The interface of a method that divides a picture into segments of one texture each."""

    verbs: ClassVar[tuple[Verb, ...]] = (Verb("texture", "segment", SegmentMap, partial(as_picture, "picture")),)

    @abstractmethod
    def segment(self, picture: np.ndarray) -> SegmentMap:
        """Label each pixel of the picture. Raises: PictureError if it is not a picture, or has NaN or infinity."""


class ForceRenderer(Method):
    """The interface of a force law: positions on a surface become forces."""

    verbs: ClassVar[tuple[Verb, ...]] = (
        Verb("render", "touch", Touch, taking("surface", HapticSurface, ", such as from_heights makes")),
    )

    uses_materials: ClassVar[bool] = True
    """False for a force law of heights alone, for which no texture is segmented."""
    renders_materials: ClassVar[bool] = False
    """True for a force law that renders friction, damping and fine textures of materials by itself."""
    is_lateral: ClassVar[bool] = False
    """True for a force law of lateral forces alone: the normal force is that of the table under the hand."""
    why_still: ClassVar[str] = ""
    """The reason, for the user, why the force law is not `Filming`; appended to the error message."""

    @abstractmethod
    def touch(self, surface: HapticSurface) -> Touch:
        """Make a touch on this surface that starts without contact."""


class HapticDevice(Method):
    """The interface of a device that has a position and applies a force."""

    verbs: ClassVar[tuple[Verb, ...]] = (Verb("device", "spec", DeviceSpec), Verb("device", "open", Link))

    @abstractmethod
    def spec(self) -> DeviceSpec:
        """Return the limits of the device, without access to the hardware."""

    @abstractmethod
    def open(self) -> Link:
        """Open the device. Raises: DeviceError if it is absent, not permitted or in use."""

    def follows(self, channel: str) -> bool:
        """Return True if another program moves the device through the channel of this name; by default none does."""
        return False


Medium = Literal["swell", "print", "pins", "force"]
"""A medium for fingers: swell paper, a printed solid, pins that rise, or a force device."""


class Exporter(Method):
    """The interface of a method that writes products as files: for a printer, a pin display, a reader."""

    verbs: ClassVar[tuple[Verb, ...]] = (Verb("export", "write", tuple),)

    needs: ClassVar[tuple[str, ...]] = ()
    """The products that it reads, such as `relief`; only these are made for it."""
    medium: ClassVar[Medium | None] = None
    """The medium by whose rules legibility is checked before writing; None for files that are not touched."""
    shows_texts: ClassVar[bool] = False
    """True if it writes what `Work.texts` say, where they have been read."""
    describes: ClassVar[bool] = False
    """True for words about the other files of an export: without a width of its own, it has that of the first solid
    beside it, else of the first page for swell paper, and it has the slopes of that."""
    limits_slopes: ClassVar[bool] = True
    """False for what is made of plastic or pins, where no hand is held up by a wall: unless the pipeline file sets
    `relief.slope`, cliffs of the relief stay upright."""

    def picture_width_m(self, aspect: float) -> float | None:
        """Return the width of the whole picture in the files, at which products are made; None for the workspace's.

        aspect: width through length of the picture.
        """
        return None

    def options_for_width(self, width_m: float, aspect: float) -> Mapping[str, Any]:
        """Return the options with which the picture is at least this wide; none if it cannot be."""
        return {}

    @abstractmethod
    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        """Write the files, and return their paths: `stem` with endings, such as `stem.with_suffix` makes.

        The folder of `stem` is temporary; the files are moved to their place once all are complete.
        Raises: TangibleError for a work that cannot be written.
        """


KINDS: dict[Kind, type[Method]] = {
    "depth": DepthEstimator,
    "texture": Segmenter,
    "render": ForceRenderer,
    "device": HapticDevice,
    "export": Exporter,
}

"""The interfaces: a method is its options, a frozen model with one verb.

Methods are stateless; what keeps state is a session: `Touch` for a renderer, `Link` for a device.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from functools import partial, wraps
from pathlib import Path
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import ConfigDict

from ..data import (
    DeviceSpec,
    DisparityMap,
    HapticSurface,
    Kind,
    SegmentMap,
    Views,
    Work,
)
from ..data.arguments import as_picture
from ..data.quantities import Quantities
from ..errors import wrong_argument
from ..runtime.threads import limited_threads
from .capabilities import Adjustable as Adjustable
from .capabilities import Attended as Attended
from .capabilities import Drawing as Drawing
from .capabilities import Following as Following
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
from .touch import touch_of as touch_of

Convert = Callable[[Any], Any]


def taking(name: str, wanted: type, hint: str = "") -> Convert:
    """What takes an argument of one type alone. hint: how to make one."""

    def convert(value: Any) -> Any:
        if not isinstance(value, wanted):
            raise wrong_argument(name, value, f"a {wanted.__name__}{hint}")
        return value

    return convert


class Verb(NamedTuple):
    """A verb of a kind of plugin: what it takes and what it returns."""

    kind: str
    name: str
    returns: type
    take: Convert | None = None
    """Converts each argument; None for a verb without arguments, or of any."""


def guard_verb(cls: type, verb: Verb) -> None:
    """Wrap a class's own verb, if it has one: arguments are converted, and the result is of the verb's type.

    A caller gets a BrokenMethod that names the plugin in place of a result of another type.
    """
    own = cls.__dict__.get(verb.name)
    if own is None or getattr(own, "__isabstractmethod__", False):
        return

    @wraps(own)
    def guarded(self: Any, *given: Any, **by_name: Any) -> Any:
        if verb.take is not None:
            given, by_name = tuple(map(verb.take, given)), {name: verb.take(each) for name, each in by_name.items()}
        with limited_threads():
            result = own(self, *given, **by_name)
        if not isinstance(result, verb.returns):
            raise wrong_result(self, verb.kind, verb.name, result, verb.returns)
        return result

    setattr(cls, verb.name, guarded)


class Method(Quantities, ABC):
    """A named way of doing one stage; its fields are its options, and each has a default."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    version: ClassVar[int] = 1
    """Raise it when results change: it is part of the cache key."""
    expected_failures: ClassVar[Mapping[str, str]] = {}
    """Checks of the conformance kit that it does not keep, by name, each with the reason; they must then fail."""
    verbs: ClassVar[tuple[Verb, ...]] = ()
    """The verbs of its kind: each is given and gives what the interface says, or a BrokenMethod names the plugin."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        for verb in cls.verbs:
            guard_verb(cls, verb)

    def reads(self) -> tuple[Path, ...]:
        """Files whose content its results depend on: those that its options name, unless it says more."""
        return tuple(value for _, value in self if isinstance(value, Path))


class DepthEstimator(Method):
    """Makes a disparity map from one picture or two."""

    verbs: ClassVar = (Verb("depth", "estimate", DisparityMap, taking("views", Views, ", such as Views(left, right)")),)

    needs_pair: ClassVar[bool] = False
    """True for a method that finds nothing without a right view: then a plan says so, and nothing is begun."""

    @abstractmethod
    def estimate(self, views: Views) -> DisparityMap:
        """Disparity of the left view. Raises: TangibleError if these views do not allow it."""


class Segmenter(Method):
    """Divides a picture into parts of one texture each."""

    verbs: ClassVar = (Verb("texture", "segment", SegmentMap, partial(as_picture, "picture")),)

    @abstractmethod
    def segment(self, picture: np.ndarray) -> SegmentMap:
        """Labels of the picture's own size. Raises: PictureError if it is no picture or holds NaN or infinity."""


class ForceRenderer(Method):
    """Turns positions into forces on a surface."""

    verbs: ClassVar = (
        Verb("render", "touch", Touch, taking("surface", HapticSurface, ", such as from_heights makes")),
    )

    uses_materials: ClassVar[bool] = True
    """False for a law that feels heights alone: then no texture is segmented for it."""
    renders_materials: ClassVar[bool] = False
    """True for a law that renders friction, damping and fine textures of materials by itself."""
    is_lateral: ClassVar[bool] = False
    """True for a law of lateral forces alone: the normal force is the table's, under the hand."""
    why_still: ClassVar[str] = ""
    """Why it is no `Filming`, where one may wonder: words that go on "it feels no surface that moves"."""

    @abstractmethod
    def touch(self, surface: HapticSurface) -> Touch:
        """A new touch on this surface, free of contact."""


class HapticDevice(Method):
    """Something that has a position and gives a force."""

    verbs: ClassVar = (Verb("device", "spec", DeviceSpec), Verb("device", "open", Link))

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

    verbs: ClassVar = (Verb("export", "write", tuple),)

    needs: ClassVar[tuple[str, ...]] = ()
    """Products that it writes or reads, such as `relief`: these are made for it, and no others."""
    medium: ClassVar[Medium | None] = None
    """What a finger reads of it, by whose rules it is checked before it is written; None for what is not felt."""

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


KINDS: dict[Kind, type[Method]] = {
    "depth": DepthEstimator,
    "texture": Segmenter,
    "render": ForceRenderer,
    "device": HapticDevice,
    "export": Exporter,
}
"""What each kind of plugin must be."""

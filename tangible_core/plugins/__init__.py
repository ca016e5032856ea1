"""The interfaces of plugins, the registry of installed ones, and the hooks.

Authors of plugins need the names below; each is imported when first used.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ..lazily import lazily

if TYPE_CHECKING:
    from ..data import DeviceSpec as DeviceSpec
    from ..data import Outcome as Outcome
    from ..data import Plan as Plan
    from ..data import Work as Work
    from ..data.device import NO_FORCE as NO_FORCE
    from .capabilities import Adjustable as Adjustable
    from .capabilities import Attended as Attended
    from .capabilities import Drawing as Drawing
    from .capabilities import Following as Following
    from .capabilities import Reshaping as Reshaping
    from .capabilities import Scripted as Scripted
    from .capabilities import Serviceable as Serviceable
    from .capabilities import Skippable as Skippable
    from .hooks import Panel as Panel
    from .hooks import hookimpl as hookimpl
    from .interfaces import DepthEstimator as DepthEstimator
    from .interfaces import Exporter as Exporter
    from .interfaces import ForceRenderer as ForceRenderer
    from .interfaces import HapticDevice as HapticDevice
    from .interfaces import Medium as Medium
    from .interfaces import Method as Method
    from .interfaces import Segmenter as Segmenter
    from .link import Link as Link
    from .touch import Film as Film
    from .touch import Filming as Filming
    from .touch import PlainTouch as PlainTouch
    from .touch import Touch as Touch

__getattr__: Callable[[str], Any]
__all__, __getattr__ = lazily(  # pyright: ignore[reportUnsupportedDunderAll]
    __name__,
    {
        ".data": ["DeviceSpec", "Outcome", "Plan", "Work"],
        ".data.device": ["NO_FORCE"],
        "capabilities": [
            "Adjustable", "Attended", "Drawing", "Following", "Reshaping", "Scripted", "Serviceable",
            "Skippable",
        ],
        "hooks": ["Panel", "hookimpl"],
        "interfaces": ["DepthEstimator", "Exporter", "ForceRenderer", "HapticDevice", "Medium", "Method", "Segmenter"],
        "link": ["Link"],
        "touch": ["Film", "Filming", "PlainTouch", "Touch"],
    },
)  # fmt: skip

"""Tangible Images: turn pictures into something one can feel.

The names below are fixed: other people's programs call them. Each is imported when first used, so that
`tangible --help` does not wait for numpy.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .provenance.watching import watch_numba

if TYPE_CHECKING:
    from .data import Calibration as Calibration
    from .data import DeviceSpec as DeviceSpec
    from .data import DisparityMap as DisparityMap
    from .data import Force as Force
    from .data import HapticState as HapticState
    from .data import HapticSurface as HapticSurface
    from .data import Material as Material
    from .data import MaterialMap as MaterialMap
    from .data import Outcome as Outcome
    from .data import Plan as Plan
    from .data import Relief as Relief
    from .data import SegmentMap as SegmentMap
    from .data import Views as Views
    from .errors import TangibleError as TangibleError
    from .pipeline.engine import load_pipeline as load_pipeline
    from .plugins.hooks import hookimpl as hookimpl
    from .plugins.interfaces import DepthEstimator as DepthEstimator
    from .plugins.interfaces import ForceRenderer as ForceRenderer
    from .plugins.interfaces import HapticDevice as HapticDevice
    from .plugins.interfaces import Link as Link
    from .plugins.interfaces import PlainTouch as PlainTouch
    from .plugins.interfaces import Segmenter as Segmenter
    from .plugins.interfaces import Skippable as Skippable
    from .plugins.interfaces import Touch as Touch
    from .plugins.registry import load_method as load_method

_ROOMS = {
    "data": (
        "Calibration", "DeviceSpec", "DisparityMap", "Force", "HapticState", "HapticSurface", "Material",
        "MaterialMap", "Outcome", "Plan", "Relief", "SegmentMap", "Views",
    ),
    "pipeline.engine": ("load_pipeline",),
    "errors": ("TangibleError",),
    "plugins.hooks": ("hookimpl",),
    "plugins.interfaces": (
        "DepthEstimator", "ForceRenderer", "HapticDevice", "Link", "PlainTouch", "Segmenter", "Skippable", "Touch",
    ),
    "plugins.registry": ("load_method",),
}  # fmt: skip
_HOME = {name: room for room, names in _ROOMS.items() for name in names}

__all__ = sorted(_HOME)  # pyright: ignore[reportUnsupportedDunderAll]

watch_numba()


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f".{_HOME[name]}", __name__), name)
    globals()[name] = value
    return value

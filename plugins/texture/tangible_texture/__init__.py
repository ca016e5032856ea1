"""Texture segmenters: a picture to segments of one texture each. Each method is imported when it is first used."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from tangible_core.lazily import lazily

if TYPE_CHECKING:
    from .gabor import Gabor as Gabor
    from .gradient import Gradient as Gradient
    from .hierarchy import Hierarchy as Hierarchy
    from .histogram import Histogram as Histogram
    from .kornia_gabor import KorniaGabor as KorniaGabor
    from .kornia_gradient import KorniaGradient as KorniaGradient
    from .report import Report as Report

__getattr__: Callable[[str], Any]
__all__, __getattr__ = lazily(  # pyright: ignore[reportUnsupportedDunderAll]
    __name__,
    {
        "gabor": ["Gabor"],
        "gradient": ["Gradient"],
        "hierarchy": ["Hierarchy"],
        "histogram": ["Histogram"],
        "kornia_gabor": ["KorniaGabor"],
        "kornia_gradient": ["KorniaGradient"],
        "report": ["Report"],
    },
)

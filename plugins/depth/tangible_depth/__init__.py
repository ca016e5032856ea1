"""Depth estimators, from pictures to disparity. Each method is imported when it is first used."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from tangible_core.lazily import lazily

if TYPE_CHECKING:
    from .auto import Auto as Auto
    from .contour import Contour as Contour
    from .kornia_report import KorniaReport as KorniaReport
    from .kornia_zncc import KorniaZNCC as KorniaZNCC
    from .luminance import Luminance as Luminance
    from .onnx import Onnx as Onnx
    from .opencv_sgbm import OpenCVSGBM as OpenCVSGBM
    from .report import Report as Report
    from .semi_global import SemiGlobal as SemiGlobal
    from .ssd import Ssd as Ssd
    from .zncc import Zncc as Zncc

__getattr__: Callable[[str], Any]
__all__, __getattr__ = lazily(  # pyright: ignore[reportUnsupportedDunderAll]
    __name__,
    {
        "auto": ["Auto"],
        "contour": ["Contour"],
        "kornia_report": ["KorniaReport"],
        "kornia_zncc": ["KorniaZNCC"],
        "luminance": ["Luminance"],
        "onnx": ["Onnx"],
        "opencv_sgbm": ["OpenCVSGBM"],
        "report": ["Report"],
        "semi_global": ["SemiGlobal"],
        "ssd": ["Ssd"],
        "zncc": ["Zncc"],
    },
)

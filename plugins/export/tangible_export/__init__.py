"""Exporters: files for printers, swell paper and pin displays.

Each exporter is imported when it is first used.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from tangible_core.lazily import lazily

if TYPE_CHECKING:
    from .glb import Glb as Glb
    from .heights import Heights as Heights
    from .pins import Pins as Pins
    from .stl import Stl as Stl
    from .swell import Swell as Swell
    from .three_mf import ThreeMF as ThreeMF

__getattr__: Callable[[str], Any]
__all__, __getattr__ = lazily(  # pyright: ignore[reportUnsupportedDunderAll]
    __name__,
    {
        "glb": ["Glb"],
        "heights": ["Heights"],
        "pins": ["Pins"],
        "stl": ["Stl"],
        "swell": ["Swell"],
        "three_mf": ["ThreeMF"],
    },
)

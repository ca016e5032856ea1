"""Devices, which have a position and give a force. Each method is imported when it is first used."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from tangible_core.lazily import lazily

if TYPE_CHECKING:
    from .falcon.falcon import Falcon as Falcon
    from .falcon.falcon_simulated import FalconSimulated as FalconSimulated
    from .force_dimension.force_dimension import ForceDimension as ForceDimension
    from .haply.haply import Haply as Haply
    from .mock import Mock as Mock
    from .pointer.pointer import Pointer as Pointer
    from .replay import Replay as Replay

__getattr__: Callable[[str], Any]
__all__, __getattr__ = lazily(  # pyright: ignore[reportUnsupportedDunderAll]
    __name__,
    {
        "falcon.falcon": ["Falcon"],
        "falcon.falcon_simulated": ["FalconSimulated"],
        "force_dimension.force_dimension": ["ForceDimension"],
        "haply.haply": ["Haply"],
        "mock": ["Mock"],
        "pointer.pointer": ["Pointer"],
        "replay": ["Replay"],
    },
)

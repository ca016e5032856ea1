"""Force laws, from a position to a force. Each is imported when it is first used."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from tangible_core.lazily import lazily

if TYPE_CHECKING:
    from .engraved import Engraved as Engraved
    from .force_shading import ForceShading as ForceShading
    from .grey_level import GreyLevel as GreyLevel
    from .lateral_gradient import LateralGradient as LateralGradient
    from .lateral_shape import LateralShape as LateralShape
    from .penalty import Penalty as Penalty
    from .penalty_gradient import PenaltyGradient as PenaltyGradient
    from .proxy import Proxy as Proxy
    from .tangible_mask import TangibleMask as TangibleMask
    from .with_materials import WithMaterials as WithMaterials

__getattr__: Callable[[str], Any]
__all__, __getattr__ = lazily(  # pyright: ignore[reportUnsupportedDunderAll]
    __name__,
    {
        "engraved": ["Engraved"],
        "force_shading": ["ForceShading"],
        "grey_level": ["GreyLevel"],
        "lateral_gradient": ["LateralGradient"],
        "lateral_shape": ["LateralShape"],
        "penalty": ["Penalty"],
        "penalty_gradient": ["PenaltyGradient"],
        "proxy": ["Proxy"],
        "tangible_mask": ["TangibleMask"],
        "with_materials": ["WithMaterials"],
    },
)

"""The size of what is felt."""

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from ..data.quantities import Quantities


class Section(Quantities):
    """Base of the configuration's own blocks."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


class Workspace(Section):
    """The size of what is felt."""

    width_m: Annotated[float, Field(gt=0, le=10, allow_inf_nan=False)] = 0.08
    """Width of the surface under the hand."""
    relief_m: Annotated[float, Field(gt=0, le=1, allow_inf_nan=False)] = 0.02
    """Height of the nearest point above the farthest."""
    smooth_m: Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)] = 0.0
    """Standard deviation of a Gaussian that smooths an estimated relief; matching noise would feel like grit."""
    finest_m: Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)] = 3e-5
    """Finest detail that is kept: larger pictures are reduced to it first. A Falcon resolves 0.03 mm; 0 keeps every
    pixel."""
    holes: Literal["fill", "cut"] = "fill"
    """Where the depth is unknown: `fill` with the background beside it, or `cut` down to the base plane."""

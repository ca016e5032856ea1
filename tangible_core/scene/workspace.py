"""The size of what is felt."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field


class Section(BaseModel):
    """Base of the configuration's own blocks."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


class Workspace(Section):
    """The size of what is felt."""

    width_m: Annotated[float, Field(gt=0, le=10, allow_inf_nan=False)] = 0.08
    """Width of the picture under the hand."""
    relief_m: Annotated[float, Field(gt=0, le=1, allow_inf_nan=False)] = 0.02
    """Height of the nearest point above the farthest."""
    smooth_m: Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)] = 0.0
    """Standard deviation of a Gaussian that rounds an estimated relief; a finger feels matching noise as grit."""
    finest_m: Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)] = 3e-5
    """Finer detail is not looked at: larger pictures are reduced first. A Falcon resolves 0.03 mm; 0 keeps all."""
    holes: Literal["fill", "cut"] = "fill"
    """Where the depth is unknown: `fill` from the background beside it, or `cut` down to the base plane."""

"""Options for the heights of parts in a pipeline file, and the record of decided heights."""

from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field, model_validator

from ..scene.workspace import Section

Length = Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)]


class HeightChoice(Section):
    """A relief of parts: each has a height, a rounded rim, and a little relief from the picture's light."""

    by: Literal["depth", "given", "guess"]
    """Source of the heights of the parts. `given`: `parts:`, and 0 for parts without a height there. `depth`: the
    median of the disparity over each part. `guess`: size, place and border ownership; a guess to correct. A height in
    `parts:` overrides all three."""
    round_m: Length = 0.006
    """Width of the rounded rim of a part."""
    bulge_m: Length = 0.0015
    """Largest rise of the middle of a part above its rim; never more than the part's height, so that parts at 0 are
    flat."""
    detail_m: Length = 0.0003
    """Height of the picture's light above its dark, away from the borders; nothing sinks below 0."""


class PartChoice(Section):
    """Name, height and material of one part. A text alone is its name."""

    name: str = ""
    """Name of the thing that it shows; empty for none."""
    height_m: Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)] | None = None
    """Height of its rim above the base; null to leave it to `heights:`."""
    material: str | None = None
    """Material of the part, which overrides all rules; null to leave it to `materials:`."""

    @model_validator(mode="before")
    @classmethod
    def _of_name(cls, value: Any) -> Any:
        return {"name": value} if isinstance(value, str) else value


class SimplifyChoice(Section):
    """Parts simplified until fingers can read them, before relief, labels and materials are made of them."""

    gap_m: Length = 0.0032
    """Smallest width of a part; a narrower place goes to the neighbouring parts."""
    part_m: Length = 0.0064
    """Diameter of the disc that each part must hold; a part that holds none goes to its neighbours."""
    textures: Annotated[int, Field(ge=1, le=100)] = 5
    """Largest number of textures that a finger must tell apart; of more, the most similar become one. Parts with a
    name stay separate."""


class PartHeights(NamedTuple):
    """A height for every part, and the reason for each in a sentence."""

    heights_m: tuple[float, ...]
    reasons: tuple[str, ...]

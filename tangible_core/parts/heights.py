"""The height of each part: what a file says of it, and what is found for the others."""

from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field, model_validator

from ..scene.workspace import Section

Length = Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)]


class HeightChoice(Section):
    """A relief of parts: each has a height, is rounded at its rim, and carries a little of the picture's light."""

    by: Literal["depth", "given", "guess"]
    """Where the heights of the parts come from. `given`: from `parts:`, and what has none there lies at 0. `depth`:
    from the disparity, its median over each part. `guess`: by size, place and who owns a border; a guess to correct.
    A height that `parts:` gives decides in all three."""
    round_m: Length = 0.006
    """Width of the rounded rim of a part."""
    bulge_m: Length = 0.0015
    """How far the middle of a part rises above its rim, at most; never more than the part's height, so that what lies
    at 0 is flat."""
    detail_m: Length = 0.0003
    """How far the picture's light rises above its dark, away from the borders; nothing sinks below 0."""


class PartChoice(Section):
    """What is said of one part. A text alone is its name."""

    name: str = ""
    """What it shows, in words of your own; empty for none."""
    height_m: Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)] | None = None
    """Height of its rim above the base; null to leave it to `heights:`."""
    material: str | None = None
    """Its material, which decides before all rules; null to leave it to `materials:`."""

    @model_validator(mode="before")
    @classmethod
    def _of_name(cls, said: Any) -> Any:
        return {"name": said} if isinstance(said, str) else said


class PartHeights(NamedTuple):
    """A height for every part, and a sentence for each that says why."""

    heights_m: tuple[float, ...]
    reasons: tuple[str, ...]

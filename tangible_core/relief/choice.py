"""Options for the relief in a pipeline file."""

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from ..scene.workspace import Section

# The default share of the height that goes where borders are: more steepens level ground between them.
SPREAD = 0.5
# The default of the most by which a border is accented, m: twice the least step that is felt under a fingertip.
ACCENT_M = 0.001
# The default slope of what networks see: a hand gets over the wall around a figure, also on rough materials.
FIGURE_SLOPE = 0.8

Length = Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)]


class ReliefChoice(Section):
    """How depth, or a picture, becomes height. A word alone is `by`: `relief: depth` keeps true proportions."""

    by: Literal["disparity", "depth", "edges", "figure", "lines"] = "disparity"
    """The source of heights. `disparity`: near things get more of the height, as in a bas-relief. `depth`: heights to
    scale, where the calibration of the cameras is known. `edges`: for one photograph without depth, raised lines on low
    steps from dark to light: at the borders that people would draw, if the texture method knows these, as `hierarchy`
    does, or a network of borders, and at the edges of the picture otherwise. `figure`: for one photograph, what
    networks see in it: what stands out from its ground is raised and rounded, borders are grooves, and faces have their
    shape (`tangible networks`). `lines`: for a drawing, all its lines as ridges of one height, and its areas of one
    colour as even steps below them; paper is flat, and letters are left out."""
    slope: Annotated[float, Field(ge=0, le=100, allow_inf_nan=False)] = 1.1
    """The greatest slope, rise over run; steeper places become ramps. A hand that presses down climbs it with at most
    this many times its press sideways. 0 keeps cliffs. By figure it is 0.8 if it is left out."""
    spread: Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)] | None = None
    """The share of the height that is given to those depths which borders cross; the order of all depths stays. 0 keeps
    heights proportional. null for 0.5 by disparity and 0 by depth."""
    accent_m: Length | None = None
    """The most by which what stands before its surroundings is raised at its border, and they are lowered; null for
    0.001 by disparity and 0 by depth."""
    grain_m: Length = 0.0003
    """Noise of less than 0.1 mm that is finer than this is taken out; 0 keeps it."""

    @model_validator(mode="before")
    @classmethod
    def _slope_by_figure(cls, values: dict[str, Any]) -> dict[str, Any]:
        return {"slope": FIGURE_SLOPE, **values} if values.get("by") == "figure" else values

    @property
    def spread_share(self) -> float:
        """The decided share of the height that goes where borders are."""
        return (SPREAD if self.by == "disparity" else 0.0) if self.spread is None else self.spread

    @property
    def most_accent_m(self) -> float:
        """The decided bound of the accent, m."""
        return (ACCENT_M if self.by == "disparity" else 0.0) if self.accent_m is None else self.accent_m

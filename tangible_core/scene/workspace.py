"""The size of the surface under the hand, and its defaults for each kind of scene."""

import re
from typing import Annotated, Any, Literal, NamedTuple, Self

from pydantic import BeforeValidator, Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from ..data import Relief
from ..data.quantities import Quantities
from .geometry import MAX_RELIEF_M, Holes, Rise
from .scene import Scene
from .scene_files import BUILTINS, SceneFiles

SceneKind = Literal["photograph", "depth", "heights"]
"""Source of a relief: the brightness of one picture, depth (of a pair, or a depth map), or a height map."""
ReliefKind = SceneKind | Literal["edges", "figure", "lines", "parts"]
"""Source of a relief, or a picture's edges, what networks see in it, a drawing's lines, or parts with heights."""

# Default height h and smoothing s, metres: an edge is no steeper than h / (s sqrt(2 pi)), 1.06 in a photograph.
SUITS: dict[ReliefKind, tuple[float, float]] = {
    "photograph": (0.004, 0.0015),
    "edges": (0.002, 0.00025),
    "figure": (0.007, 0.0001),
    "lines": (0.002, 0.00025),
    "depth": (0.005, 0.00025),
    "heights": (0.02, 0.0),
    "parts": (0.006, 0.0005),
}


FLAT: dict[ReliefKind, str] = {
    "photograph": "all of the picture is equally light; use one with light and dark",
    "edges": "the picture has no edges; `relief: disparity` takes its light and dark",
    "figure": "no network sees anything in the picture; `relief: edges` raises its edges",
    "lines": "the picture has no lines and no areas; `relief: edges` raises its edges",
    "depth": "all of it is equally far; check the map of depth, or that left and right are two views of one scene",
    "heights": "all heights are equal; check the file, and `nodata`, `clip`, `crop`, `low_m` and `high_m`",
    "parts": "all parts are equally high; give them heights, `heights: {by: given}` and `height_m` under `parts:`",
}


def flat_warning(relief: Relief, kind: ReliefKind) -> str:
    """Return the sentence about a relief in which nothing stands out; empty for any other one."""
    return f"the relief is flat, nothing stands out: {FLAT[kind]}" if relief.is_flat else ""


class Section(Quantities):
    """Base of the configuration's own blocks."""


class FeltSize(NamedTuple):
    """A workspace with every value decided."""

    width_m: float
    relief_m: float
    smooth_m: float
    finest_m: float
    holes: Holes
    rise: Rise = Rise()


MIN_WIDTH_M, MAX_WIDTH_M = 1e-6, 10
SCALE = r"^1:[0-9]+(\.[0-9]+)?$"


def _check_scale(scale: object) -> object:
    if scale is not None and not (isinstance(scale, str) and re.match(SCALE, scale) and 0 < _times(scale) < 1e12):
        raise ValueError("Input should be a scale, such as 1:50000")
    return scale


def _times(scale: str) -> float:
    return float(scale.removeprefix("1:"))


Metres = Annotated[float, Field(allow_inf_nan=False)]


class Workspace(Section):
    """The size of the surface under the hand.

    Lengths are metres, or text with a unit. Options that you leave out depend on the scene: a photograph is felt lower
    and smoother than a height map. A pin display, a printer or a page has its own width, see the exporters.

    >>> Workspace(width_m="12 cm", relief_m=0.006).width_m
    0.12
    """

    width_m: Annotated[float, Field(ge=MIN_WIDTH_M, le=MAX_WIDTH_M, allow_inf_nan=False)] = 0.08
    """Width of the surface under the hand."""
    relief_m: Annotated[float, Field(gt=0, le=MAX_RELIEF_M, allow_inf_nan=False)] | None = None
    """Height of the nearest point above the farthest; null for a default by the scene: 0.004 for a photograph, whose
    brightness is not depth, 0.002 for its edges, 0.005 for depth, 0.02 for a height map, 0.006 for parts with
    `heights:`."""
    smooth_m: Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)] | None = None
    """Standard deviation of a Gaussian that smooths an estimated relief, whose matching noise would feel like grit;
    null for a default by the scene: 0.0015 for a photograph, 0.00025 for depth and edges, 0.0005 for parts with
    `heights:`. A height map is never smoothed."""
    finest_m: Annotated[float, Field(ge=0, le=0.1, allow_inf_nan=False)] = 3e-5
    """Finest detail to keep: larger pictures are first reduced to it. A Falcon resolves 0.03 mm; 0 keeps all pixels."""
    holes: Literal["fill", "cut"] = "fill"
    """Treatment of unknown depth: `fill` from the background next to it, or `cut` down to the base plane."""
    scale: Annotated[str, BeforeValidator(_check_scale), Field(json_schema_extra={"pattern": SCALE})] | None = None
    """The scale of a height map whose cells have a known size on the ground, such as `1:50000`: width and height of the
    surface follow from it, so that several maps fit together. null for `width_m` and `relief_m`."""
    exaggeration: Annotated[float, Field(gt=0, le=1000)] = 1.0
    """Times that heights are higher than at `scale`."""
    low_m: Metres | None = None
    """The height in a height map that becomes the base plane; null for its lowest. The same for all tiles of a map."""
    high_m: Metres | None = None
    """The height in a height map that becomes the top of the relief; null for its highest."""

    @model_validator(mode="after")
    def _one_size(self) -> Self:
        fields_set = self.model_fields_set
        if self.scale is not None and (idle := [name for name in ("width_m", "relief_m") if name in fields_set]):
            raise ValueError(f"scale already gives the size of the surface; leave out {' and '.join(idle)}")
        if self.scale is None and self.exaggeration != 1:
            raise ValueError("exaggeration needs scale; without it, relief_m is the height of the whole relief")
        if self.low_m is not None and self.high_m is not None and not self.low_m < self.high_m:
            raise ValueError(f"low_m is less than high_m, not {self.low_m:g} and {self.high_m:g}")
        return self

    @model_serializer(mode="wrap")
    def _without_idle(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        idle = ("exaggeration",) if self.scale is None else ("width_m", "relief_m")
        return {name: value for name, value in handler(self).items() if name not in idle}

    @property
    def times(self) -> float | None:
        """The number of metres on the ground in a metre of the surface; None without a scale."""
        return None if self.scale is None else _times(self.scale)

    def size(self, kind: ReliefKind) -> FeltSize:
        """Return this workspace with the defaults for a relief of this kind.

        >>> Workspace(relief_m=0.006).size("photograph")[1:3]
        (0.006, 0.0015)
        """
        relief_m, smooth_m = SUITS[kind]
        relief_m = relief_m if self.relief_m is None else self.relief_m
        smooth_m = smooth_m if self.smooth_m is None else self.smooth_m
        rise = Rise(self.times and self.exaggeration / self.times, self.low_m, self.high_m)
        return FeltSize(self.width_m, relief_m, smooth_m, self.finest_m, self.holes, rise)


def kind_of(scene: str | SceneFiles | Scene) -> SceneKind:
    """Return the source of a scene's relief, from the names of its files alone."""
    if isinstance(scene, Scene) and scene.files is not None:
        scene = scene.files
    if isinstance(scene, str):
        scene = BUILTINS[scene]
    if isinstance(scene, SceneFiles):
        pair = scene.right is not None or (scene.video is not None and scene.layout not in (None, "mono"))
        heights, depth = scene.height is not None, pair or scene.disparity is not None or scene.depth is not None
    else:
        heights = scene.height is not None
        depth = scene.disparity is not None or (scene.views is not None and scene.views.right is not None)
    return "heights" if heights else "depth" if depth else "photograph"

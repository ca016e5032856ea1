"""The size of the surface under the hand, and its defaults for each kind of scene."""

from typing import Annotated, ClassVar, Literal, NamedTuple

from pydantic import ConfigDict, Field

from ..data.quantities import Quantities
from .geometry import Holes
from .scene import Scene
from .scene_files import BUILTINS, SceneFiles

SceneKind = Literal["photograph", "depth", "heights"]
"""Source of a relief: the brightness of one picture, depth (of a pair, or a depth map), or a height map."""
ReliefKind = SceneKind | Literal["edges", "parts"]
"""Source of a relief, or the edges of a picture, or parts, each with a height."""

SUITS: dict[ReliefKind, tuple[float, float]] = {
    "photograph": (0.004, 0.0015),
    "edges": (0.002, 0.00025),
    "depth": (0.005, 0.00025),
    "heights": (0.02, 0.0),
    "parts": (0.006, 0.0005),
}
"""Default height and smoothing, metres. An edge from black to white is then no steeper than h / (s sqrt(2 pi)): 1.06
in a photograph, where every line is such an edge. The slopes of depth are limited (`relief:`) and only their edges are
rounded. A height map is not smoothed, and the borders of parts only enough to soften a wall's edge."""


class Section(Quantities):
    """Base of the configuration's own blocks."""

    model_config: ClassVar[ConfigDict] = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)


class FeltSize(NamedTuple):
    """A workspace with every value decided."""

    width_m: float
    relief_m: float
    smooth_m: float
    finest_m: float
    holes: Holes


class Workspace(Section):
    """The size of the surface under the hand."""

    width_m: Annotated[float, Field(ge=1e-6, le=10, allow_inf_nan=False)] = 0.08
    """Width of the surface under the hand."""
    relief_m: Annotated[float, Field(gt=0, le=1, allow_inf_nan=False)] | None = None
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

    def size(self, kind: ReliefKind) -> FeltSize:
        """Return this workspace with the defaults for a relief of this kind.

        >>> Workspace(relief_m=0.006).size("photograph")[1:3]
        (0.006, 0.0015)
        """
        relief_m, smooth_m = SUITS[kind]
        relief_m = relief_m if self.relief_m is None else self.relief_m
        smooth_m = smooth_m if self.smooth_m is None else self.smooth_m
        return FeltSize(self.width_m, relief_m, smooth_m, self.finest_m, self.holes)


def kind_of(scene: str | SceneFiles | Scene) -> SceneKind:
    """Return the source of a scene's relief, from the names of its files alone."""
    if isinstance(scene, Scene) and scene.files is not None:
        scene = scene.files
    if isinstance(scene, str):
        scene = BUILTINS[scene]
    if isinstance(scene, SceneFiles):
        pair = scene.right is not None or (scene.video is not None and scene.layout not in (None, "mono"))
        heights, depth = scene.height is not None, pair or scene.disparity is not None
    else:
        heights = scene.height is not None
        depth = scene.disparity is not None or (scene.views is not None and scene.views.right is not None)
    return "heights" if heights else "depth" if depth else "photograph"

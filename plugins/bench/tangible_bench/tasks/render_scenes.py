"""Surfaces with a path of the hand: analytic surfaces with exact nearest points, or the relief of a picture."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from jaxtyping import Float64
from pydantic import Field, model_validator

from tangible_core.data import HapticSurface, Relief, to_grey
from tangible_core.errors import OutputError, quoted
from tangible_core.scene import Scene, scale_heights
from tangible_core.scene.formats import read_map
from tangible_core.session import Recording

from ..strokes import PERIOD_S, KnownStroke, analytic_stroke, relief_stroke
from .task import SceneSpec, check_one_kind

Length = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class RenderScene(SceneSpec):
    """A surface and a path of the hand over it; the surface is one of analytic, builtin and height."""

    analytic: Literal["plane", "ramp", "sphere", "sine", "cone", "ridge", "step"] | None = None
    """A surface given by a formula, 80 mm wide, whose nearest points are exact."""
    builtin: str | None = None
    """A builtin scene; its true disparity or its grey levels are the heights. True forces on it are unknown."""
    height: Path | None = None
    """A height map in any unit: a grey picture, .npy, .pfm or .tif. True forces on it are unknown."""
    cells: Annotated[int, Field(ge=16, le=4096)] = 256
    """Cells along each side of an analytic surface."""
    width_m: Length = 0.08
    """Width of a picture's relief."""
    relief_m: Length = 0.01
    """Height of a picture's relief."""
    depth_m: Length = 0.001
    """Depth of the scripted path below the surface."""
    recording: Path | None = None
    """A recording, .nc, .npz or .csv, whose positions are the path in place of the scripted one."""

    @model_validator(mode="after")
    def _one_surface(self) -> Self:
        given = [name for name in ("analytic", "builtin", "height") if getattr(self, name) is not None]
        check_one_kind(given, "analytic, builtin and height")
        idle = ("width_m", "relief_m") if self.analytic else ("cells",)
        idle += ("depth_m",) if self.recording else ()
        if set_idle := [name for name in idle if getattr(self, name) != type(self).model_fields[name].default]:
            raise ValueError(f"{' and '.join(set_idle)} has no effect here; leave it out")
        return self

    @classmethod
    def parse_name(cls, name: str) -> Mapping[str, Any]:
        """Return the options of `analytic/NAME` or `builtin/NAME`."""
        kind, _, rest = name.partition("/")
        if kind not in ("analytic", "builtin"):
            raise ValueError(
                f"no scene is named {quoted(name)}; write analytic/sphere, builtin/coins or {{height: ...}}"
            )
        return {kind: rest}

    def expand(self) -> "Mapping[str, RenderScene]":
        """Return this scene alone."""
        return {self._name(): self}

    def open(self) -> KnownStroke:
        """Read or make the surface, the path, and the nearest points as far as they are known.

        Raises: ConfigError, PictureError, GeometryError, OutputError if a file cannot be read or has other content.
        """
        path_m, period_s = (None, PERIOD_S) if self.recording is None else _read_path(self.recording)
        if self.analytic is not None:
            return analytic_stroke(self.analytic, self.cells, self.depth_m, path_m, period_s)
        return relief_stroke(HapticSurface(self._relief()), self.depth_m, path_m, period_s)

    def _relief(self) -> Relief:
        if self.height is not None:
            return scale_heights(read_map(self.height), self.width_m, self.relief_m)
        scene = Scene.builtin(self.builtin or "")
        assert scene.views is not None  # no builtin scene is a height map
        heights = to_grey(scene.views.left) if scene.truth is None else scene.truth
        return scale_heights(heights, self.width_m, self.relief_m)

    def _name(self) -> str:
        if self.analytic is not None:
            name = f"{self.analytic} {self.cells}x{self.cells}"
        else:
            name = f"builtin/{self.builtin}" if self.height is None else self.height.name
            name += f" {1000 * self.width_m:g} mm wide, {1000 * self.relief_m:g} mm high"
        return f"{name}, {self.recording.name if self.recording else f'{1000 * self.depth_m:g} mm deep'}"


def _read_path(file: Path) -> tuple[Float64[np.ndarray, "n 3"], float]:
    """Return the positions of a recording and the median period between them."""
    recording = Recording.load(file)
    periods_s = np.diff(recording.time_s)
    if not (np.isfinite(recording.position_m).all() and periods_s.size and np.median(periods_s) > 0):
        raise OutputError(
            f"{file}: not a path of a hand: it needs two finite positions or more at increasing times; record it again"
        )
    return recording.position_m, float(np.median(periods_s))

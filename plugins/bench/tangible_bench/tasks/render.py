"""The task for force laws, forces compared with a spring to the nearest surface point; and its surfaces and paths."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from jaxtyping import Float64
from pydantic import Field, ValidationError, model_validator

from tangible_core.data import HapticSurface, Relief, to_grey
from tangible_core.errors import OutputError, quoted
from tangible_core.metrics import force_errors
from tangible_core.plugins import ForceRenderer, Touch
from tangible_core.scene import Scene, scale_heights
from tangible_core.scene.formats import read_map
from tangible_core.session import Recording

from ..memory import held_bytes
from ..metrics.stability import Law, force_steps, loop_works, proxy_lag, stiffness_limit
from ..strokes import PERIOD_S, KnownStroke, analytic_stroke, relief_stroke
from .task import Clock, Measure, Perturbation, SceneSpec, Task, check_one_kind

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
        kinds = [name for name in ("analytic", "builtin", "height") if getattr(self, name) is not None]
        check_one_kind(kinds, "analytic, builtin and height")
        idle = ("width_m", "relief_m") if self.analytic else ("cells",)
        idle += ("depth_m",) if self.recording else ()
        if set_idle := [name for name in idle if getattr(self, name) != type(self).model_fields[name].default]:
            raise ValueError(f"{' and '.join(set_idle)} has no effect here; leave it out")
        return self

    @classmethod
    def parse_name(cls, name: str) -> Mapping[str, Any]:
        kind, _, rest = name.partition("/")
        if kind not in ("analytic", "builtin"):
            raise ValueError(
                f"no scene is named {quoted(name)}; write analytic/sphere, builtin/coins or {{height: ...}}"
            )
        return {kind: rest}

    def expand(self) -> "Mapping[str, RenderScene]":
        return {self._name(): self}

    def open(self) -> KnownStroke:
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


STIFFNESS = "stiffness_n_per_m"
STIFFNESS_N_PER_M = 800.0  # the stiffness of the true spring for force laws without such an option
# The delays of a simulated device, in ticks, for which stiffness limits are measured.
DELAYS = (0, 1, 2)


@dataclass(frozen=True, eq=False)
class PathForces:
    """The forces of a force law along a path."""

    method: ForceRenderer
    force_n: Float64[np.ndarray, "n 3"]


def prepare(method: ForceRenderer, scene: KnownStroke) -> tuple[ForceRenderer, Touch]:
    """Make a new touch."""
    return method, method.touch(scene.surface)


def feel(method_and_touch: tuple[ForceRenderer, Touch], scene: KnownStroke) -> PathForces:
    """Run the timed call: all ticks at once."""
    method, touch = method_and_touch
    return PathForces(method, touch.path(scene.position_m, scene.period_s))


def measure(result: PathForces, scene: KnownStroke) -> dict[str, float]:
    """Return all of MEASURES, against the force F = k (p - q) to the nearest point p."""
    method, force_n = result.method, result.force_n
    stiffness = float(method.model_dump().get(STIFFNESS, STIFFNESS_N_PER_M))
    truth_n = stiffness * (scene.nearest_m - scene.position_m)
    proxy_m = scene.position_m + force_n / stiffness
    free = (scene.position_m[:, 2] > scene.surface.height_m.max()) & ~force_n.any(axis=1)
    works = loop_works(force_n, scene.position_m, free)
    return {
        **force_errors(force_n, truth_n),
        "lag_mm": 1e3 * proxy_lag(scene.position_m, proxy_m, scene.nearest_m),
        **force_steps(force_n),
        "loop_work_j": float(works.max()) if works.size else float("nan"),
        **limits(method, scene.surface),
        "held_kb": held_bytes(lambda: method.touch(scene.surface)) / 1e3,
    }


def limits(method: ForceRenderer, surface: HapticSurface) -> dict[str, float]:
    """Return `limit0`, `limit1`, `limit2`: the stiffness at which a simulated handle shakes, for each delay."""
    unknown = {f"limit{delay}": float("nan") for delay in DELAYS}
    if STIFFNESS not in type(method).model_fields or np.ptp(surface.height_m) > 0:
        return unknown

    def law(stiffness_n_per_m: float) -> Law:
        options = {**method.model_dump(), STIFFNESS: stiffness_n_per_m}
        return type(method).model_validate(options).touch(surface).force

    try:
        return {f"limit{ticks}": stiffness_limit(law, float(surface.height_m[0, 0]), ticks) for ticks in DELAYS}
    except ValidationError:  # the option ends before the limit
        return unknown


def faster(scene: KnownStroke, times: float) -> KnownStroke:
    """Return the same path at a multiple of the speed: every n-th position."""
    every = int(times)
    return replace(scene, position_m=scene.position_m[::every], nearest_m=scene.nearest_m[::every])


def quantize(scene: KnownStroke, bits: float) -> KnownStroke:
    """Round heights to n bits, the highest to white; the truth stays as it is."""
    heights = scene.surface.height_m
    step_m = float(heights.max()) / (2 ** int(bits) - 1)
    levels = np.rint(heights / step_m) * step_m if step_m else heights
    relief = replace(scene.surface.relief, height_m=levels.astype(np.float32))
    return replace(scene, surface=replace(scene.surface, relief=relief))


PERTURBATIONS: Mapping[str, Perturbation] = {
    "speed": Perturbation(
        "how many times as fast the hand is, a whole number above 1", lambda times: times > 1 and times % 1 == 0, faster
    ),
    "bits": Perturbation(
        "bits of the heights, a whole number from 1 to 16", lambda bits: 1 <= bits <= 16 and bits % 1 == 0, quantize
    ),
}

MEASURES = {
    "error_percent": Measure("error %", 2),
    "error_n": Measure("error N", 4, tolerance=5e-5),
    "jnd": Measure("JND", 2),
    "noticed_percent": Measure("noticed %", 1, tolerance=0.05),
    "direction_deg": Measure("direction deg", 2),
    "lag_mm": Measure("lag mm", 4, tolerance=5e-5),
    "step_n": Measure("step N", 3, tolerance=5e-4),
    "step_p99_n": Measure("step p99 N", 4, tolerance=5e-5),
    "loop_work_j": Measure("loop work J", 7, tolerance=5e-8),
    **{f"limit{delay}": Measure(f"K max d={delay} N/m", 0, "high", 0.5) for delay in DELAYS},
    "held_kb": Measure("held kB", 0, tolerance=1.0),
}

TASK = Task(
    kind="render",
    version=2,
    scene=RenderScene,
    work=feel,
    measure=measure,
    measures=MEASURES,
    columns=tuple(name for name in MEASURES if name not in ("limit1", "limit2")),
    plot_measures=("error_percent", "jnd", "step_n"),
    prepare=prepare,
    clock=Clock("ns a tick", 1e9, lambda scene: len(scene.position_m)),
    perturbations=PERTURBATIONS,
)

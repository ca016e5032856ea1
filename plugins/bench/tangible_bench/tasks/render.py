"""The task for force laws: forces along a path of the hand, compared with a spring to the nearest surface point."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64
from pydantic import ValidationError

from tangible_core.data import HapticSurface
from tangible_core.metrics import force_errors
from tangible_core.plugins import ForceRenderer, Touch

from ..memory import held_bytes
from ..metrics.stability import Law, force_steps, loop_works, proxy_lag, stiffness_limit
from ..strokes import KnownStroke
from .render_scenes import RenderScene
from .task import Clock, Measure, Perturbation, Task

STIFFNESS = "stiffness_n_per_m"
STIFFNESS_N_PER_M = 800.0
"""The stiffness of the true spring for force laws without such an option."""
DELAYS = (0, 1, 2)
"""The delays of a simulated device, in ticks, for which stiffness limits are measured."""


@dataclass(frozen=True, eq=False)
class PathForces:
    """The forces of a force law along a path."""

    method: ForceRenderer
    force_n: Float64[np.ndarray, "n 3"]


def prepare(method: ForceRenderer, scene: KnownStroke) -> tuple[ForceRenderer, Touch]:
    """Make a new touch."""
    return method, method.touch(scene.surface)


def feel(prepared: tuple[ForceRenderer, Touch], scene: KnownStroke) -> PathForces:
    """Run the timed call: all ticks at once."""
    method, touch = prepared
    return PathForces(method, touch.path(scene.position_m, scene.period_s))


def measure(result: PathForces, scene: KnownStroke) -> dict[str, float]:
    """Return all of MEASURES, against the force F = k (p - q).

    p is the nearest point, and k the stiffness option of the force law, or STIFFNESS_N_PER_M if it has none.
    """
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
    """Return `limit0`, `limit1`, `limit2`: the stiffness at which a simulated handle starts to shake, for each delay.

    NaN unless the surface is level and the force law is a spring on it whose stiffness is an option.
    """
    unknown = {f"limit{delay}": float("nan") for delay in DELAYS}
    if STIFFNESS not in type(method).model_fields or np.ptp(surface.height_m) > 0:
        return unknown

    def law(stiffness_n_per_m: float) -> Law:
        options = {**method.model_dump(), STIFFNESS: stiffness_n_per_m}
        return type(method).model_validate(options).touch(surface).force

    try:
        return {f"limit{each}": stiffness_limit(law, float(surface.height_m[0, 0]), each) for each in DELAYS}
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
    rounded = np.rint(heights / step_m) * step_m if step_m else heights
    relief = replace(scene.surface.relief, height_m=rounded.astype(np.float32))
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
    plotted=("error_percent", "jnd", "step_n"),
    prepare=prepare,
    clock=Clock("ns a tick", 1e9, lambda scene: len(scene.position_m)),
    perturbations=PERTURBATIONS,
)

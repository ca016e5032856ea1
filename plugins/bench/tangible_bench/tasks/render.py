"""How force renderers are compared: forces along a hand's way against a spring to the surface's nearest point."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64
from pydantic import ValidationError

from tangible_core.data import HapticSurface
from tangible_core.metrics import force_errors, force_steps, loop_works, proxy_lag, stiffness_limit
from tangible_core.metrics.stability import Law
from tangible_core.plugins.interfaces import ForceRenderer, Touch
from tangible_core.testing.synthetic.strokes import KnownStroke

from ..memory import held_bytes
from .render_scenes import RenderScene
from .task import Clock, Measure, Perturbation, Task

STIFFNESS = "stiffness_n_per_m"
STIFFNESS_N_PER_M = 800.0
"""Of the true spring, for a law that has no such option."""
DELAYS = (0, 1, 2)


@dataclass(frozen=True, eq=False)
class PathForces:
    """The forces of a law along a way."""

    method: ForceRenderer
    force_n: Float64[np.ndarray, "n 3"]


def prepare(method: ForceRenderer, scene: KnownStroke) -> tuple[ForceRenderer, Touch]:
    """A new touch."""
    return method, method.touch(scene.surface)


def feel(prepared: tuple[ForceRenderer, Touch], scene: KnownStroke) -> PathForces:
    """What is timed: all ticks in one call."""
    method, touch = prepared
    return PathForces(method, touch.path(scene.position_m, scene.period_s))


def measure(felt: PathForces, scene: KnownStroke) -> dict[str, float]:
    """All of MEASURES; against F = k (p - q), p the nearest point, k the law's own stiffness if it has that option."""
    stiffness = float(felt.method.model_dump().get(STIFFNESS, STIFFNESS_N_PER_M))
    truth_n = stiffness * (scene.nearest_m - scene.position_m)
    proxy_m = scene.position_m + felt.force_n / stiffness
    free = (scene.position_m[:, 2] > scene.surface.height_m.max()) & ~felt.force_n.any(axis=1)
    works = loop_works(felt.force_n, scene.position_m, free)
    return {
        **force_errors(felt.force_n, truth_n),
        "lag_mm": 1e3 * proxy_lag(scene.position_m, proxy_m, scene.nearest_m),
        **force_steps(felt.force_n),
        "loop_work_j": float(works.max()) if works.size else float("nan"),
        **limits(felt.method, scene.surface),
        "held_kb": held_bytes(lambda: felt.method.touch(scene.surface)) / 1e3,
    }


def limits(method: ForceRenderer, surface: HapticSurface) -> dict[str, float]:
    """`limit0`, `limit1`, `limit2`: stiffness at which a simulated handle starts to shake, with so many ticks' delay.

    NaN unless the surface is level and the law is a spring on it whose stiffness is an option.
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
    """The same way at a multiple of the speed: every so many-th position."""
    every = int(times)
    return replace(scene, position_m=scene.position_m[::every], nearest_m=scene.nearest_m[::every])


def stepped(scene: KnownStroke, bits: float) -> KnownStroke:
    """Heights as a picture of so many bits holds them, white the highest; the truth stays."""
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
        "bits of the heights, a whole number from 1 to 16", lambda bits: 1 <= bits <= 16 and bits % 1 == 0, stepped
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

"""Gather what the checks need: feel the touch all over, and time it and this machine. No device is opened."""

import math

import numpy as np
from jaxtyping import Float64

from ..data import HapticSurface
from ..errors import ConfigError
from ..pipeline.config import PipelineConfig
from ..plugins.interfaces import Touch
from ..scene.geometry import workspace_to_picture
from ..scene.scene import SceneFiles
from ..servo.guard.stiffness import stiffness_of
from .flight import Flight, Hand, Loop
from .probes import Probes, probe
from .timing import TICKS, measure_lateness, measure_ticks


def survey(config: PipelineConfig, surface: HapticSurface, touch: Touch, hand: Hand, loop: Loop) -> Flight:
    """What there is to know of this surface and its touch on the configured device, before that is opened.

    Takes `loop.seconds`, in which this machine's lateness is measured, and a moment more.
    Raises: ConfigError if no device or law is configured.
    """
    device = config.felt_device
    if device is None or config.render is None:
        missing = "device" if device is None else "render"
        raise ConfigError(f"{config.path}: `{missing}:` is missing; name one (`tangible plugins` lists them)")
    period_s, spec = loop.period_s, device.spec()
    stiffness = stiffness_of(touch, spec).n_per_m
    probes = probe(touch, surface, hand.press_n, stiffness, spec.workspace_m[2], period_s)
    scene = config.scene if isinstance(config.scene, SceneFiles) else None
    own = scene is not None and scene.relief_m
    return Flight(
        surface=surface,
        law=config.render.method,
        stiffness_n_per_m=stiffness,
        spec=spec,
        workspace=config.workspace,
        relief_key="scene.relief_m" if own else "workspace.relief_m",
        relief_m=own or config.workspace.relief_m,
        smoothed=not (scene and scene.height),
        safety=config.safety,
        hand=hand,
        period_s=period_s,
        probes=probes,
        lateness=measure_lateness(loop.seconds, period_s),
        cost=measure_ticks(touch, _stroke(surface, probes, hand.speed_m_per_s * period_s), period_s),
    )


def _stroke(surface: HapticSurface, probes: Probes, step_m: float) -> Float64[np.ndarray, "n 3"]:
    """To and fro over the surface, pressed in as deep as the probes were in the middle."""
    (width_m, length_m), shape = surface.extent_m, surface.height_m.shape
    gone_m = np.arange(TICKS) * step_m
    x, y = _to_and_fro(gone_m, width_m), _to_and_fro(gone_m / math.e, length_m)
    column, row = workspace_to_picture(x, y, shape, surface.extent_m)
    heights = surface.height_m[np.rint(row).astype(int), np.rint(column).astype(int)]
    return np.column_stack([x, y, heights - np.median(probes.depth_m)])


def _to_and_fro(gone_m: np.ndarray, length_m: float) -> np.ndarray:
    """Between the outermost thousandths of a length, from its middle on."""
    turns = gone_m / (2 * length_m) + 0.25
    return 0.999 * length_m * (np.abs(2 * (turns - np.floor(turns)) - 1) - 0.5)

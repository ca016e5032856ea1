"""The input of the checks: facts and measurements, all taken before the checks run. No device is opened."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from ..data import DeviceSpec, HapticSurface, Material
from ..errors import BrokenMethod, ConfigError
from ..plugins.interfaces import ForceRenderer, HapticDevice, Touch
from ..plugins.naming import plugin_name
from ..scene.geometry import workspace_to_picture
from ..scene.workspace import FeltSize, Workspace
from ..servo.guard import layout
from ..servo.guard.safety import (
    NOMINAL_S,
    Safety,
    effective_damping_n_s_per_m,
    encoder_limit_n_per_m,
    stiffness_limit_n_per_m,
)
from ..servo.guard.stiffness import find_stiffness
from .probes import Probes, Strokes, probe, stroke
from .timing import TICKS, Lateness, TickCost, measure_lateness, measure_ticks

PASSIVE = "Colgate & Schenkel 1997: 2 b / (T (1 + 2 d))"
DEVICE = "the device's specification, at 1 kHz"
ENCODER = "Abbott & Okamura 2005: 2 f / resolution"


@dataclass(frozen=True)
class Hand:
    """The hand that explores the surface."""

    speed_m_per_s: float = 0.12
    """Speed of a stroke: that at which the library's textures were measured (HaTT)."""
    press_n: float = 3.0
    """Downward force of a firm press; exploring takes about 1 N (HaTT)."""

    def __post_init__(self) -> None:
        _check("speed", self.speed_m_per_s, 0.001, 10, "metres a second")
        _check("press", self.press_n, 0.01, 1000, "newtons")


@dataclass(frozen=True)
class Loop:
    """The rate at which forces are computed, and the time for which this machine is measured."""

    rate_hz: float = 1000.0
    seconds: float = 2.0

    def __post_init__(self) -> None:
        _check("rate", self.rate_hz, 1, 100_000, "ticks a second")
        _check("seconds", self.seconds, 0.001, 600, "seconds")

    @property
    def period_s(self) -> float:
        """Time from tick to tick."""
        return 1 / self.rate_hz


def _check(option: str, value: float, least: float, most: float, unit: str) -> None:
    if not least <= value <= most:
        raise ConfigError(f"--{option}: is {value:g}; it must be {least:g} to {most:g} {unit}")


class Ceiling(NamedTuple):
    """A limit of stiffness."""

    limit_n_per_m: float
    share: float  # share of the limit that the guard leaves to a force law; a stiffer one is softened
    source: str

    @property
    def most_n_per_m(self) -> float:
        """Stiffness that is left to a force law."""
        return self.share * self.limit_n_per_m


@dataclass(frozen=True)
class Settings:
    """The configuration of a surface and its force law, as far as verdicts and cures depend on it."""

    size: FeltSize = field(default_factory=lambda: Workspace().size("heights"))
    safety: Safety = field(default_factory=Safety)
    scene_relief_m: float | None = None
    """Height of the relief, if the scene sets it and not the workspace."""
    exaggeration: float | None = None
    of_parts: bool = False
    smoothed: bool = True
    """True if `workspace.smooth_m` rounds the relief; a relief that the scene brings is not rounded."""
    slope: float | None = None
    """Greatest slope, `relief.slope`, 0 for none; None for a relief whose slopes that key does not limit."""
    law_name: str = ""
    fitted: bool = False
    """True if the materials were limited to the device."""

    @property
    def relief_key(self) -> str:
        """Config key that sets the relief height; empty if heights are per part."""
        if self.of_parts:
            return ""
        of_scene = "scene.relief_m" if self.scene_relief_m else "workspace.relief_m"
        return "workspace.exaggeration" if self.exaggeration else of_scene

    @property
    def relief_m(self) -> float:
        """Its value: the height of the relief in metres, or the exaggeration of heights at a scale."""
        return self.exaggeration or self.scene_relief_m or self.size.relief_m


@dataclass(frozen=True, eq=False)
class Flight:
    """A surface under a force law on a device, on this machine."""

    surface: HapticSurface
    law: ForceRenderer
    stiffness_n_per_m: float
    """Stated or else measured stiffness of the force law on level ground; 0 for one that is not a spring."""
    spec: DeviceSpec
    settings: Settings
    hand: Hand
    period_s: float
    probes: Probes
    strokes: Strokes
    lateness: Lateness
    cost: TickCost

    @property
    def present_materials(self) -> tuple[Material, ...]:
        """The materials of labels that the surface has."""
        if self.surface.labels is None or self.surface.materials is None:
            return ()
        labels: list[int] = np.unique(self.surface.labels).tolist()
        return tuple(self.surface.materials[label] for label in labels)

    @property
    def max_force_n(self) -> float:
        """Greatest force that reaches the hand."""
        return min(self.settings.safety.max_force_n or np.inf, self.spec.max_force_n)

    @property
    def max_step_n(self) -> float:
        """Greatest growth of a force in a tick."""
        return self.settings.safety.max_step_n * min(1.0, self.period_s / NOMINAL_S)

    @property
    def damping_n_s_per_m(self) -> float:
        """Plausible part of the device's damping."""
        return effective_damping_n_s_per_m(self.spec)

    @cached_property
    def coupling_m_per_n(self) -> float:
        """Compliance of the loop's virtual coupling; 0 without one."""
        settings, _ = self.settings.safety.arrays(self.spec, self.stiffness_n_per_m)
        stiffness = float(settings[layout.COUPLING])
        return 1 / stiffness if stiffness > 0 else 0.0

    def felt_n_per_m(self, stiffness_n_per_m: float) -> float:
        """Return the stiffness that reaches the device through the coupling."""
        return stiffness_n_per_m / (1 + max(0.0, stiffness_n_per_m) * self.coupling_m_per_n)

    def felt_damping_n_s_per_m(self, damping_n_s_per_m: float) -> float:
        """Return the part of a fast-changing damping that reaches the device through the coupling."""
        settings, _ = self.settings.safety.arrays(self.spec, self.stiffness_n_per_m)
        if not settings[layout.COUPLING] > 0:
            return damping_n_s_per_m
        own = float(settings[layout.COUPLING_DAMPING])
        return own * damping_n_s_per_m / max(own + damping_n_s_per_m, 1e-9)

    @property
    def nominal_n_per_m(self) -> float:
        """Stiffness of the stiffest wall that a loop of 1 kHz renders stably on this device, by its damping."""
        return stiffness_limit_n_per_m(self.damping_n_s_per_m, NOMINAL_S, self.settings.safety.delay_ticks)

    def passive_n_per_m(self, late_s: float = 0.0) -> float:
        """Return the stiffness of the stiffest wall that this loop renders stably if ticks are late by `late_s`."""
        return stiffness_limit_n_per_m(self.damping_n_s_per_m, self.period_s + late_s, self.settings.safety.delay_ticks)

    @property
    def ceilings(self) -> Sequence[Ceiling]:
        """Limits of stiffness, the lowest first."""
        own = self.spec.max_stiffness_n_per_m * min(1.0, NOMINAL_S / self.period_s)
        margin, friction_n = self.settings.safety.stiffness_margin, self.settings.safety.friction_n
        ceilings = [Ceiling(self.passive_n_per_m(), margin, PASSIVE), Ceiling(own, 1.0, DEVICE)]
        if friction_n is not None:
            ceilings.append(Ceiling(encoder_limit_n_per_m(friction_n, self.spec.resolution_m), margin, ENCODER))
        return sorted(ceilings, key=lambda ceiling: ceiling.most_n_per_m)


def survey(
    surface: HapticSurface,
    touch: Touch,
    law: ForceRenderer,
    device: HapticDevice,
    settings: Settings | None = None,
    *,
    hand: Hand | None = None,
    loop: Loop | None = None,
) -> Flight:
    """Gather facts of a surface and its touch under a force law, on a closed device. Raises: BrokenMethod."""
    settings, hand, loop = settings or Settings(), hand or Hand(), loop or Loop()
    period_s, spec = loop.period_s, device.spec()
    stiffness = find_stiffness(touch, spec).n_per_m
    probes = probe(touch, surface, hand.press_n, stiffness, spec.workspace_m[2], period_s)
    values = (probes.force_n.sum(axis=1), probes.onset_n, probes.stiffness_n_per_m, probes.damping_n_s_per_m)
    broken = ~np.isfinite(values).all(axis=0)
    if broken.any():
        who = plugin_name("render", type(law).__module__, type(law).__qualname__)
        raise BrokenMethod(
            f"{who}: force gave values that are not finite at {np.count_nonzero(broken)} of {broken.size} places of "
            "the surface; a force is always finite, as `tangible check` tests"
        )
    return Flight(
        surface=surface,
        law=law,
        stiffness_n_per_m=stiffness,
        spec=spec,
        settings=settings,
        hand=hand,
        period_s=period_s,
        probes=probes,
        strokes=stroke(touch, surface, hand.press_n, hand.speed_m_per_s, period_s),
        lateness=measure_lateness(loop.seconds, period_s),
        cost=measure_ticks(touch, _stroke(surface, probes, hand.speed_m_per_s * period_s), period_s),
    )


def _stroke(surface: HapticSurface, probes: Probes, step_m: float) -> Float64[np.ndarray, "n 3"]:
    (width_m, length_m), shape = surface.extent_m, surface.height_m.shape
    way_m = np.arange(TICKS) * step_m
    x, y = _to_and_fro(way_m, width_m), _to_and_fro(way_m / math.e, length_m)
    column, row = workspace_to_picture(x, y, shape, surface.extent_m)
    heights = surface.height_m[np.rint(row).astype(int), np.rint(column).astype(int)]
    return np.column_stack([x, y, heights - np.median(probes.depth_m)])


def _to_and_fro(way_m: np.ndarray, length_m: float) -> np.ndarray:
    """Return positions on a way to and fro, from the middle of a length, without its outermost thousandths."""
    turns = way_m / (2 * length_m) + 0.25
    return 0.999 * length_m * (np.abs(2 * (turns - np.floor(turns)) - 1) - 0.5)

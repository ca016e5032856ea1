"""All that the checks know: facts and measurements, none of which the checks take themselves."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..data import DeviceSpec, HapticSurface, Material
from ..errors import ConfigError
from ..plugins.interfaces import ForceRenderer
from ..scene.workspace import FeltSize
from ..servo.guard import layout
from ..servo.guard.safety import (
    NOMINAL_S,
    Safety,
    effective_damping_n_s_per_m,
    encoder_limit_n_per_m,
    stiffness_limit_n_per_m,
)
from .probes import Probes
from .timing import Lateness, TickCost

PASSIVE = "Colgate & Schenkel 1997: 2 b / (T (1 + 2 d))"
DEVICE = "the device's specification, at 1 kHz"
ENCODER = "Abbott & Okamura 2005: 2 f / resolution"


@dataclass(frozen=True)
class Hand:
    """How the surface is explored."""

    speed_m_per_s: float = 0.12
    """Of a stroke: that at which the library's textures were measured (HaTT)."""
    press_n: float = 3.0
    """Downwards, firmly: exploring takes about 1 N (HaTT)."""

    def __post_init__(self) -> None:
        _check("speed", self.speed_m_per_s, 0.001, 10, "metres a second")
        _check("press", self.press_n, 0.01, 1000, "newtons")


@dataclass(frozen=True)
class Loop:
    """How often forces are computed, and for how long this machine is tried."""

    rate_hz: float = 1000.0
    seconds: float = 2.0

    def __post_init__(self) -> None:
        _check("rate", self.rate_hz, 1, 100_000, "ticks a second")
        _check("seconds", self.seconds, 0.001, 600, "seconds")

    @property
    def period_s(self) -> float:
        """From tick to tick."""
        return 1 / self.rate_hz


def _check(option: str, value: float, least: float, most: float, unit: str) -> None:
    if not least <= value <= most:
        raise ConfigError(f"--{option}: is {value:g}; it is {least:g} to {most:g} {unit}")


class Ceiling(NamedTuple):
    """A limit of stiffness."""

    limit_n_per_m: float
    """Above it, a law may buzz."""
    share: float
    """What the guard of the loop leaves to a law of that; a stiffer one it softens."""
    source: str

    @property
    def most_n_per_m(self) -> float:
        """What is left to a law."""
        return self.share * self.limit_n_per_m


@dataclass(frozen=True, eq=False)
class Flight:
    """One surface under one law on one device, on this machine."""

    surface: HapticSurface
    law: ForceRenderer
    stiffness_n_per_m: float
    """The law's own word for the greatest on level ground, or what was felt of it; 0 for one that is no spring."""
    spec: DeviceSpec
    size: FeltSize
    relief_key: str
    """Where the configuration says how high the relief is, empty where each part has a height of its own;"""
    relief_m: float
    """and what it says there."""
    smoothed: bool
    """Whether `workspace.smooth_m` rounds the relief; one that the scene brings stays as it is."""
    law_name: str
    """What the configuration calls the law."""
    fitted: bool
    """Whether the materials were made to fit the device."""
    safety: Safety
    hand: Hand
    period_s: float
    probes: Probes
    lateness: Lateness
    cost: TickCost

    @property
    def met(self) -> tuple[Material, ...]:
        """The materials that a hand can meet: those of labels that the surface has."""
        if self.surface.labels is None or self.surface.materials is None:
            return ()
        labels: list[int] = np.unique(self.surface.labels).tolist()
        return tuple(self.surface.materials[label] for label in labels)

    @property
    def max_force_n(self) -> float:
        """The greatest force that reaches the hand."""
        return min(self.safety.max_force_n or np.inf, self.spec.max_force_n)

    @property
    def max_step_n(self) -> float:
        """The most by which a force may grow in a tick."""
        return self.safety.max_step_n * min(1.0, self.period_s / NOMINAL_S)

    @property
    def damping_n_s_per_m(self) -> float:
        """The device's damping, as far as it is to be believed."""
        return effective_damping_n_s_per_m(self.spec)

    @cached_property
    def coupling_m_per_n(self) -> float:
        """By how much the loop's virtual coupling gives way; 0 without one."""
        settings, _ = self.safety.arrays(self.spec, self.stiffness_n_per_m)
        stiffness = float(settings[layout.COUPLING])
        return 1 / stiffness if stiffness > 0 else 0.0

    def felt_n_per_m(self, stiffness_n_per_m: float) -> float:
        """What the device feels of a stiffness, through the coupling."""
        return stiffness_n_per_m / (1 + max(0.0, stiffness_n_per_m) * self.coupling_m_per_n)

    def felt_damping_n_s_per_m(self, damping_n_s_per_m: float) -> float:
        """What the device feels of a damping that changes fast, through the coupling."""
        settings, _ = self.safety.arrays(self.spec, self.stiffness_n_per_m)
        if not settings[layout.COUPLING] > 0:
            return damping_n_s_per_m
        own = float(settings[layout.COUPLING_DAMPING])
        return own * damping_n_s_per_m / max(own + damping_n_s_per_m, 1e-9)

    @property
    def nominal_n_per_m(self) -> float:
        """The stiffest wall that a loop of 1 kHz holds on this device, by its damping."""
        return stiffness_limit_n_per_m(self.damping_n_s_per_m, NOMINAL_S, self.safety.delay_ticks)

    def passive_n_per_m(self, late_s: float = 0.0) -> float:
        """The stiffest wall that this loop holds where ticks come so late."""
        return stiffness_limit_n_per_m(self.damping_n_s_per_m, self.period_s + late_s, self.safety.delay_ticks)

    @property
    def ceilings(self) -> Sequence[Ceiling]:
        """The limits of stiffness, the lowest first."""
        own = self.spec.max_stiffness_n_per_m * min(1.0, NOMINAL_S / self.period_s)
        margin, friction_n = self.safety.stiffness_margin, self.safety.friction_n
        found = [Ceiling(self.passive_n_per_m(), margin, PASSIVE), Ceiling(own, 1.0, DEVICE)]
        if friction_n is not None:
            found.append(Ceiling(encoder_limit_n_per_m(friction_n, self.spec.resolution_m), margin, ENCODER))
        return sorted(found, key=lambda each: each.most_n_per_m)

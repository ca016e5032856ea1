"""Materials limited to what a device renders stably, one by one, before the guard would soften all of them."""

import math
from collections.abc import Mapping
from dataclasses import replace

from ..data import DeviceSpec, HapticSurface, Material
from ..servo.guard.safety import (
    NOMINAL_S,
    Safety,
    effective_damping_n_s_per_m,
    encoder_limit_n_per_m,
    stiffness_limit_n_per_m,
)

EXPLORING_N = 1.0  # press of a hand that explores (HaTT), under which the curvature of a texture adds stiffness


def fit(material: Material, spec: DeviceSpec, safety: Safety) -> Material:
    """Limit a material to what this device renders stably at 1 kHz; return itself if that is all of it."""
    damping = effective_damping_n_s_per_m(spec)
    most = safety.stiffness_margin * stiffness_limit_n_per_m(damping, NOMINAL_S, safety.delay_ticks)
    if safety.friction_n is not None:
        most = min(most, safety.stiffness_margin * encoder_limit_n_per_m(safety.friction_n, spec.resolution_m))
    most = min(most, spec.max_stiffness_n_per_m)  # what the guard leaves to a force law, as in `Safety.arrays`
    stiffness = min(material.stiffness_n_per_m, most)
    # A wave of amplitude a and wavelength L under a press P is a sideways spring of at most P a (2 pi / L)^2; it and
    # the material's stiffness stay below what the guard leaves to a force law. The damping B stays below what stiffness
    # leaves of the device's b: b > K T (1 + 2 d) / 2 + B (1 + g^2), g the greatest slope of the wave (Colgate &
    # Schenkel 1997).
    per_m = 2 * math.pi / material.grain_m
    roughness_m = min(material.roughness_m, (most - stiffness) / (EXPLORING_N * per_m**2))
    rest = damping - stiffness * NOMINAL_S * (1 + 2 * safety.delay_ticks) / 2
    own = min(material.damping_n_s_per_m, max(0.0, rest) / (1 + (roughness_m * per_m) ** 2))
    limited = replace(material, stiffness_n_per_m=stiffness, roughness_m=roughness_m, damping_n_s_per_m=own)
    return material if limited == material else limited


def fit_surface(surface: HapticSurface, spec: DeviceSpec, safety: Safety) -> tuple[HapticSurface, str]:
    """Limit the materials of a surface to what this device renders stably; return a sentence on the changes as well."""
    if surface.materials is None:
        return surface, ""
    pairs = {
        fromkey: fit(fromkey, spec, safety) for fromkey in dict.fromkeys(surface.materials)
    }  # however many labels have it
    materials = tuple(pairs[material] for material in surface.materials)
    return replace(surface, materials=materials), describe_changes(pairs)


GENTLER = {
    "stiffness_n_per_m": "softer than {they} {are}: the device cannot hold anything harder",
    "roughness_m": "more gently than {they} {are}: the device cannot go finer",
    "damping_n_s_per_m": "with less damping than {they} {have}: the device has no more",
}
"""How materials are felt where a device limits this field, and why."""


def describe_changes(pairs: Mapping[Material, Material]) -> str:
    """Describe which materials are felt otherwise than they are; empty if none. pairs: as they are to as they are felt.

    >>> sand = Material("sand", 400.0, 2.0, 0.2, 0.1, grain_m=1e-3, roughness_m=9e-5)
    >>> describe_changes({sand: replace(sand, roughness_m=3e-5)})
    'sand is felt more gently than it is: the device cannot go finer'
    """
    texts = list[str]()
    for field, text in GENTLER.items():
        names = [was.name for was, now in pairs.items() if getattr(was, field) != getattr(now, field)]
        if names:
            *most, last = names
            one = not most
            subject = last if one else f"{', '.join(most)} and {last}"
            words = {"they": "it" if one else "they", "are": "is" if one else "are", "have": "has" if one else "have"}
            texts.append(f"{subject} {words['are']} felt {text.format(**words)}")
    return "; ".join(texts)

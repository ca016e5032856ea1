"""Materials limited to what a device renders stably, one by one, before the guard would soften all of them."""

import math
from dataclasses import replace

from ..data import DeviceSpec, HapticSurface, Material
from ..servo.guard.safety import (
    NOMINAL_S,
    Safety,
    effective_damping_n_s_per_m,
    encoder_limit_n_per_m,
    stiffness_limit_n_per_m,
)

EXPLORING_N = 1.0
"""Press of a hand that explores (HaTT), under which the curvature of a texture adds stiffness."""


def fit(material: Material, spec: DeviceSpec, safety: Safety) -> Material:
    """Limit a material to what this device renders stably at 1 kHz; return itself if that is all of it.

    A wave of amplitude a and wavelength L under a press P is a sideways spring of at most P a (2 pi / L)^2. This and
    the material's stiffness together stay below the stiffness that the guard leaves to a force law. The damping B stays
    below what stiffness leaves of the device's damping b: b > K T (1 + 2 d) / 2 + B (1 + g^2), with g the greatest
    slope of the wave.
    Source: Colgate & Schenkel 1997, as `safety`.
    """
    damping = effective_damping_n_s_per_m(spec)
    most = _most_n_per_m(damping, spec, safety)
    if not most > 0:
        return material
    stiffness = min(material.stiffness_n_per_m, most)
    per_m = 2 * math.pi / material.grain_m
    roughness_m = min(material.roughness_m, (most - stiffness) / (EXPLORING_N * per_m**2))
    left = damping - stiffness * NOMINAL_S * (1 + 2 * safety.delay_ticks) / 2
    own = min(material.damping_n_s_per_m, max(0.0, left) / (1 + (roughness_m * per_m) ** 2))
    fitted = replace(material, stiffness_n_per_m=stiffness, roughness_m=roughness_m, damping_n_s_per_m=own)
    return material if fitted == material else fitted


def fit_surface(surface: HapticSurface, spec: DeviceSpec, safety: Safety) -> tuple[HapticSurface, str]:
    """Limit the materials of a surface to what this device renders stably; return a text on the changes as well."""
    if surface.materials is None:
        return surface, ""
    pairs = {each: fit(each, spec, safety) for each in dict.fromkeys(surface.materials)}  # however many labels have it
    materials = tuple(pairs[each] for each in surface.materials)
    if not (changes := ", ".join(filter(None, (describe_change(*pair) for pair in pairs.items())))):
        return surface, ""
    return replace(surface, materials=materials), f"limited to what the device renders stably: {changes}"


def describe_change(before: Material, after: Material) -> str:
    """Describe the change of a material; empty if there is none.

    >>> glass = Material("glass", 2500.0, 2.0, 0.2, 0.1, texture="smooth")
    >>> describe_change(glass, replace(glass, stiffness_n_per_m=2400.0))
    'glass (stiffness 2500 to 2400 N/m)'
    """
    each = (
        ("stiffness", before.stiffness_n_per_m, after.stiffness_n_per_m, "N/m"),
        ("texture", 1e6 * before.roughness_m, 1e6 * after.roughness_m, "um"),
        ("damping", before.damping_n_s_per_m, after.damping_n_s_per_m, "N s/m"),
    )
    texts = [f"{name} {was:g} to {float(f'{now:.3g}'):g} {unit}" for name, was, now, unit in each if was != now]
    return f"{before.name} ({', '.join(texts)})" if texts else ""


def _most_n_per_m(damping_n_s_per_m: float, spec: DeviceSpec, safety: Safety) -> float:
    """Return the stiffness that the guard leaves to a force law, as in `Safety.arrays`."""
    most = safety.stiffness_margin * stiffness_limit_n_per_m(damping_n_s_per_m, NOMINAL_S, safety.delay_ticks)
    if safety.friction_n is not None:
        most = min(most, safety.stiffness_margin * encoder_limit_n_per_m(safety.friction_n, spec.resolution_m))
    return min(most, spec.max_stiffness_n_per_m)

"""Materials made to fit a device: what it cannot hold of one is taken off that one, before the guard softens all."""

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
"""What a hand presses with that explores (HaTT): under it, a texture's curvature adds so much stiffness."""


def fit(material: Material, spec: DeviceSpec, safety: Safety) -> Material:
    """The material as far as this device holds it at 1 kHz; itself, where that is all of it.

    A wave of amplitude a and wavelength L under a press P is a spring sideways, of P a (2 pi / L)^2 at most: beside the
    material's stiffness it is to stay under what the guard leaves to a law, and the damping under what stiffness leaves
    of the device's own, b > K T (1 + 2 d) / 2 + B (1 + g^2), g the greatest slope of such a wave.
    Source: Colgate & Schenkel 1997, as `safety`.
    """
    damping = effective_damping_n_s_per_m(spec)
    most = _left_to_a_law(damping, spec, safety)
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
    """The surface with its materials as far as this device holds them, and what was taken off them, in words."""
    if surface.materials is None:
        return surface, ""
    pairs = {each: fit(each, spec, safety) for each in dict.fromkeys(surface.materials)}  # however many labels have it
    materials = tuple(pairs[each] for each in surface.materials)
    if not (said := ", ".join(filter(None, (changes(*pair) for pair in pairs.items())))):
        return surface, ""
    return replace(surface, materials=materials), f"softened to what the device holds: {said}"


def changes(before: Material, after: Material) -> str:
    """What was taken off a material, in words; empty where nothing was.

    >>> glass = Material("glass", 2500.0, 2.0, 0.2, 0.1, texture="smooth")
    >>> changes(glass, replace(glass, stiffness_n_per_m=2400.0))
    'glass (stiffness 2500 to 2400 N/m)'
    """
    each = (
        ("stiffness", before.stiffness_n_per_m, after.stiffness_n_per_m, "N/m"),
        ("texture", 1e6 * before.roughness_m, 1e6 * after.roughness_m, "um"),
        ("damping", before.damping_n_s_per_m, after.damping_n_s_per_m, "N s/m"),
    )
    said = [f"{what} {was:g} to {float(f'{now:.3g}'):g} {unit}" for what, was, now, unit in each if was != now]
    return f"{before.name} ({', '.join(said)})" if said else ""


def _left_to_a_law(damping_n_s_per_m: float, spec: DeviceSpec, safety: Safety) -> float:
    """The stiffness that the guard leaves to a law, as `Safety.arrays` has it."""
    held = safety.stiffness_margin * stiffness_limit_n_per_m(damping_n_s_per_m, NOMINAL_S, safety.delay_ticks)
    if safety.friction_n is not None:
        held = min(held, safety.stiffness_margin * encoder_limit_n_per_m(safety.friction_n, spec.resolution_m))
    return min(held, spec.max_stiffness_n_per_m)

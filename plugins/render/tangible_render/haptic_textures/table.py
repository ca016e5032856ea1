"""Materials as rows of numbers: heights as plane waves, h = sum a_i cos(2 pi (fx_i x + fy_i y + p_i)), and forces."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from tangible_core.data import Material, Texture

WAVES = 24  # largest number of waves of a material; each costs time in the servo loop
BESIDE_FRICTION = 8
STRAY, STRAY_OCTAVES, STRAY_DEG = 7, 0.1, 6.0
"""Number of waves that make a set of lines irregular, and their largest difference from it in length and direction."""

# Binary places of a cosine on its way: also near zero, 53 of them count, and what the sum loses is beyond.
BITS = 160


class Waves(NamedTuple):
    """Plane waves: spatial frequency in cycles per metre along x and y, amplitude in metres, phase in turns."""

    fx: Float64[np.ndarray, " n"]
    fy: Float64[np.ndarray, " n"]
    amplitude_m: Float64[np.ndarray, " n"]
    phase: Float64[np.ndarray, " n"]


def waves(material: Material) -> Waves:
    """Return the waves of a material, the same on every machine; none if its roughness is 0."""
    # Waves of random directions and phases (Shinozuka & Jan, J. Sound and Vibration 25(1), 1972) make a field that
    # never repeats, has an exact gradient and spectrum, and of which each wave can be left out alone where a servo
    # could not follow it. The squares of the amplitudes sum up to that of the roughness.
    random = np.random.default_rng([material.seed, *material.name.encode()])
    octaves, rotation_deg, share, phase = _MAKE[material.texture](material, random)
    per_m = powers_of_two(octaves) / material.grain_m
    way = np.deg2rad(material.direction_deg + 90 + rotation_deg)  # a wave runs across its lines
    across, along = directions(way)
    parts = Waves(per_m * across, per_m * along, material.roughness_m * np.sqrt(share), phase)
    present = parts.amplitude_m > 0
    return Waves(*(part[present] for part in parts))


def powers_of_two(exponents: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, " n"]:
    """Return 2^x, one by one: NumPy's power of an array has other last bits with AVX-512."""
    return np.array([2.0**exponent for exponent in exponents.tolist()])


def directions(angles_rad: Float64[np.ndarray, " n"]) -> tuple[Float64[np.ndarray, " n"], Float64[np.ndarray, " n"]]:
    """Return cosines and sines, correctly rounded: those of C libraries differ from system to system in last bits."""
    angles = angles_rad.tolist()
    return np.array([_circular(angle, 0) for angle in angles]), np.array([_circular(angle, 1) for angle in angles])


def _circular(angle_rad: float, first: int) -> float:
    """Return the cosine (first: 0) or sine (1) of an angle, by its series in whole numbers of 2^-BITS."""
    numerator, denominator = abs(angle_rad).as_integer_ratio()
    x = (numerator << BITS) // denominator
    square, term, total, power = x * x >> BITS, x if first else 1 << BITS, 0, first
    while term:
        total += term if power & 2 == 0 else -term
        power += 2
        term = (term * square >> BITS) // (power * (power - 1))
    return math.copysign(total / (1 << BITS), angle_rad * total if first else total)


Spread = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Waves as octaves above the grain's frequency, degrees from its direction, shares of the power, phases in turns."""


def _smooth(material: Material, random: np.random.Generator) -> Spread:
    none = np.empty(0)
    return none, none, none, none


def _noise(material: Material, random: np.random.Generator) -> Spread:
    """Return noise of one octave around the grain's wavelength, in directions over the half circle, or a part of it."""
    # Lengths and directions are stratified, so that every seed has the same spectrum: a triangle in octaves with its
    # tip at the grain. Under friction, which dominates, there are fewer waves: both must fit into a tick.
    count = BESIDE_FRICTION if material.texture == "stick-slip" else WAVES
    strata = (np.arange(count) + 0.5) / count
    octaves = 0.5 * np.sign(strata - 0.5) * (1 - np.sqrt(1 - np.abs(2 * strata - 1)))
    fan = (random.permutation(count) + random.random(count)) / count - 0.5
    return octaves, 180 * (1 - material.anisotropy) * fan, np.full(count, 1 / count), random.random(count)


def _periodic(material: Material, random: np.random.Generator) -> Spread:
    """Return a set of lines, and another across it with (1 - anisotropy) of its amplitude, each with irregularity."""
    power = np.array([1.0, (1 - material.anisotropy) ** 2])
    sets = [_lines(material.irregularity, random) for _ in power]
    shares = [lines[2] * share for lines, share in zip(sets, power / power.sum(), strict=True)]
    rotations = [lines[1] + right for lines, right in zip(sets, (0, 90), strict=True)]
    return (
        np.concatenate([lines[0] for lines in sets]),
        np.concatenate(rotations),
        np.concatenate(shares),
        np.concatenate([lines[3] for lines in sets]),
    )


def _lines(irregularity: float, random: np.random.Generator) -> Spread:
    """Return one wave, and STRAY similar ones that share the irregular part of the power."""
    strata = np.linspace(-1, 1, STRAY)
    return (
        STRAY_OCTAVES * np.append(0, strata),
        STRAY_DEG * np.append(0, random.permutation(strata)),
        np.append(1 - irregularity, np.full(STRAY, irregularity / STRAY)),
        np.append(0, random.random(STRAY)),
    )


_MAKE: dict[Texture, Callable[[Material, np.random.Generator], Spread]] = {
    "smooth": _smooth,
    "periodic": _periodic,
    "stochastic": _noise,
    "stick-slip": _noise,
    "drag": _noise,
}


# Columns: waves; drag [N s/m]; the bristle's stiffness [N/m] or 0, dynamic friction, its swing, slips per metre.
COUNT, DRAG, STIFFNESS, DYNAMIC, SWING, PER_M = range(6)
# Number of columns before the waves: fx, fy, amplitude and phase, WAVES of each (see `waves`).
HEAD = 8
# Largest swing: friction that reached 0 would have to stay there to be passive.
MAX_SWING = 0.9


def compile_textures(materials: Sequence[Material]) -> Float64[np.ndarray, "n p"]:
    """Compile materials to a read-only table, a row each, for `heights.texture_height` and `forces.texture_force`."""
    table = np.zeros((len(materials), HEAD + 4 * WAVES))
    for row, material in zip(table, materials, strict=True):
        parts = waves(material)
        row[COUNT] = len(parts.phase)
        row[DRAG] = material.drag_n_s_per_m
        if material.texture == "stick-slip":
            # A row with a bristle has all of the material's friction: a force law leaves its own out there.
            excess = material.static_friction / material.dynamic_friction - 1
            row[STIFFNESS : PER_M + 1] = (
                material.stiffness_n_per_m, material.dynamic_friction, min(excess, MAX_SWING), 1 / material.grain_m,
            )  # fmt: skip
        for start, part in zip(range(HEAD, len(row), WAVES), parts, strict=True):
            row[start : start + len(part)] = part
    table.flags.writeable = False
    return table


def bristle_stiffness(table: Float64[np.ndarray, "n p"]) -> float:
    """Return the largest stiffness of stick-slip friction, N/m: k mu_s / mu_d, its initial level; 0 without any."""
    return float(np.max(table[:, STIFFNESS] * (1 + table[:, SWING]), initial=0.0))

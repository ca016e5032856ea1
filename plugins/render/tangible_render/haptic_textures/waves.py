"""A material's heights as a sum of plane waves, h(x, y) = sum a_i cos(2 pi (fx_i x + fy_i y + p_i)).

Waves of random directions and phases make a field that never repeats, has an exact gradient and an exact spectrum, and
of which each wave can be left out by itself where a servo could not follow it. Sums of plane waves for random fields:
Shinozuka & Jan, J. Sound and Vibration 25(1), 1972.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64

from tangible_core.data import Material, Texture

WAVES = 24
"""The most of a material; each costs the servo its share."""
BESIDE_FRICTION = 8
"""Waves of the noise under friction that sticks and slips."""
STRAY, STRAY_OCTAVES, STRAY_DEG = 7, 0.1, 6.0
"""How many waves beside each set of lines are its irregularity, and how far they differ in length and direction."""


class Waves(NamedTuple):
    """Plane waves: spatial frequency in cycles per metre along x and y, amplitude in metres, phase in turns."""

    fx: Float64[np.ndarray, " n"]
    fy: Float64[np.ndarray, " n"]
    amplitude_m: Float64[np.ndarray, " n"]
    phase: Float64[np.ndarray, " n"]


def waves(material: Material) -> Waves:
    """The heights of a material; none where its roughness is 0.

    Whatever the model, the squares of the amplitudes sum up to that of the roughness, and the power is greatest at
    the wavelength of the grain. The same name and seed give the same waves everywhere.
    """
    octaves, turned_deg, share, phase = _MAKE[material.texture](material, _random(material))
    per_m = powers_of_two(octaves) / material.grain_m
    way = np.deg2rad(material.direction_deg + 90 + turned_deg)  # a wave runs across its lines
    made = Waves(per_m * np.cos(way), per_m * np.sin(way), material.roughness_m * np.sqrt(share), phase)
    kept = made.amplitude_m > 0
    return Waves(*(each[kept] for each in made))


def powers_of_two(exponents: Float64[np.ndarray, " n"]) -> Float64[np.ndarray, " n"]:
    """2^x one by one: NumPy's power of an array has other last bits where AVX-512 is."""
    return np.array([2.0**each for each in exponents.tolist()])


Spread = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Of each wave: octaves above the grain's frequency, degrees away from it, share of the power, phase in turns."""


def _smooth(material: Material, random: np.random.Generator) -> Spread:
    """None."""
    none = np.empty(0)
    return none, none, none, none


def _stochastic(material: Material, random: np.random.Generator) -> Spread:
    """Noise of one octave round the grain's wavelength; its directions fill the half circle, or less of it.

    Lengths and directions are stratified, one of each stratum, so that every seed has the same spectrum: triangular in
    octaves, its tip at the grain.
    """
    return _noise(WAVES, material.anisotropy, random)


def _stick_slip(material: Material, random: np.random.Generator) -> Spread:
    """The same noise of fewer waves: friction is what is felt, and both are to fit into a tick."""
    return _noise(BESIDE_FRICTION, material.anisotropy, random)


def _noise(count: int, anisotropy: float, random: np.random.Generator) -> Spread:
    strata = (np.arange(count) + 0.5) / count
    octaves = 0.5 * np.sign(strata - 0.5) * (1 - np.sqrt(1 - np.abs(2 * strata - 1)))
    fan = (random.permutation(count) + random.random(count)) / count - 0.5
    return octaves, 180 * (1 - anisotropy) * fan, np.full(count, 1 / count), random.random(count)


def _periodic(material: Material, random: np.random.Generator) -> Spread:
    """One set of lines, and across it another with (1 - anisotropy) of its amplitude; each with its strays."""
    power = np.array([1.0, (1 - material.anisotropy) ** 2])
    sets = [_lines(material.irregularity, random) for _ in power]
    shares = [each[2] * share for each, share in zip(sets, power / power.sum(), strict=True)]
    turned = [each[1] + right for each, right in zip(sets, (0, 90), strict=True)]
    return (
        np.concatenate([each[0] for each in sets]),
        np.concatenate(turned),
        np.concatenate(shares),
        np.concatenate([each[3] for each in sets]),
    )


def _lines(irregularity: float, random: np.random.Generator) -> Spread:
    """One wave, and STRAY beside it that share the irregular part of the power; strictly periodic without it."""
    strata = np.linspace(-1, 1, STRAY)
    return (
        STRAY_OCTAVES * np.append(0, strata),
        STRAY_DEG * np.append(0, random.permutation(strata)),
        np.append(1 - irregularity, np.full(STRAY, irregularity / STRAY)),
        np.append(0, random.random(STRAY)),
    )


def _random(material: Material) -> np.random.Generator:
    return np.random.default_rng([material.seed, *material.name.encode()])


_MAKE: dict[Texture, Callable[[Material, np.random.Generator], Spread]] = {
    "smooth": _smooth,
    "periodic": _periodic,
    "stochastic": _stochastic,
    "stick-slip": _stick_slip,
    "drag": _stochastic,
}

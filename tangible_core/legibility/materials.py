"""How far two materials lie apart, in differences that a hand just notices."""

from math import log

from ..data import Material

NOTICED = {"stiffness_n_per_m": 0.45, "dynamic_friction": 0.2, "roughness_m": 0.1, "grain_m": 0.1}
"""Shares by which two must differ to be told apart. Sources: see docs/legibility.md."""
LEAST = {"stiffness_n_per_m": 50.0, "dynamic_friction": 0.03, "roughness_m": 5e-6, "grain_m": 1e-4}
"""What is less feels like this."""


def apart(one: Material, other: Material) -> float:
    """Just noticeable differences between two materials, in what they differ most in; 1 at least for two textures.

    Differences are those of logarithms, as of what hands feel (Weber's law). The grain counts where both have one.
    """
    smooth = "smooth" in (one.texture, other.texture)
    steps = [0.0 if one.texture == other.texture else 1.0]
    for name, share in NOTICED.items():
        if name != "grain_m" or not smooth:
            values = (max(LEAST[name], float(getattr(each, name))) for each in (one, other))
            steps.append(abs(log(next(values) / next(values))) / log(1 + share))
    return max(steps)

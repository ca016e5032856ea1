"""The check of fine textures: a wave is felt only if it is sampled often enough."""

from collections.abc import Iterator

from ..flight import Flight
from ..verdict import Verdict, check_bound, over

SEEN, FEELS_RIGHT = 2, 5
"""Samples a wave: below the first number it is not felt, from the second on it feels right (10 are better)."""
SOURCE = "Campion & Hayward 2005: over 2 v T, from 5 v T to feel right"


def textures(flight: Flight) -> Iterator[Verdict]:
    """Check the grain of each present material against five samples a wave."""
    sample_m = max(flight.hand.speed_m_per_s * flight.period_s, flight.spec.resolution_m)
    yield Verdict("texture", "shortest wave", "ok", SEEN * sample_m, "m", source=SOURCE, note="at this rate and speed")
    for material in flight.present_materials:
        if material.roughness_m == 0 and material.texture != "stick-slip":
            continue
        bound_m, samples = FEELS_RIGHT * sample_m, material.grain_m / sample_m
        note = f"{samples:.3g} samples a wave"
        yield check_bound(
            *("texture", material.name, material.grain_m, ">=", bound_m, "m", SOURCE),
            says=f"the texture of {material.name} is too fine for a hand so fast",
            note=note if samples > SEEN else f"{note}: none of it is felt",
            cure=f"in a file for `materials.library`, `{material.name}: {{grain_m: {over(bound_m)}}}`; "
            f"or move slower than {material.grain_m / (FEELS_RIGHT * flight.period_s):.2g} m/s",
        )

"""Checks of details too small to feel: features of the relief, width by width, and waves of fine textures."""

from collections.abc import Iterator
from itertools import pairwise

from ..bumps import WIDTHS_M, feature_m, leakage, threshold_m
from ..flight import Flight
from ..verdict import Verdict, check_bound, over
from .cures import heighten

BUMPS = "Louw, Kappers & Koenderink 2000 (bare hand)"
NOTHING_M = 1e-7  # height below which a feature may be a rounding error of heights
# Ratio to the leakage of wider features above which a response counts as a feature of its width.
OWN = 1.2
# Samples a wave: below the first number it is not felt, from the second on it feels right (10 are better).
SEEN, FEELS_RIGHT = 2, 5
WAVES = "Campion & Hayward 2005: over 2 v T, from 5 v T to feel right"


def features(flight: Flight) -> Iterator[Verdict]:
    """Check the greatest feature of each width against a bump's threshold and the device's resolution."""
    relief, resolution_m = flight.surface.relief, flight.spec.resolution_m
    low, high = 2 * max(relief.pitch_m), min(relief.extent_m) / 2
    widths = [width for width in WIDTHS_M if low <= width <= high]
    height_m = {width: feature_m(relief, width) for width in widths}
    from_wider = {narrow: leakage(wide, narrow) * height_m[wide] for narrow, wide in pairwise(widths)}
    # The leakage of a wider feature into a narrower band is not a feature of that width. Widths that are too low are
    # not a fault if others are felt.
    own = [width for width in widths if height_m[width] > max(NOTHING_M, OWN * from_wider.get(width, 0.0))]
    if not own:
        whole_m = float(flight.surface.height_m.max() - flight.surface.height_m.min())
        cure = "only its materials can be felt: choose a scene with relief, or `workspace.width_m` for a larger one"
        note, says = "no feature 1 to 32 mm wide", "the relief has nothing that can be felt"
        yield Verdict("features", "the relief", "warn", whole_m, "m", note=note, cure=cure, says=says)
    bounds = {width: max(threshold_m(width), resolution_m) for width in own}
    any_felt = any(height_m[width] >= bound for width, bound in bounds.items())
    for width, bound in bounds.items():
        source = BUMPS if bound > resolution_m else "the device's resolution"
        yield check_bound(
            *("features", f"{1e3 * width:g} mm wide", height_m[width], ">=", bound, "m", source),
            worse="ok" if any_felt else "warn",
            note="" if height_m[width] >= bound else "too low to be felt",
            says="the relief is too low to be felt",
            cure="" if any_felt else [heighten(flight, bound / height_m[width])],
        )


def textures(flight: Flight) -> Iterator[Verdict]:
    """Check the grain of each present material against five samples a wave."""
    sample_m = max(flight.hand.speed_m_per_s * flight.period_s, flight.spec.resolution_m)
    yield Verdict("texture", "shortest wave", "ok", SEEN * sample_m, "m", source=WAVES, note="at this rate and speed")
    for material in flight.present_materials:
        if material.roughness_m == 0 and material.texture != "stick-slip":
            continue
        bound_m, samples = FEELS_RIGHT * sample_m, material.grain_m / sample_m
        note = f"{samples:.3g} samples a wave"
        yield check_bound(
            *("texture", material.name, material.grain_m, ">=", bound_m, "m", WAVES),
            says=f"the texture of {material.name} is too fine for a hand so fast",
            note=note if samples > SEEN else f"{note}: none of it is felt",
            cure=f"in a file for `materials.library`, `{material.name}: {{grain_m: {over(bound_m)}}}`; "
            f"or move slower than {material.grain_m / (FEELS_RIGHT * flight.period_s):.2g} m/s",
        )

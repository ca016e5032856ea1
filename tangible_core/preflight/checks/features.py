"""Features too small to feel: each width of the relief's against the lowest bump of that width that a hand feels."""

from collections.abc import Iterator
from itertools import pairwise

from ..bumps import WIDTHS_M, feature_m, left_over, threshold_m
from ..flight import Flight
from ..verdict import Verdict, held
from .cures import heighten

SOURCE = "Louw, Kappers & Koenderink 2000 (bare hand)"
NOTHING_M = 1e-7
"""Rounding of heights stays under this."""
OWN = 1.2
"""What a relief shows at one width is its own where it is so much more than wider features leave there."""


def features(flight: Flight) -> Iterator[Verdict]:
    """The greatest feature of each width that the relief has, against a bump's threshold and the device's resolution.

    What a wider feature leaves in a narrower band is no feature of that width. It is no fault that some widths are too
    low, as long as others are felt.
    """
    relief, resolution_m = flight.surface.relief, flight.spec.resolution_m
    low, high = 2 * max(relief.pitch_m), min(relief.extent_m) / 2
    widths = [width for width in WIDTHS_M if low <= width <= high]
    found = {width: feature_m(relief, width) for width in widths}
    of_wider = {narrow: left_over(wide, narrow) * found[wide] for narrow, wide in pairwise(widths)}
    own = [width for width in widths if found[width] > max(NOTHING_M, OWN * of_wider.get(width, 0.0))]
    if not own:
        yield _nothing(flight)
    bounds = {width: max(threshold_m(width), resolution_m) for width in own}
    any_felt = any(found[width] >= bound for width, bound in bounds.items())
    for width, bound in bounds.items():
        source = SOURCE if bound > resolution_m else "the device's resolution"
        yield held(
            *("features", f"{1e3 * width:g} mm wide", found[width], ">=", bound, "m", source),
            worse="ok" if any_felt else "warn",
            note="" if found[width] >= bound else "too low to be felt",
            says="the relief is too low to be felt",
            cure="" if any_felt else [heighten(flight, bound / found[width])],
        )


def _nothing(flight: Flight) -> Verdict:
    """Of a relief without a feature of any width that is looked at."""
    height_m = float(flight.surface.height_m.max() - flight.surface.height_m.min())
    cure = "only its materials can be felt: choose a scene with relief, or `workspace.width_m` for a larger one"
    note, says = "no feature 1 to 32 mm wide", "the relief has nothing that can be felt"
    return Verdict("features", "the relief", "warn", height_m, "m", note=note, cure=cure, says=says)

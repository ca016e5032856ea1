"""The height that each part gets in a relief of parts."""

import logging
from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool

from ...data import DisparityMap, PartMap
from ...parts import HeightChoice, PartHeights, depth_heights, guess_heights
from ...plugins.notes import note
from .working_grid import transparent_parts

log = logging.getLogger(__name__)

FINEST_DIGITS = 5
"""Of a height that was found, in metres: a hundredth of a millimetre is less than a hand feels, and is easy to read."""
MOST_NAMED = 8
"""Parts in a note."""


def heights_of(
    parts: PartMap,
    heights: HeightChoice,
    top_m: float,
    given_m: Mapping[int, float],
    disparity: DisparityMap | None = None,
    shown: Bool[np.ndarray, "h w"] | None = None,
) -> PartHeights:
    """The height of each part, and why: the given ones, and for the others what the recipe finds.

    top_m: the greatest that is found. disparity: on the grid of the parts; None where there is none to be found.
    shown: where the picture is opaque; what is transparent lies at 0.
    """
    found = _found(parts, heights, max(0.0, top_m), disparity)
    said = dict(enumerate(zip(found.heights_m, found.reasons, strict=True)))
    heights_m = {number: min(round(height_m, FINEST_DIGITS), top_m) for number, (height_m, _) in said.items()}
    reasons = {number: why for number, (_, why) in said.items()}
    for number in transparent_parts(parts, shown):
        heights_m[number], reasons[number] = 0.0, "transparent in the picture"
    for number, height_m in given_m.items():
        heights_m[number], reasons[number] = height_m, "given"
    return PartHeights(tuple(heights_m.values()), tuple(reasons.values()))


def _found(parts: PartMap, heights: HeightChoice, top_m: float, disparity: DisparityMap | None) -> PartHeights:
    if heights.by == "guess":
        return guess_heights(parts, top_m)
    if heights.by == "depth" and disparity is not None:
        return depth_heights(parts, disparity, top_m)
    why = "no height is given, so it lies at 0" if heights.by == "given" else "the views show no depth, so it lies at 0"
    return PartHeights((0.0,) * parts.count, (why,) * parts.count)


def warn_missing_heights(found: PartHeights, heights: HeightChoice, given_m: Mapping[int, float]) -> None:
    """Note what nobody said: a guess is a warning."""
    left = [number for number, why in enumerate(found.reasons) if number not in given_m and "transparent" not in why]
    if not left:
        return
    if heights.by == "guess":
        note(
            log,
            f"the heights of {_of(left, found)} are guessed, as a picture does not tell what stands in front of what; "
            "correct them in parts-guessed.yaml, which a run leaves in its folder, or give them: "
            "`heights: {by: given}`",
            logging.WARNING,
        )
    elif heights.by == "given":
        lies = "lies" if len(left) == 1 else "lie"
        note(log, f"no height is given for {_of(left, found)}, which {lies} at 0")


def _of(numbers: list[int], found: PartHeights) -> str:
    count = len(found.reasons)
    return f"all {count} parts" if len(numbers) == count > 1 else in_words(numbers)


def in_words(numbers: list[int]) -> str:
    """Parts in a sentence, the first of many.

    >>> in_words([3]), in_words([3, 5, 7])
    ('part 3', 'parts 3, 5 and 7')
    """
    if len(numbers) == 1:
        return f"part {numbers[0]}"
    first, rest = numbers[:MOST_NAMED], len(numbers) - MOST_NAMED
    *most, last = map(str, first) if rest <= 0 else (*map(str, first), f"{rest} more")
    return f"parts {', '.join(most)} and {last}"

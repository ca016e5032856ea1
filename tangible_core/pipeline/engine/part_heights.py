"""The height of each part in a relief of parts."""

import logging
from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool

from ...data import DisparityMap, PartMap
from ...data.part_words import name_part, shown_number
from ...parts import HeightChoice, PartHeights, depth_heights, guess_heights
from ...plugins.notes import note
from .working_grid import transparent_parts

log: logging.Logger = logging.getLogger(__name__)

# The decimals of a computed height in metres: a hundredth of a millimetre cannot be felt, and is easy to read.
FINEST_DIGITS = 5
MAX_NAMED = 8  # the most parts that a note names


def choose_heights(
    parts: PartMap,
    heights: HeightChoice,
    top_m: float,
    given_m: Mapping[int, float],
    disparity: DisparityMap | None = None,
    opaque_mask: Bool[np.ndarray, "h w"] | None = None,
    picture: np.ndarray | None = None,
) -> PartHeights:
    """Return the height of each part with its reason: the given heights, and computed ones up to top_m."""
    result = _compute(parts, heights, max(0.0, top_m), disparity, picture)
    heights_m = {number: min(round(each, FINEST_DIGITS), top_m) for number, each in enumerate(result.heights_m)}
    reasons = dict(enumerate(result.reasons))
    for number in transparent_parts(parts, opaque_mask):
        heights_m[number], reasons[number] = 0.0, "transparent in the picture"
    for number, height_m in given_m.items():
        heights_m[number], reasons[number] = height_m, "given"
    return PartHeights(tuple(heights_m.values()), tuple(reasons.values()))


def _compute(
    parts: PartMap, heights: HeightChoice, top_m: float, disparity: DisparityMap | None, picture: np.ndarray | None
) -> PartHeights:
    if heights.by == "guess":
        return guess_heights(parts, top_m, picture)
    if heights.by == "depth" and disparity is not None:
        return depth_heights(parts, disparity, top_m)
    why = "no height is given, so it lies at 0" if heights.by == "given" else "the views show no depth, so it lies at 0"
    return PartHeights((0.0,) * parts.count, (why,) * parts.count)


def warn_missing_heights(result: PartHeights, heights: HeightChoice, given_m: Mapping[int, float]) -> None:
    """Note the parts without a given height; guessed heights are a warning."""
    missing = [
        number for number, why in enumerate(result.reasons) if number not in given_m and "transparent" not in why
    ]
    if not missing:
        return
    count = len(result.reasons)
    parts = f"all {count} parts" if len(missing) == count > 1 else in_words(missing)
    if heights.by == "guess":
        note(
            log,
            f"the heights of {parts} are guessed, as a picture does not show which parts are in front; correct them in "
            "parts-guessed.yaml, which a run leaves in its folder, or give them: `heights: {by: given}`",
            logging.WARNING,
        )
    elif heights.by == "given":
        lies = "lies" if len(missing) == 1 else "lie"
        note(log, f"no height is given for {parts}, which {lies} at 0")


def in_words(numbers: list[int]) -> str:
    """Name parts in a sentence, the first of many.

    >>> in_words([3]), in_words([3, 5, 7])
    ('part 4', 'parts 4, 6 and 8')
    """
    if len(numbers) == 1:
        return name_part(numbers[0])
    first, rest = map(shown_number, numbers[:MAX_NAMED]), len(numbers) - MAX_NAMED
    *most, last = map(str, first) if rest <= 0 else (*map(str, first), f"{rest} more")
    return f"parts {', '.join(most)} and {last}"

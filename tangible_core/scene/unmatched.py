"""Whether anything at all was matched in a pair, in words."""

import numpy as np
from jaxtyping import Bool

from ..data import DisparityMap, Views
from .view_order import MATCHED

LEAST_MATCHED = 0.25
"""Part of the picture below which hardly anything was matched: good pairs reach 0.5 to 0.9, noise 0.02 to 0.12."""


def same_twice(views: Views, disparity: DisparityMap) -> str:
    """What to say of a depth that was asked of one picture twice; empty of two pictures, or where one is enough."""
    if disparity.unit != "px" or views.right is None or not np.array_equal(views.left, views.right):
        return ""
    return (
        "left and right are one and the same picture: nothing has moved between them, so no depth can be seen and the "
        "surface is flat. Name the two pictures of a pair, taken from side by side, or this one alone as a photo"
    )


def hardly_matched(disparity: DisparityMap, known: Bool[np.ndarray, "h w"] | None = None) -> str:
    """What to say of a map that is mostly filled in, with likely causes and cures; empty where enough was matched.

    known: where the picture shows anything.
    """
    matched = np.isfinite(disparity.disparity_px) & (disparity.confidence > MATCHED)
    shown = matched if known is None else matched[known]
    if disparity.unit != "px" or shown.size == 0 or (share := float(shown.mean())) >= LEAST_MATCHED:
        return ""
    return (
        f"hardly anything matches in the two pictures: a depth was found for {share:.0%} of the left one, and the rest "
        "is filled in. Check that both show the same scene at the same time, from side by side and equally sharp, and "
        "that left and right are not exchanged; let pictures of cameras that did not look in parallel be turned "
        "(`rectify: auto`); search a wider range (`max_disparity_px`); or try another depth method"
    )

"""The range found in a few bands: how much of the truth is tried, and what finding it costs."""

from functools import partial

import numpy as np

from tangible_depth.search.disparity_range import find_disparity_range, find_range
from tangible_depth.semi_global import SemiGlobal

from .depth_pairs import KnownScene, real, synthetic
from .figures import Figure
from .turns import in_turns

MAX_SHARE = 0.09  # of the time of the match


def figures() -> list[Figure]:
    """Coverage and cost on every pair."""
    scenes = {**real(), **synthetic()}
    covered = {name: coverage(scene) for name, scene in scenes.items()}
    shares = {name: cost(scene) for name, scene in scenes.items()}
    least, dearest = min(covered, key=covered.__getitem__), max(shares, key=shares.__getitem__)
    short = sum(share < 99.9 for share in covered.values())
    over = sum(share > MAX_SHARE for share in shares.values())
    measured = (
        f"covers {covered[least]:.2f} % at least ({least}; {short} of {len(covered)} below 99.9); takes "
        f"{100 * shares['motorcycle']:.1f} % on motorcycle, {100 * shares[dearest]:.1f} % at most "
        f"({dearest}; {over} over {100 * MAX_SHARE:.0f})"
    )
    bound = f">= 99.9 % of the truth at <= {100 * MAX_SHARE:.0f} % of the match time"
    return [Figure("automatic range", bound, measured, covered[least] >= 99.9 and shares[dearest] <= MAX_SHARE)]


def coverage(scene: KnownScene) -> float:
    """Share of the true disparities within the range that is tried, in percent."""
    span, truth = find_disparity_range(scene.grey, "auto", "auto").span, scene.pair.truth_px
    truth = truth[np.isfinite(truth)]
    return 100 * float(np.mean((truth >= span.low) & (truth <= span.high)))


def cost(scene: KnownScene) -> float:
    """Time of finding the range over that of matching with the range given."""
    method = SemiGlobal(max_disparity_px=scene.disparities)
    return in_turns({"match": partial(method.estimate, scene.views), "range": partial(find_range, scene.grey)}, 9)[
        "range"
    ].ratio

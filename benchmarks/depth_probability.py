"""The table by which a confidence of `semi-global` states a probability, fitted to synthetic scenes of odd seeds alone.

`python -m benchmarks.depth_probability` prints OF_FILLED and OF_MATCHED of `tangible_depth.dense.confidence`, in about
5 minutes of one core. No photograph is used, and no scene of an even seed, on which the table is judged.
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float32

from tangible_bench.metrics.standard_sets import WRONG_PX
from tangible_core.testing.synthetic.stereo_scenes import SCENES, KnownPair, synthetic_pair
from tangible_depth.dense.confidence import FILLED
from tangible_depth.semi_global import SemiGlobal

from .depth_materials import pair_of_materials

OF_MATERIALS, PLAIN = range(1, 101, 2), range(1, 21, 2)
"""Seeds of scenes of many materials and lights, and of each of the four kinds of the benchmark."""
HIGHEST_FILLED = float(np.float32(FILLED))
FILLED_EDGES = np.linspace(0, HIGHEST_FILLED, 9)
MATCHED_EDGES = np.array([HIGHEST_FILLED, 0.22, 0.26, 0.3, 0.34, 0.38, 0.42, 0.46, 0.5, 0.55, 0.6, 0.7, 0.8, 1])
"""Ends of the ranges of confidence whose means are the table's places."""
# Share of errors by which scenes are weighted: 1 / (share + this), so that hard ones do not drown the others.
EVEN_OUT = 0.02


def main() -> None:
    """Fit both tables and print them."""
    found = [_sure_and_right(pair) for pair in _pairs()]
    sure, right = (np.concatenate(each) for each in zip(*found, strict=True))
    weight = np.concatenate([np.full(len(each), 1 / (np.mean(~each) + EVEN_OUT)) for _, each in found])
    for name, edges in (("OF_FILLED", FILLED_EDGES), ("OF_MATCHED", MATCHED_EDGES)):
        places, probabilities = fit(sure, right, weight, edges)
        print(name, np.round(places, 3).tolist(), np.round(probabilities, 3).tolist())


def _pairs() -> Iterator[KnownPair]:
    yield from (pair_of_materials(seed) for seed in OF_MATERIALS)
    yield from (synthetic_pair(kind, seed=seed) for seed in PLAIN for kind in SCENES)


def _sure_and_right(pair: KnownPair) -> tuple[Float32[np.ndarray, " n"], Bool[np.ndarray, " n"]]:
    found = SemiGlobal(rectify="never").estimate(pair.views)
    known = np.isfinite(pair.truth_px)
    return found.confidence[known], (np.abs(found.disparity_px - pair.truth_px) <= WRONG_PX)[known]


def fit(sure: np.ndarray, right: np.ndarray, weight: np.ndarray, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean confidence of each range, and the share that is right, which never falls (pool of violators)."""
    at = np.digitize(sure, edges, right=True) - 1
    inside = (at >= 0) & (at < len(edges) - 1)
    count, places, shares = (
        np.bincount(at[inside], (weight * each)[inside], minlength=len(edges) - 1) for each in (1, sure, right)
    )
    blocks: list[tuple[float, float, int]] = []
    for total, share in zip(count, shares, strict=True):
        blocks.append((total, share, 1))
        while len(blocks) > 1 and blocks[-2][1] * blocks[-1][0] >= blocks[-1][1] * blocks[-2][0]:
            (n, m, i), (u, v, j) = blocks.pop(), blocks.pop()
            blocks.append((n + u, m + v, i + j))
    return places / count, np.concatenate([np.full(pieces, share / total) for total, share, pieces in blocks])


if __name__ == "__main__":
    main()

"""The sweep of a few columns against semi-global matching written out plainly."""

import numpy as np
import pytest

from semi_global_plainly import plain_disparity, plain_sums
from stereo_scenes import step
from tangible_depth.dense.span import UNKNOWN, Span
from tangible_depth.search.sparse_sweep import FEWEST_LANES, sweep_columns
from tangible_depth.sgm.census import census
from tangible_depth.sgm.costs import SHARP


def pair(kind: str, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Return a scene of two surfaces, or noise of few greys, so that sums are often equal."""
    if kind == "noise":
        left, right = np.random.default_rng(1).choice([0, 90, 255], (2, *shape)).astype(np.uint8)
        return left, right
    views, _, _ = step(shape=shape, back=2, front=7, box=(3, shape[0] - 2, 14, shape[1] - 20))
    return np.asarray(views.left), np.asarray(views.right)


@pytest.mark.parametrize("kind", ["scene", "noise"])
@pytest.mark.parametrize("stride", [1, 3])
@pytest.mark.parametrize(("shape", "span"), [((9, 80), Span(-9, 40)), ((8, 71), Span(0, 63)), ((5, 40), Span(-30, -2))])
def test_swept_columns_equal_plain_semi_global_matching(kind: str, stride: int, shape: tuple[int, int], span: Span):
    left, right = pair(kind, shape)
    out = np.full(shape, np.int16(7))
    codes = census(left), census(right)
    sweep_columns(*codes, np.ascontiguousarray(left[:, ::stride]), span, SHARP.penalties, stride, out)
    tried = Span(span.low, span.low + FEWEST_LANES - 1)
    sums = plain_sums(left, right, tried, SHARP.penalties, stride)
    assert np.array_equal(out, plain_disparity(sums, tried, 1.0, stride, shape[1]))
    assert (out != UNKNOWN).any()

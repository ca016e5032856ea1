"""The probability that a confidence of `semi-global` states."""

import numpy as np
import pytest

from tangible_bench.metrics.sparsification import WRONG_PX
from tangible_core.testing.synthetic.stereo_scenes import synthetic_pair
from tangible_depth.dense.confidence import FILLED, OF_FILLED, OF_MATCHED, probability
from tangible_depth.semi_global import SemiGlobal


def test_probability_is_read_between_the_places_of_its_table():
    for table in (OF_FILLED, OF_MATCHED):
        places, probabilities = (np.array(each) for each in table)
        assert np.allclose(probability(places.astype(np.float32)), probabilities, atol=1e-6)
        between = (places[1:] + places[:-1]) / 2
        assert np.allclose(
            probability(between.astype(np.float32)), (probabilities[1:] + probabilities[:-1]) / 2, atol=1e-4
        )
        assert (np.diff(places) > 0).all()
        assert (np.diff(probabilities) >= 0).all()


def test_highest_confidence_of_a_filled_value_is_not_that_of_a_match():
    highest, above = probability(np.array([FILLED, np.nextafter(np.float32(FILLED), np.float32(1))], np.float32))
    assert highest == pytest.approx(OF_FILLED[1][-1])
    assert above == pytest.approx(OF_MATCHED[1][0])


@pytest.mark.parametrize("kind", ["planes", "steps", "spheres", "bars"])
def test_probability_is_the_share_of_right_values(kind):
    """On scenes of even seeds, to which nothing was fitted: of all values, and of matches alone."""
    stated, right, matched = [], [], []
    for seed in (6, 8):
        pair = synthetic_pair(kind, seed=seed)
        found = SemiGlobal(rectify="never").estimate(pair.views)
        stated.append(probability(found.confidence).ravel())
        right.append((np.abs(found.disparity_px - pair.truth_px) <= WRONG_PX).ravel())
        matched.append(found.confidence.ravel() > FILLED)
    p, is_right, is_match = (np.concatenate(each) for each in (stated, right, matched))
    assert abs(p.mean() - is_right.mean()) <= 0.03
    assert abs(p[is_match].mean() - is_right[is_match].mean()) <= 0.02
    surer = is_match & (p >= 0.98)
    assert (~is_right[is_match & ~surer]).mean() > 2 * (~is_right[surer]).mean()

"""Elementary functions against those of NumPy in double precision: what depth and textures are computed with."""

import numpy as np
import pytest

from tangible_core.compiled.elementary import exponentials, hyperbolic_tangents, logarithms

RANDOM = np.random.default_rng(0)


def test_exponential_is_correct_within_two_last_bits():
    values = np.append(RANDOM.uniform(-86, 87, 100_000), [0, 1, -1]).astype(np.float32)
    np.testing.assert_allclose(exponentials(values), np.exp(values.astype(np.float64)), rtol=2.5e-7)
    assert exponentials(np.zeros((2, 3), np.float32)).tolist() == [[1, 1, 1], [1, 1, 1]]


def test_exponential_is_clamped_to_the_range_of_float32():
    ends = exponentials(np.array([-np.inf, -1e30, -87, 88, 1e30, np.inf], np.float32))
    assert ends[0] == ends[1] == ends[2] == pytest.approx(np.exp(-87), rel=1e-6, abs=0)
    assert ends[3] == ends[4] == ends[5] == pytest.approx(np.exp(88), rel=1e-6)


def test_logarithm_is_correct_within_two_last_bits():
    values = np.append(np.exp(RANDOM.uniform(-87, 88, 100_000)), RANDOM.uniform(0.5, 2, 100_000)).astype(np.float32)
    np.testing.assert_allclose(logarithms(values), np.log(values.astype(np.float64)), rtol=2.5e-7)
    assert logarithms(np.ones(1, np.float32)).tolist() == [0]


def test_hyperbolic_tangent_is_correct_within_a_few_last_bits():
    values = np.append(RANDOM.normal(0, 2, 100_000), 10.0 ** -np.arange(30)).astype(np.float32)
    expected = np.tanh(values.astype(np.float64))
    np.testing.assert_allclose(hyperbolic_tangents(values), expected, rtol=5e-7)
    assert (hyperbolic_tangents(-values) == -hyperbolic_tangents(values)).all()
    assert hyperbolic_tangents(np.array([-np.inf, np.inf], np.float32)).tolist() == [-1, 1]

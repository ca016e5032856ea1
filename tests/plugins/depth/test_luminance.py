"""Luminance: lighter is nearer."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tangible_core import Views
from tangible_depth.luminance import Luminance


def raw(picture):
    return Luminance(smoothing_px=0).estimate(Views(picture))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_lighter_pixels_are_nearer_at_every_shade(dtype):
    found = raw(np.array([[10, 20], [30, 50]], dtype) / dtype(100 if dtype == np.float32 else 1))
    np.testing.assert_allclose(found.disparity_px, [[0, 0.25], [0.5, 1]], atol=1e-6)
    assert found.unit == "relative"
    assert (found.confidence == 1).all()


def test_luma_gives_the_nearness_of_colours():
    found = raw(np.uint8([[[0, 0, 0], [255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]]]))
    np.testing.assert_allclose(found.disparity_px, [[0, 0.299, 0.587, 0.114, 1]], atol=1e-6)


@pytest.mark.parametrize("smoothing_px", [0, 2, 50])
@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (20, 30), (20, 30, 3), (20, 30, 4)])
def test_picture_of_one_shade_is_flat_at_zero(shape, smoothing_px):
    found = Luminance(smoothing_px=smoothing_px).estimate(Views(np.full(shape, 77, np.uint8)))
    assert found.disparity_px.shape == shape[:2]
    assert not found.disparity_px.any()


def test_smoothing_leaves_no_steps_of_eight_bits():
    ramp = np.repeat(np.linspace(100, 110, 400)[None], 20, axis=0).astype(np.uint8)
    steps = np.diff(Luminance(smoothing_px=25).estimate(Views(ramp)).disparity_px[10])
    assert np.diff(raw(ramp).disparity_px[10]).max() == pytest.approx(0.1)
    assert steps.min() >= 0
    assert steps.max() < 0.01


def test_smoothing_flattens_noise_and_keeps_edges():
    noise = np.random.default_rng(0).normal(0, 0.01, (40, 80))
    edge = np.where(np.arange(80) < 40, 0.3, 0.7) + noise
    found = Luminance(smoothing_px=4, edge_contrast=0.05).estimate(Views(edge)).disparity_px
    before = raw(edge).disparity_px
    assert found[:, :30].std() < before[:, :30].std() / 3
    assert np.median(found[:, 40] - found[:, 39]) > 0.9 * np.median(before[:, 40] - before[:, 39])


@given(
    hnp.arrays(np.float64, st.tuples(st.integers(1, 9), st.integers(1, 9)), elements=st.floats(0, 1)),
    st.integers(0, 30),
    st.floats(1e-6, 1),
)
def test_any_picture_is_relative_from_0_to_1(picture, smoothing_px, edge_contrast):
    method = Luminance(smoothing_px=smoothing_px, edge_contrast=edge_contrast)
    found = method.estimate(Views(picture)).disparity_px
    assert found.dtype == np.float32
    assert found.min() == 0
    assert found.max() in (0, 1)

"""Relief from one picture: else a photograph is felt inside out, in steps, or with its shading."""

import numpy as np
import pytest

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

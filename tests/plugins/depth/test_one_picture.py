"""Relief from one picture: else a photograph is felt inside out, in steps, or with its shading."""

import numpy as np
import pytest

from tangible_core import Views
from tangible_depth.contour import Contour
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


def test_smooth_bump_with_all_slopes_kept_is_restored():
    y, x = np.mgrid[:61, :83]
    bump = np.exp(-((x - 40) ** 2 + (y - 30) ** 2) / 200).astype(np.float32)
    found = Contour(smoothing_px=0, weak_edge=0, strong_edge=0.01, least_contrast=1e-6).estimate(Views(bump))
    expected = (bump - bump.min()) / np.ptp(bump)
    assert found.unit == "relative"
    assert found.disparity_px == pytest.approx(expected, abs=1e-3)
    assert found.confidence == pytest.approx(1, abs=1e-3)


def test_steps_are_kept_and_shading_is_removed():
    shading = np.tile(np.linspace(0.2, 0.4, 80), (60, 1))
    shading[:, 40:] += 0.4
    relief = Contour(smoothing_px=0).estimate(Views(shading)).disparity_px
    assert relief[:, :40] == pytest.approx(0, abs=1e-4)
    assert relief[:, 40:] == pytest.approx(1, abs=1e-4)


def test_blurred_step_keeps_its_height():
    picture = np.zeros((60, 120), np.uint8)
    picture[:, 40:] = 100
    picture[:, 80:] = 200
    relief = Contour().estimate(Views(picture)).disparity_px
    assert relief[30, [10, 60, 110]] == pytest.approx([0, 0.5, 1], abs=0.01)


def test_noise_below_the_least_contrast_is_flat():
    noise = 128 + np.random.default_rng(0).integers(0, 2, (50, 50))
    assert not Contour().estimate(Views(noise.astype(np.uint8))).disparity_px.any()


def test_contradicting_contours_lower_the_confidence():
    picture = np.zeros((40, 60))
    picture[:, 30:] = np.linspace(0, 1, 40)[:, None]  # a step that fades: no surface has these slopes alone
    confidence = Contour().estimate(Views(picture)).confidence
    assert confidence.min() < 0.95
    assert confidence[20, 5] > confidence.min()

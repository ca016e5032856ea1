import numpy as np
import pytest

from tangible_core.data import Views
from tangible_depth.contour import Contour


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


@pytest.mark.parametrize("shape", [(20, 30), (1, 1), (1, 9), (9, 1), (20, 30, 3), (20, 30, 4)])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.bool_, np.float32, np.float64])
def test_flat_picture_is_flat(shape, dtype):
    found = Contour().estimate(Views(np.ones(shape, dtype)))
    assert found.disparity_px.dtype == np.float32
    assert not found.disparity_px.any()
    assert np.all(found.confidence == 1)


def test_noise_below_the_least_contrast_is_flat():
    noise = 128 + np.random.default_rng(0).integers(0, 2, (50, 50))
    assert not Contour().estimate(Views(noise.astype(np.uint8))).disparity_px.any()


def test_relief_is_the_same_for_every_dtype():
    grey = np.random.default_rng(0).integers(0, 256, (40, 50)).astype(np.uint8)
    relief = Contour().estimate(Views(grey)).disparity_px
    assert relief.min() == 0
    assert relief.max() == 1
    for other in (grey.astype(np.uint16) * 257, grey / 255, np.stack([grey] * 3, axis=2)):
        assert Contour().estimate(Views(other)).disparity_px == pytest.approx(relief, abs=1e-4)


def test_contradicting_contours_lower_the_confidence():
    picture = np.zeros((40, 60))
    picture[:, 30:] = np.linspace(0, 1, 40)[:, None]  # a step that fades: no surface has these slopes alone
    confidence = Contour().estimate(Views(picture)).confidence
    assert confidence.min() < 0.95
    assert confidence[20, 5] > confidence.min()

"""Relief from one picture: else it is felt inside out, in steps, or with a depth that nobody saw."""

from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from onnx_models import mono
from tangible_core import Views
from tangible_core.errors import PictureError
from tangible_depth.cues import Cues, order_probability, score_nearness
from tangible_depth.luminance import Luminance

pytestmark = pytest.mark.usefixtures("models")


def room() -> np.ndarray:
    """A grey floor below a dark wall, with two posts: the light one stands nearer than the red one."""
    picture = np.zeros((200, 300, 3), np.uint8)
    picture[:100] = 40, 40, 60
    for row in range(100, 200):
        picture[row] = 110 + row // 4, 100, 80
    picture[60:180, 40:70] = 240, 240, 235
    picture[60:125, 200:230] = 180, 20, 20
    grain = gaussian_filter(np.random.default_rng(0).normal(0, 60, (200, 300, 1)), (1, 1, 0))
    return np.clip(picture + grain, 0, 255).astype(np.uint8)


def test_regions_are_scored_by_the_formula_from_top_to_bottom() -> None:
    nearness = Cues().estimate(Views(room())).disparity_px
    light, red, wall = nearness[70:115, 50:60].mean(), nearness[70:115, 210:220].mean(), nearness[70:95, 120].mean()
    assert light > red > wall, "at the same rows"
    assert (np.diff(nearness[110:200, 150]) > 0).all(), "the floor recedes"
    confidence = Cues().estimate(Views(room())).confidence
    assert min(confidence[0, 150], confidence[199, 150]) > 1.1 * confidence[105, 150]
    assert order_probability(np.array(0.0)) == 0.5
    assert (nearness.min(), nearness.max()) == (0, 1)
    regions = np.array([[0, 1], [0, 1], [0, 0], [0, 0]], np.int32)
    own = np.array([0, 0.25, 0.5, 0.75])
    scores = score_nearness(regions, None)
    assert scores[:, 0] == pytest.approx(0.75 + 0.25 * (2.75 / 6) + own)
    assert scores[:2, 1] == pytest.approx(0.25 + 0.25 * 0.125 + own[:2])
    with_figure = score_nearness(regions, np.float32([[0, 1], [0, 1], [0, 0], [0, 0]]))
    assert with_figure - scores == pytest.approx(0.4 * (regions == 1))


def test_figure_is_nearer_and_a_portrait_is_refused(models: Path) -> None:
    before = Cues().estimate(Views(room())).disparity_px
    mono(models / "own.onnx")
    (models / "own.yaml").write_text("task: figure\noutput: {means: figure}\n")
    after = Cues().estimate(Views(room())).disparity_px
    assert (after - before)[70:115, 50:60].mean() > 0.02, "the light post is the figure"
    assert Cues().reads() == (models / "own.onnx",)
    portrait = room()
    portrait[150:, 20:280] = 250
    with pytest.raises(PictureError, match="portrait"):
        Cues().estimate(Views(portrait))


ROW, COLUMN = np.mgrid[:150, :200]
ON_NO_GROUND = {
    "a page": np.where((ROW % 20 < 5) & (ROW > 20) & (abs(COLUMN - 100) < 80), 60, 250),
    "coins in slanting light": np.where((ROW % 50 - 25) ** 2 + (COLUMN % 50 - 25) ** 2 < 300, 180, 60 + COLUMN / 3),
    "a map up to the rim": np.where(COLUMN + ROW / 9 < 90, 200, np.where(ROW < 80 + COLUMN / 9, 120, 60)),
}


@pytest.mark.parametrize("sigma", [0, 8])
@pytest.mark.parametrize("name", ON_NO_GROUND)
def test_what_stands_on_no_ground_is_refused_in_noise_as_well(name: str, sigma: float) -> None:
    noisy = ON_NO_GROUND[name] + np.random.default_rng(0).normal(0, sigma, ROW.shape)
    with pytest.raises(PictureError, match="drawn"):
        Cues().estimate(Views(np.clip(noisy, 0, 255).astype(np.uint8)))


def raw(picture):
    return Luminance(smoothing_px=0).estimate(Views(picture))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_lighter_pixels_are_nearer_at_every_shade(dtype):
    found = raw(np.array([[10, 20], [30, 50]], dtype) / dtype(100 if dtype == np.float32 else 1))
    np.testing.assert_allclose(found.disparity_px, [[0, 0.25], [0.5, 1]], atol=1e-6)
    assert found.unit == "relative"
    assert (found.confidence == 1).all()


def test_nearness_is_the_luma_smoothed_without_steps():
    found = raw(np.uint8([[[0, 0, 0], [255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]]]))
    np.testing.assert_allclose(found.disparity_px, [[0, 0.299, 0.587, 0.114, 1]], atol=1e-6)
    ramp = np.repeat(np.linspace(100, 110, 400)[None], 20, axis=0).astype(np.uint8)
    steps = np.diff(Luminance(smoothing_px=25).estimate(Views(ramp)).disparity_px[10])
    assert np.diff(raw(ramp).disparity_px[10]).max() == pytest.approx(0.1)
    assert steps.min() >= 0
    assert steps.max() < 0.01
    noise = np.random.default_rng(0).normal(0, 0.01, (40, 80))
    edge = np.where(np.arange(80) < 40, 0.3, 0.7) + noise
    found = Luminance(smoothing_px=4, edge_contrast=0.05).estimate(Views(edge)).disparity_px
    before = raw(edge).disparity_px
    assert found[:, :30].std() < before[:, :30].std() / 3
    assert np.median(found[:, 40] - found[:, 39]) > 0.9 * np.median(before[:, 40] - before[:, 39])

"""OpenCV's matcher on walls and steps: else it is wrong, or trusts what it does not know."""

import numpy as np
import pytest

from tangible_core import Views
from tangible_core.errors import OptionError
from tangible_core.scene.geometry import fill_rows
from tangible_depth.opencv_sgbm import MODES, OpenCVSGBM

EVERY_MODE = pytest.mark.parametrize("mode", MODES)


def texture(shape, seed=0):
    return np.random.default_rng(seed).integers(0, 256, shape, dtype=np.uint8)


def wall_views(disparity_px, shape=(48, 96)):
    """Both views of a wall of random texture: exact at whole disparities, everything seen in both."""
    wide = texture((shape[0], shape[1] + 64))
    return Views(wide[:, 32 : 32 + shape[1]], wide[:, 32 + disparity_px : 32 + disparity_px + shape[1]])


def step(near_px=10, far_px=2, shape=(60, 160)):
    """A near square before a far wall: views, true disparity, and where the right view sees the left one's pixels."""
    truth = np.full(shape, far_px)
    truth[15:45, 60:110] = near_px
    wide = texture((shape[0], shape[1] + far_px))
    left, right = wide[:, : shape[1]].copy(), wide[:, far_px:].copy()
    square = texture((30, 50), seed=1)
    left[15:45, 60:110] = square
    right[15:45, 60 - near_px : 110 - near_px] = square
    seen = np.ones(shape, bool)
    seen[15:45, 60 - (near_px - far_px) : 60] = False
    seen[:, :far_px] = False
    return Views(left, right), truth, seen


def estimate(views, **options):
    return OpenCVSGBM(**options).estimate(views)


@EVERY_MODE
@pytest.mark.parametrize("disparity_px", [0, 1, 5, 17])
def test_wall_is_matched_at_its_disparity(mode, disparity_px):
    found = estimate(wall_views(disparity_px), mode=mode)
    error = np.abs(found.disparity_px - disparity_px)[:, disparity_px:]
    assert found.disparity_px.dtype == found.confidence.dtype == np.float32
    assert np.isfinite(error).mean() > 0.98
    assert np.nanmax(error) < 1
    assert np.nanmax(error[5:-5, 5:-5]) <= 1 / 16  # blocks that see no border; OpenCV counts in sixteenths
    assert np.median(found.confidence[:, disparity_px:]) == 1


@EVERY_MODE
def test_step_is_matched_and_its_occlusion_not_trusted(mode):
    views, truth, seen = step()
    found = estimate(views, mode=mode, max_disparity_px=32)
    near_edge = np.zeros_like(seen)  # blocks there hold both depths
    near_edge[12:48, 48:114] = True
    near_edge[18:42, 63:107] = False
    wrong = ~(np.abs(found.disparity_px - truth) < 0.5)
    assert wrong[seen & ~near_edge].mean() < 0.01
    assert np.median(found.confidence[seen & ~near_edge]) > 0.9
    assert found.confidence[~seen].mean() < 0.1


def test_requested_range_alone_is_tried():
    found = estimate(wall_views(17), max_disparity_px=17).disparity_px
    assert not (np.abs(found - 17) < 0.5).any()
    assert np.nanmax(np.where(np.isnan(found), -1, found)) < 16.5


def test_filled_pixels_follow_the_stated_rule_without_confidence():
    views = step()[0]
    holed, filled = estimate(views), estimate(views, fill=True)
    holes = np.isnan(holed.disparity_px)
    assert holes.any()
    np.testing.assert_array_equal(filled.disparity_px, fill_rows(holed.disparity_px))
    assert not filled.confidence[holes].any()
    np.testing.assert_array_equal(filled.confidence, holed.confidence)


def test_known_pixels_without_a_second_pass_are_trusted():
    views = step()[0]
    once, twice = estimate(views, second_pass=False), estimate(views)
    np.testing.assert_array_equal(once.disparity_px, twice.disparity_px)
    np.testing.assert_array_equal(once.confidence, np.isfinite(once.disparity_px))


def test_flat_patch_is_unknown_and_its_border_known():
    views = wall_views(0, (60, 120))
    left = views.left.copy()
    left[20:40, 40:80] = 100
    found = estimate(Views(left, left), block_px=5)
    unknown = np.isnan(found.disparity_px)
    assert unknown[22:38, 42:78].all()
    assert not unknown[:18].any()
    assert not unknown[22:38, [41, 78]].any()


@EVERY_MODE
@pytest.mark.parametrize("block_px", [1, 11])
def test_smallest_pictures_are_matched(mode, block_px):
    for shape in ((1, 1), (1, 40), (40, 1), (2, 2), (7, 20)):
        for low, high in ((0, 64), (-48, 16), (-64, -16), (16, 48)):
            options = {"mode": mode, "min_disparity_px": low, "max_disparity_px": high, "block_px": block_px}
            found = estimate(Views(texture(shape), texture(shape, seed=1)), **options).disparity_px
            known = found[np.isfinite(found)]
            assert found.shape == shape
            assert ((known >= low - 0.5) & (known < high - 0.5)).all()


@pytest.mark.parametrize(
    "options", [{"min_disparity_px": 64}, {"max_disparity_px": 0}, {"block_px": 4}, {"max_disparity_px": 5000}]
)
def test_contradicting_options_are_refused(options):
    with pytest.raises(OptionError):
        OpenCVSGBM(**options)


def test_identical_views_skip_the_matching():
    views = wall_views(4)
    assert OpenCVSGBM().skip(views) is None
    assert OpenCVSGBM().skip(Views(views.left, views.left.copy()))

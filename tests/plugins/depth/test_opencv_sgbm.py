"""The methods that others replace, on scenes that are known: else comparisons with them say nothing."""

import sys

import numpy as np
import pytest
import torch

from tangible_core.data import Views
from tangible_core.errors import OptionError, TangibleError
from tangible_core.scene.geometry import fill_rows
from tangible_depth.kornia_report import KorniaReport, kornia_eight_point, kornia_response
from tangible_depth.kornia_zncc import KorniaZNCC
from tangible_depth.opencv_sgbm import MODES, OpenCVSGBM
from tangible_depth.rectify.fundamental import eight_point
from tangible_depth.report import Report
from tangible_depth.sparse.harris import harris_response
from tangible_depth.windows.torch_zncc import OUTSIDE, best_shifts, scores
from two_cameras import Scene, roll_and_tilt, seen_points

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


def test_pixels_without_a_match_are_unknown_or_filled_in_the_range():
    found = estimate(wall_views(17), max_disparity_px=17).disparity_px
    assert not (np.abs(found - 17) < 0.5).any()
    assert np.nanmax(np.where(np.isnan(found), -1, found)) < 16.5
    views = step()[0]
    holed, filled = estimate(views), estimate(views, fill=True)
    holes = np.isnan(holed.disparity_px)
    assert holes.any()
    np.testing.assert_array_equal(filled.disparity_px, fill_rows(holed.disparity_px))
    assert not filled.confidence[holes].any()
    np.testing.assert_array_equal(filled.confidence, holed.confidence)
    once, twice = estimate(views, second_pass=False), holed
    np.testing.assert_array_equal(once.disparity_px, twice.disparity_px)
    np.testing.assert_array_equal(once.confidence, np.isfinite(once.disparity_px))
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


METHODS = [KorniaZNCC(), KorniaReport(), Report()]


@pytest.mark.parametrize("method", METHODS, ids=["kornia-zncc", "kornia-report", "report"])
def test_known_scene_gives_its_disparity(method):
    scene = Scene()
    found = method.estimate(Views(scene.left(), scene.right()))
    error = np.abs(found.disparity_px - scene.disparity_px())
    assert np.mean(error[scene.visible()] <= 2) > 0.93
    assert np.median(error) < 0.15


@pytest.mark.whole
@pytest.mark.parametrize("method", METHODS, ids=["kornia-zncc", "kornia-report", "report"])
def test_raw_pair_is_rectified_first(method):
    scene = Scene((240, 320), 8.0, 20.0)
    views = Views(scene.left(), scene.right(roll_and_tilt(scene.shape)))
    error = np.abs(method.estimate(views).disparity_px - scene.disparity_px())
    assert np.mean(error[scene.visible()] <= 2) > 0.9


@pytest.mark.parametrize(("method", "missing"), [(METHODS[0], "torch"), (METHODS[1], "torch"), (METHODS[1], "kornia")])
def test_error_without_the_extra_gives_the_cure(method, missing, monkeypatch):
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(TangibleError, match=rf"{missing}.*pip install torch kornia"):
        method.estimate(Views(np.zeros((20, 20)), np.zeros((20, 20))))


def test_responses_scores_and_matrices_are_those_of_the_formulas():
    grey = np.random.default_rng(0).random((40, 50)).astype(np.float32)
    inner = (slice(5, -5), slice(5, -5))
    assert kornia_response(grey)[inner] == pytest.approx(harris_response(grey)[inner], abs=1e-5)
    matches = seen_points(noise_px=0.3)
    ours, theirs = eight_point(matches), kornia_eight_point(matches)
    assert theirs * np.sign((ours * theirs).sum()) == pytest.approx(ours, abs=1e-6)
    weights = np.random.default_rng(0).uniform(0.1, 1, len(matches[0]))
    ours, theirs = eight_point(matches, weights), kornia_eight_point(matches, weights)
    cosine = abs((ours * theirs).sum())
    assert cosine == pytest.approx(1, abs=1e-6)
    left, right = random_pair(1, 1, 9, 12)
    volume = scores(left, right, -2, 4, 3)
    assert volume.shape == (1, 7, 9, 12)
    padded = [np.pad(picture[0, 0].numpy(), 1, mode="edge") for picture in (left, right)]
    for y, x, d in ((4, 6, 0), (0, 5, 3), (8, 11, -0), (3, 4, 4), (2, 9, -2)):
        windows = [part[y : y + 3, c : c + 3].ravel() for part, c in zip(padded, (x, x - d), strict=True)]
        assert volume[0, d + 2, y, x].item() == pytest.approx(np.corrcoef(*windows)[0, 1], abs=1e-9)
    left, right = random_pair(1, 1, 6, 8)
    volume = scores(left, right, -1, 3, 3)
    assert (volume[0, 4, :, :3] == OUTSIDE).all()
    assert (volume[0, 0, :, 7:] == OUTSIDE).all()
    flat = torch.full((1, 1, 6, 8), 0.7)
    assert (scores(flat, flat, 0, 3, 3) == OUTSIDE).all()


def random_pair(*shape, seed=0, dtype=torch.float64):
    return torch.rand(2, *shape, generator=torch.Generator().manual_seed(seed), dtype=dtype)


def test_left_right_check_is_exact_in_the_given_range():
    volume = torch.full((1, 2, 1, 2), OUTSIDE)
    volume[0, 0, 0, 0], volume[0, 1, 0, 1], volume[0, 0, 0, 1] = 0.5, 0.9, 0.1
    found = best_shifts(volume, 0)
    assert torch.isnan(found.disparity_px[0, 0, 0])
    assert found.disparity_px[0, 0, 1] == 1
    assert found.score[0, 0].tolist() == pytest.approx([0, 0.9])
    scene = Scene()
    left, right = (np.rint(50000 * grey).astype(np.uint16) for grey in (scene.left(), 0.6 * scene.right() + 0.1))
    error = np.abs(Report().estimate(Views(left, right)).disparity_px - scene.disparity_px())
    assert np.mean(error[scene.visible()] <= 2) > 0.9
    assert np.nanmax(Report(max_disparity_px=10).estimate(Views(left, right)).disparity_px) <= 10.5

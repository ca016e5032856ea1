"""The methods that others replace, on scenes that are known: else comparisons with them say nothing."""

import sys

import numpy as np
import pytest
import torch

from tangible_core.data import Views
from tangible_core.errors import TangibleError
from tangible_depth.kornia_report import KorniaReport, kornia_eight_point, kornia_response
from tangible_depth.kornia_zncc import KorniaZNCC
from tangible_depth.rectify.fundamental import eight_point
from tangible_depth.report import Report
from tangible_depth.sparse.harris import harris_response
from tangible_depth.windows.torch_zncc import OUTSIDE, best_shifts, scores
from two_cameras import Scene, roll_and_tilt, seen_points

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


def test_harris_responses_agree_within_the_border():
    grey = np.random.default_rng(0).random((40, 50)).astype(np.float32)
    inner = (slice(5, -5), slice(5, -5))
    assert kornia_response(grey)[inner] == pytest.approx(harris_response(grey)[inner], abs=1e-5)


def test_fundamental_matrices_agree():
    matches = seen_points(noise_px=0.3)
    ours, theirs = eight_point(matches), kornia_eight_point(matches)
    assert theirs * np.sign((ours * theirs).sum()) == pytest.approx(ours, abs=1e-6)
    weights = np.random.default_rng(0).uniform(0.1, 1, len(matches[0]))
    ours, theirs = eight_point(matches, weights), kornia_eight_point(matches, weights)
    cosine = abs((ours * theirs).sum())
    assert cosine == pytest.approx(1, abs=1e-6)


@pytest.mark.parametrize(("method", "missing"), [(METHODS[0], "torch"), (METHODS[1], "torch"), (METHODS[1], "kornia")])
def test_error_without_the_extra_gives_the_cure(method, missing, monkeypatch):
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(TangibleError, match=rf"{missing}.*pip install torch kornia"):
        method.estimate(Views(np.zeros((20, 20)), np.zeros((20, 20))))


def test_given_range_is_kept_and_exposure_hardly_counts():
    scene = Scene()
    left, right = (np.rint(50000 * grey).astype(np.uint16) for grey in (scene.left(), 0.6 * scene.right() + 0.1))
    error = np.abs(Report().estimate(Views(left, right)).disparity_px - scene.disparity_px())
    assert np.mean(error[scene.visible()] <= 2) > 0.9
    assert np.nanmax(Report(max_disparity_px=10).estimate(Views(left, right)).disparity_px) <= 10.5


def random_pair(*shape, seed=0, dtype=torch.float64):
    return torch.rand(2, *shape, generator=torch.Generator().manual_seed(seed), dtype=dtype)


def test_scores_are_correlations_of_windows():
    left, right = random_pair(1, 1, 9, 12)
    volume = scores(left, right, -2, 4, 3)
    assert volume.shape == (1, 7, 9, 12)
    padded = [np.pad(picture[0, 0].numpy(), 1, mode="edge") for picture in (left, right)]
    for y, x, d in ((4, 6, 0), (0, 5, 3), (8, 11, -0), (3, 4, 4), (2, 9, -2)):
        windows = [part[y : y + 3, c : c + 3].ravel() for part, c in zip(padded, (x, x - d), strict=True)]
        assert volume[0, d + 2, y, x].item() == pytest.approx(np.corrcoef(*windows)[0, 1], abs=1e-9)


def test_flat_or_outside_windows_have_no_score():
    left, right = random_pair(1, 1, 6, 8)
    volume = scores(left, right, -1, 3, 3)
    assert (volume[0, 4, :, :3] == OUTSIDE).all()
    assert (volume[0, 0, :, 7:] == OUTSIDE).all()
    flat = torch.full((1, 1, 6, 8), 0.7)
    assert (scores(flat, flat, 0, 3, 3) == OUTSIDE).all()


def test_left_right_check_is_exact():
    # Left pixel 1 matches right pixel 0 at 0.9, left pixel 0 the same at 0.5: only the better one stays.
    volume = torch.full((1, 2, 1, 2), OUTSIDE)
    volume[0, 0, 0, 0], volume[0, 1, 0, 1], volume[0, 0, 0, 1] = 0.5, 0.9, 0.1
    found = best_shifts(volume, 0)
    assert torch.isnan(found.disparity_px[0, 0, 0])
    assert found.disparity_px[0, 0, 1] == 1
    assert found.score[0, 0].tolist() == pytest.approx([0, 0.9])

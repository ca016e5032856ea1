import sys

import numpy as np
import pytest

from tangible_core.data import Views
from tangible_core.errors import BrokenMethod, TangibleError
from tangible_core.runtime.torch_extra import need, pick_device
from tangible_depth.kornia_report import KorniaReport, kornia_eight_point, kornia_response
from tangible_depth.kornia_zncc import KorniaZNCC
from tangible_depth.rectify.fundamental import DegenerateMatches, eight_point, robust_fundamental
from tangible_depth.report import Report
from tangible_depth.sparse.harris import harris_response
from two_cameras import Scene, roll_and_tilt, seen_points, some_wrong

METHODS = [KorniaZNCC(), KorniaReport()]


@pytest.mark.parametrize("method", METHODS, ids=["zncc", "report"])
def test_known_scene_gives_its_disparity(method):
    scene = Scene()
    found = method.estimate(Views(scene.left(), scene.right()))
    error = np.abs(found.disparity_px - scene.disparity_px())
    assert np.mean(error[scene.visible()] <= 2) > 0.93
    assert np.median(error) < 0.15


@pytest.mark.parametrize("method", METHODS, ids=["zncc", "report"])
def test_raw_pair_is_rectified_first(method):
    scene = Scene((240, 320), 8.0, 20.0)
    views = Views(scene.left(), scene.right(roll_and_tilt(scene.shape)))
    error = np.abs(method.estimate(views).disparity_px - scene.disparity_px())
    assert np.mean(error[scene.visible()] <= 2) > 0.9


def test_rectify_never_skips_rectification():
    scene = Scene((240, 320), 8.0, 20.0)
    views = Views(scene.left(), scene.right(roll_and_tilt(scene.shape)))
    error = np.abs(KorniaZNCC(rectify="never").estimate(views).disparity_px - scene.disparity_px())
    assert np.mean(error[scene.visible()] <= 2) < 0.8


def test_kornia_report_agrees_with_report():
    scene = Scene()
    views = Views(scene.left(), scene.right())
    difference = KorniaReport().estimate(views).disparity_px - Report().estimate(views).disparity_px
    assert np.median(np.abs(difference)) < 0.05
    assert np.mean(np.abs(difference) <= 1) > 0.95


def test_harris_responses_agree_within_the_border():
    grey = np.random.default_rng(0).random((40, 50)).astype(np.float32)
    inner = (slice(5, -5), slice(5, -5))
    assert kornia_response(grey)[inner] == pytest.approx(harris_response(grey)[inner], abs=1e-5)


def test_fundamental_matrices_agree():
    matches = seen_points(noise_px=0.3)
    ours, theirs = eight_point(*matches), kornia_eight_point(*matches)
    assert theirs * np.sign((ours * theirs).sum()) == pytest.approx(ours, abs=1e-6)
    weights = np.random.default_rng(0).uniform(0.1, 1, len(matches[0]))
    ours, theirs = eight_point(*matches, weights), kornia_eight_point(*matches, weights)
    cosine = abs((ours * theirs).sum())
    assert cosine == pytest.approx(1, abs=1e-6)


def test_robust_estimate_accepts_kornias_fit():
    matches = some_wrong(*seen_points(noise_px=0.3), 0.3)
    ours, theirs = robust_fundamental(*matches), robust_fundamental(*matches, fit=kornia_eight_point)
    assert np.mean(ours.inliers == theirs.inliers) > 0.95
    with pytest.raises(DegenerateMatches):
        kornia_eight_point(*seen_points(count=5))


@pytest.mark.parametrize(("method", "missing"), [(METHODS[0], "torch"), (METHODS[1], "torch"), (METHODS[1], "kornia")])
def test_error_without_the_extra_gives_the_cure(method, missing, monkeypatch):
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(TangibleError, match=rf"{missing}.*pip install torch kornia"):
        method.estimate(Views(np.zeros((20, 20)), np.zeros((20, 20))))


def test_module_outside_the_extra_is_named():
    with pytest.raises(BrokenMethod, match="needs torch"):
        need("torch.no_such_part")


def test_missing_gpu_is_refused(monkeypatch):
    import torch

    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    assert pick_device("auto").type == pick_device("cpu").type == "cpu"
    with pytest.raises(BrokenMethod, match="'auto' or 'cpu'"):
        pick_device("cuda")

"""Measures of benchmarks, against an independent implementation and by hand."""

import numpy as np
import pytest

from tangible_bench.metrics.standard_sets import benchmark_errors
from tangible_core.metrics import disparity_errors

NAN = np.nan


@pytest.fixture(scope="module")
def maps() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Make an estimate, its truth with a fifth unknown, and a foreground."""
    random = np.random.default_rng(17)
    truth = random.uniform(2, 120, (60, 80)).astype(np.float32)
    found = (truth + random.normal(0, 4, truth.shape)).astype(np.float32)
    truth[random.random(truth.shape) < 0.2] = NAN
    return found, truth, random.random(truth.shape) < 0.3


@pytest.mark.parametrize("bound", [0.5, 1.0, 2.0, 4.0])
def test_bad_pixels_and_d1_equal_those_of_kornia(maps, bound: float):
    import torch
    from kornia import metrics

    found, truth, foreground = maps
    mine = disparity_errors(found, truth) | benchmark_errors(found, truth, foreground)
    known = np.isfinite(truth)
    maps_of = [torch.from_numpy(np.nan_to_num(each)) for each in (found, truth)]
    for name, part in (("d1", known), ("d1_bg", known & ~foreground), ("d1_fg", known & foreground)):
        theirs = metrics.kitti_d1_error(*maps_of, valid_mask=torch.from_numpy(part))
        assert mine[name] == pytest.approx(100 * float(theirs), abs=1e-4)
    mask = torch.from_numpy(known)
    for name, share in ((f"bad{bound:g}", bound), ("bad3", 3.0)):
        theirs = metrics.mean_bad_pixel_error(*maps_of, threshold=share, valid_mask=mask)
        assert mine[name] == pytest.approx(100 * float(theirs), abs=1e-4)
    average = metrics.mean_absolute_disparity_error(*maps_of, valid_mask=mask)
    rms = metrics.root_mean_squared_disparity_error(*maps_of, valid_mask=mask)
    assert (mine["average_px"], mine["rms_px"]) == pytest.approx((float(average), float(rms)), rel=1e-5)
    assert 5 < mine["d1_bg"] < 95 and mine["d1_bg"] != mine["d1_fg"] != mine["d1"]


def test_quantiles_and_counts_are_over_known_pixels(maps):
    found, truth, foreground = maps
    found = found.copy()
    found[:30] = NAN
    mine = benchmark_errors(found, truth, foreground)
    error = np.abs(found.astype(float) - truth)
    for share in (50, 90, 95, 99):
        assert mine[f"a{share}_px"] == pytest.approx(np.nanpercentile(error, share))
    known = np.isfinite(truth)
    assert mine["invalid"] == pytest.approx(100 * np.isnan(found[known]).mean())
    assert mine["invalid"] == pytest.approx(100 - disparity_errors(found, truth)["density"])
    assert (mine["pixels"], mine["pixels_fg"]) == (known.sum(), (known & foreground).sum())
    assert mine["pixels_bg"] + mine["pixels_fg"] == mine["pixels"]


@pytest.mark.parametrize(
    ("found", "truth", "d1", "bad3"),
    [
        (13.0, 10.0, 0, 0),  # exactly at the bound
        (13.1, 10.0, 100, 100),
        (104.9, 100.0, 0, 100),  # over 3 px, within 5 %
        (105.1, 100.0, 100, 100),
        (NAN, 10.0, 100, 100),
        (np.inf, 10.0, 100, 100),
        (10.0, NAN, NAN, NAN),
    ],
)
def test_outlier_is_off_by_more_than_3_px_and_5_percent(found, truth, d1, bad3):
    mine = benchmark_errors(np.float32([[found]]), np.float32([[truth]]))
    assert (mine["d1"], mine["bad3"]) == pytest.approx((d1, bad3), nan_ok=True)
    assert np.isnan(mine["d1_fg"]) and np.isnan(mine["d1_bg"]) and mine["pixels_fg"] == 0

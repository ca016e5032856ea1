"""OpenCV's matcher on walls, steps and what it refuses."""

import numpy as np
import pytest

from tangible_core import TangibleError, Views
from tangible_core.errors import OptionError
from tangible_core.plugins.interfaces import Skippable
from tangible_core.scene.geometry import fill_rows
from tangible_core.testing.synthetic.scenes import wall
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


# OpenCV's matcher: what it finds


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


@pytest.mark.parametrize("disparity_px", [-20, -6, 6])
def test_disparities_of_either_sign_in_a_signed_range_are_matched(disparity_px):
    found = estimate(wall_views(disparity_px), min_disparity_px=-32, max_disparity_px=32)
    seen = slice(max(disparity_px, 0), min(disparity_px, 0) or None)
    error = np.abs(found.disparity_px - disparity_px)[:, seen]
    assert np.nanmax(error) < 1
    assert np.nanmax(error[5:-5, 5:-5]) <= 1 / 16
    assert (found.confidence[:, seen] > 0.9).mean() > 0.98


@EVERY_MODE
@pytest.mark.parametrize("disparity_px", [6.25, 6.5, 6.75])
def test_fractions_of_a_pixel_are_matched(mode, disparity_px):
    found = estimate(wall(disparity_px), mode=mode).disparity_px[:, 8:-8]
    assert np.isfinite(found).mean() > 0.99
    assert np.nanmedian(np.abs(found - disparity_px)) < 0.13
    assert np.nanmean(np.abs(found - disparity_px) < 0.5) > 0.99


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


def test_first_columns_get_a_disparity_too():
    found = estimate(wall_views(3)).disparity_px
    assert np.isfinite(found[:, 3:16]).mean() > 0.98


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


# OpenCV's matcher: any picture


@pytest.mark.parametrize(
    "as_type",
    [
        lambda grey: grey.astype(np.uint16) * 257,
        lambda grey: grey / 255,
        lambda grey: (grey / 255).astype(np.float32),
        lambda grey: np.dstack([grey] * 3),
        lambda grey: np.dstack([grey] * 3 + [np.full_like(grey, 255)]),
        lambda grey: grey[::-1, ::-1][::-1, ::-1],
    ],
    ids=["uint16", "float64", "float32", "rgb", "rgba", "strided"],
)
def test_every_dtype_gives_the_same_disparity(as_type):
    views = step()[0]
    plain, other = estimate(views), estimate(Views(as_type(views.left), as_type(views.right)))
    assert plain.digest() == other.digest()


def test_boolean_picture_is_matched():
    views = wall_views(4)
    found = estimate(Views(views.left > 127, views.right > 127)).disparity_px[:, 4:]
    assert np.nanmedian(found) == 4


def test_twelve_bits_in_sixteen_keep_their_detail():
    views = wall(6.0)
    dim = Views(views.left.astype(np.uint16) * 16, views.right.astype(np.uint16) * 16)
    found = estimate(dim).disparity_px[:, 8:]
    assert np.isfinite(found).mean() > 0.99
    assert np.nanmedian(np.abs(found - 6)) < 0.1


def test_inputs_stay_unchanged_and_results_are_deterministic():
    views = step()[0]
    before = views.digest()
    assert estimate(views).digest() == estimate(views).digest()
    assert views.digest() == before


# OpenCV's matcher: where there is nothing to find


@EVERY_MODE
@pytest.mark.parametrize("value", [0, 128, 255])
def test_constant_pair_is_unknown(mode, value):
    flat = np.full((32, 64), value, np.uint8)
    found = estimate(Views(flat, flat), mode=mode)
    assert np.isnan(found.disparity_px).all()
    assert not found.confidence.any()
    assert np.isnan(estimate(Views(flat, flat), fill=True).disparity_px).all()


def test_stripes_along_the_rows_are_unknown():
    stripes = np.repeat(texture((40, 1)), 80, axis=1)
    assert np.isnan(estimate(Views(stripes, stripes)).disparity_px).all()


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
@pytest.mark.parametrize("shape", [(1, 1), (1, 40), (40, 1), (2, 2), (3, 3), (7, 20)])
@pytest.mark.parametrize("span", [(0, 64), (-48, 16), (-64, -16), (16, 48)])
@pytest.mark.parametrize("block_px", [1, 5, 11])
def test_smallest_pictures_are_matched(mode, shape, span, block_px):
    views = Views(texture(shape), texture(shape, seed=1))
    low, high = span
    found = estimate(views, mode=mode, min_disparity_px=low, max_disparity_px=high, block_px=block_px)
    known = found.disparity_px[np.isfinite(found.disparity_px)]
    assert found.disparity_px.shape == shape
    assert ((known >= low - 0.5) & (known < high - 0.5)).all()


def test_range_wider_than_the_picture_is_clipped():
    views = wall_views(4, (48, 64))
    wide = estimate(views, min_disparity_px=-2016, max_disparity_px=2016).disparity_px
    assert np.nanmedian(wide) == 4


def test_range_outside_the_picture_gives_unknown():
    found = estimate(wall_views(4, (20, 64)), min_disparity_px=64, max_disparity_px=128)
    assert np.isnan(found.disparity_px).all()
    assert not found.confidence.any()


def test_single_view_is_refused_with_an_alternative():
    with pytest.raises(TangibleError, match=r"needs two views.*luminance"):
        estimate(Views(texture((8, 8))))


def test_error_of_opencv_becomes_one_error_with_a_cure(monkeypatch):
    import cv2

    class Refusing:
        def compute(self, *views):
            raise cv2.error("Insufficient memory")

    monkeypatch.setattr(cv2.StereoSGBM, "create", lambda **options: Refusing())
    with pytest.raises(TangibleError, match=r"96 x 48 over 64 disparities in mode 'hh'.*Insufficient.*try mode"):
        estimate(wall_views(4), mode="hh")


@pytest.mark.parametrize(
    "options",
    [
        {"min_disparity_px": 64},
        {"max_disparity_px": 0},
        {"block_px": 4},
        {"block_px": 13},
        {"block_px": 0},
        {"max_disparity_px": 5000},
        {"mode": "fast"},
        {"uniqueness_percent": 100},
        {"speckle_size": -1},
        {"window_px": 3},
    ],
)
def test_contradicting_options_are_refused(options):
    with pytest.raises(OptionError):
        OpenCVSGBM(**options)


def test_identical_views_skip_the_matching():
    views = wall_views(4)
    method = OpenCVSGBM()
    assert isinstance(method, Skippable)
    assert method.skip(views) is None
    assert method.skip(Views(views.left)) is None
    assert "identical" in method.skip(Views(views.left, views.left.copy()))

"""Rectification of raw pairs, exactly known: else their rows do not correspond, and depth is noise."""

import math
from contextlib import nullcontext

import numpy as np
import pytest

from tangible_core.data import Calibration, DisparityMap, Views
from tangible_core.plugins.notes import collected
from tangible_depth.rectify import rectification, rectifying_rotation
from tangible_depth.rectify.projective import distort, transform, unchanged_pair, undistort, warp_pair
from tangible_depth.rectify.rectification import (
    RectificationError,
    check_homographies,
    rectify,
    unique_matches,
    verified_range,
)
from tangible_depth.rectify.rectifying_rotation import aligning_homographies, threshold_px
from tangible_depth.sparse.matches import Matches
from two_cameras import HEIGHT, WIDTH, Scene, roll_and_tilt, seen_points, some_wrong

BLANK = np.zeros((HEIGHT, WIDTH), np.uint8)


def offset_matches(before_px, after_px, monkeypatch):
    """Matches with a row offset before rectification, and patched homographies that leave another one."""
    left, right = seen_points(turn=(0, 0, 0), move_m=(-0.3, 0, 0))
    pair = np.eye(3), np.array([[1, 0, 0], [0, 1, after_px - before_px], [0, 0, 1.0]])
    monkeypatch.setattr(rectifying_rotation, "aligning_homographies", lambda matches, shape, roll: pair)
    return Matches(left, right + np.array([0, before_px]))


def rectified_points(noise_px=0.3, **cameras):
    """Rectify exact points by a pair with noisy ones."""
    rectified = rectify(Views(BLANK, BLANK), matches=seen_points(noise_px=noise_px, **cameras))
    left, right = seen_points(**cameras)
    shift = transform(rectified.left_homography, left) - transform(rectified.right_homography, right)
    return rectified, shift


@pytest.mark.parametrize(
    ("turn", "move"),
    [
        ((0.02, -0.05, 0.01), (-0.3, 0.02, 0.05)),
        ((0, 0, 0.35), (-0.3, -0.2, 0)),
        ((0, 0.175, 0), (-0.9, 0, 0.1)),
        ((0, 0.44, 0), (-2.2, 0, 0.5)),
        ((0, 0, 0), (0, -0.3, 0)),
        ((0, 0, 0), (0, 0.3, 0)),
        ((0, 0, 1.57), (-0.3, 0, 0)),
    ],
    ids=["slight", "rolled", "toed in", "toed in more", "one below", "one above", "on its side"],
)
def test_rectified_rows_correspond_for_any_cameras(turn, move):
    rectified, shift = rectified_points(turn=turn, move_m=move)
    assert not rectified.skipped
    assert np.median(np.abs(shift[:, 1])) <= 0.15
    assert shift[:, 0].min() > -1  # the search may start at zero


def test_least_squares_fit_is_as_good_as_scipys(monkeypatch):
    from scipy.optimize import least_squares

    costs = []

    def both(cost, start, scale):
        found = fit(cost, start, scale)
        theirs = least_squares(cost, start, x_scale=0.1 * scale, xtol=1e-12, ftol=1e-12, gtol=1e-12)
        costs.append((np.square(cost(found)).sum(), np.square(theirs.fun).sum()))
        return found

    fit = rectifying_rotation.least_squares
    monkeypatch.setattr(rectifying_rotation, "least_squares", both)
    for turn in ((0.02, -0.05, 0.01), (0, 0.175, 0), (0, 0, 0.35)):
        matches = some_wrong(*seen_points(noise_px=0.3, turn=turn, move_m=(-0.3, 0.02, 0.05)), 0.1)
        aligning_homographies(matches, (HEIGHT, WIDTH))
    assert len(costs) == 6
    assert max(ours / theirs for ours, theirs in costs) <= 1 + 1e-6


@pytest.mark.parametrize("move", [(0, 0, -0.5), (-0.1, 0, -0.5)])
def test_camera_moved_forwards_is_refused(move):
    with pytest.raises(RectificationError, match=r"forwards|baseline|area|order"):
        rectified_points(turn=(0, 0, 0), move_m=move)


def test_flat_scene_is_aligned_with_a_warning(caplog):
    rectified, shift = rectified_points(flat=True)
    assert np.median(np.abs(shift[:, 1])) <= 0.15
    assert np.array_equal(rectified.left_homography, np.eye(3))
    assert caplog.text.count("one plane explains the matches") == 1


@pytest.mark.parametrize("turn", [(0.02, -0.05, 0.01), (0, 0, 0.1), (0, 0.3, 0)], ids=["slight", "rolled", "far"])
@pytest.mark.parametrize("noise_px", [0.0, 0.3])
def test_rotated_camera_is_refused(turn, noise_px):
    with pytest.raises(RectificationError, match="the camera only turned"):
        rectified_points(noise_px, turn=turn, move_m=(0, 0, 0))


class TestDominantPlane:
    """Pictures of a wall, exactly known."""

    SHAPE = (300, 400)

    @pytest.mark.parametrize("seed", [1, 3])
    def test_wall_keeps_its_slant(self, seed):
        scene = Scene(self.SHAPE, 10.0, 0.0, seed, slope=(0.03, -0.02), box=(0, 0))
        warp = roll_and_tilt(self.SHAPE)
        with collected() as notes:
            rectified = rectify(Views(scene.left(), scene.right(warp)))
        left, right = scene.matches(np.eye(3), warp)
        shift = rectified.left_place_px(left) - rectified.right_place_px(right)
        assert np.percentile(np.abs(shift[:, 1]), 95) <= 0.05
        assert np.abs(shift[:, 0] + rectified.offset_px - scene.disparity_px().ravel()).max() <= 0.1
        assert [note.startswith("one plane explains the matches") for note in notes] == [True, False]

    @pytest.mark.parametrize(("box", "seed"), [((0.0375, 0.05), 1), ((0.0125, 0.3), 3)], ids=["small", "thin"])
    def test_small_object_before_a_wall_resolves_the_poses(self, box, seed):
        """The object covers 1 to 2 % of the pixels; by the wall alone its rows would be 1.2 px apart."""
        scene = Scene(self.SHAPE, 10.0, 34.0, seed, slope=(0.01, -0.01), box=box)
        warps = roll_and_tilt(self.SHAPE, 3.0, (0, 0)), roll_and_tilt(self.SHAPE, -2.0)
        rectified = rectify(Views(scene.left(warps[0]), scene.right(warps[1])))
        left, right = scene.matches(*warps)
        off = np.abs(rectified.left_place_px(left) - rectified.right_place_px(right))[:, 1]
        thing = scene.in_box().ravel()
        assert thing.mean() < 0.02
        assert np.median(off[thing]) <= 0.12
        assert np.median(off[~thing]) <= 0.05


@pytest.mark.parametrize("degrees", [0.0, 1.0])
def test_left_picture_without_need_stays_unchanged(degrees):
    left, right = seen_points(turn=(0, 0, 0), move_m=(-0.3, 0, 0), noise_px=0.1)
    rolls = (roll_and_tilt((HEIGHT, WIDTH), each, (0, 0)) for each in (degrees, 2.0))
    turned = Matches(*(transform(roll, points) for roll, points in zip(rolls, (left, right), strict=True)))
    homography = rectify(Views(BLANK, BLANK), matches=turned).left_homography
    assert np.array_equal(homography, np.eye(3)) == (degrees == 0)
    assert math.degrees(math.atan2(homography[1, 0], homography[0, 0])) == pytest.approx(-degrees, abs=0.3)


class TestSkippedPair:
    @pytest.mark.parametrize(
        ("views", "why"),
        [
            (Views(Scene().left(), Scene().right()), "already rectified"),
            (Views(Scene().left(), 0.2 + 0.5 * Scene().right() ** 1.4), "already rectified"),
            (Views(BLANK, BLANK, Calibration(900.0, 0.1)), "calibration"),
            (Views(BLANK, BLANK), "too few"),
        ],
    )
    def test_pair_that_needs_nothing_or_tells_nothing_is_skipped(self, views: Views, why: str):
        rectified = rectify(views)
        assert rectified.skipped
        assert why in rectified.why

    @pytest.mark.parametrize(("after_px", "turned"), [(0.29, True), (0.31, False), (0.6, False)])
    def test_rectification_needs_a_gain_of_a_fifth_of_a_pixel(self, after_px, turned, monkeypatch):
        rectified = rectify(Views(BLANK, BLANK), matches=offset_matches(0.5, after_px, monkeypatch))
        assert rectified.skipped != turned
        assert f"offset 0.50 px, {'now' if turned else 'then'} {after_px:.2f}" in rectified.why

    @pytest.mark.parametrize(("offset_px", "size", "turned"), [(0.34, 1, False), (0.36, 1, True), (0.36, 4, False)])
    def test_third_of_a_pixel_is_tolerated_and_more_in_large_pictures(self, offset_px, size, turned, monkeypatch):
        views = Views(*[np.zeros((size * HEIGHT, size * WIDTH), np.uint8)] * 2)
        rectified = rectify(views, matches=offset_matches(offset_px, 0.0, monkeypatch))
        assert rectified.skipped != turned

    @pytest.mark.parametrize(
        ("share", "away_px", "said"), [(0.04, -2.1, True), (0.06, -2.1, False), (0.04, -1.9, False)]
    )
    def test_views_with_disparities_below_minus_two_are_exchanged(self, share, away_px, said, caplog):
        left = np.random.default_rng(0).uniform(0, 700, (1000, 2))
        disparity = np.where(np.arange(1000) < 1000 * share, 3.0, away_px)
        rectify(Views(BLANK, BLANK), matches=Matches(left, left - np.column_stack([disparity, 0 * disparity])))
        assert ("as of exchanged views" in caplog.text) == said

    @pytest.mark.parametrize(("count", "told"), [(19, False), (20, True)])
    def test_twenty_matches_decide(self, count, told, monkeypatch):
        matches = offset_matches(0.5, 0.0, monkeypatch)
        rectified = rectify(Views(BLANK, BLANK), matches=Matches(matches.left_px[:count], matches.right_px[:count]))
        assert rectified.skipped
        assert ("only 19 matches, too few to decide" in rectified.why) != told
        assert ("only 20 of 20 matches agree, 30 are needed" in rectified.why) == told


def warped_scene():
    scene = Scene((240, 320), 8.0, 20.0)
    warp = roll_and_tilt(scene.shape)
    return scene, warp, Views(scene.left(), scene.right(warp))


def true_map(scene, rectified):
    """The map of a perfect method in the rectified views."""
    rows, columns = rectified.views.shape
    y, x = np.indices((rows, columns), np.float64)
    original = transform(np.linalg.inv(rectified.left_homography), np.column_stack([x.ravel(), y.ravel()]))
    column, row = np.rint(original).astype(int).T
    inside = (column >= 0) & (column < scene.shape[1]) & (row >= 0) & (row < scene.shape[0])
    disparity = np.full(rows * columns, np.nan)
    disparity[inside] = scene.disparity_px()[row[inside], column[inside]]
    return original, disparity.reshape(rows, columns).astype(np.float32)


def test_rolled_and_tilted_picture_is_rectified_and_its_map_hits_the_original_pixels():
    scene, warp, views = warped_scene()
    rectified = rectify(views)
    assert not rectified.skipped
    y, x = np.indices(scene.shape, np.float64)
    left = np.column_stack([x.ravel(), y.ravel()])
    right = transform(warp, left - np.column_stack([scene.disparity_px().ravel(), np.zeros(left.shape[0])]))
    shift = transform(rectified.left_homography, left) - transform(rectified.right_homography, right)
    assert np.median(np.abs(shift[:, 1])) <= 0.15
    # A warp about the middle leaves disparities as they were.
    assert np.median(np.abs(shift[:, 0] + rectified.offset_px - scene.disparity_px().ravel())) < 0.3
    _, perfect = true_map(scene, rectified)
    found = rectified.to_original(DisparityMap(perfect - np.float32(rectified.offset_px)))
    known = np.isfinite(found.disparity_px)
    assert found.disparity_px.shape == scene.shape
    assert known.mean() > 0.95
    assert np.mean(found.disparity_px[known] == scene.disparity_px()[known]) > 0.97
    assert np.array_equal(found.confidence > 0, known)
    expected = transform(warp, np.column_stack([(x - scene.disparity_px()).ravel(), y.ravel()])).reshape(
        *scene.shape, 2
    )
    error = np.linalg.norm(rectified.right_px(found.disparity_px) - expected, axis=2)
    assert np.nanmedian(error) < 0.3


@pytest.mark.parametrize("dtype", [np.bool_, np.uint16, np.float16, np.float64])
def test_pictures_of_any_kind_are_rectified(dtype):
    views = warped_scene()[2]
    white = np.iinfo(dtype).max if np.issubdtype(dtype, np.integer) else 1
    colour = (np.stack([grey * white] * 4, axis=2).astype(dtype) for grey in (views.left, views.right))
    found = rectify(Views(*colour), matches=seen_points(count=200, width=320, noise_px=0.1)).views.left
    assert found.shape[2] == 4
    assert found.dtype == (np.float32 if dtype in (np.bool_, np.float16) else dtype)


@pytest.mark.parametrize(
    ("homography", "words"),
    [
        (np.diag([2.0, 2.0, 1.0]), "times its area"),
        (np.diag([1.8, 1.8, 1.0]), "times its area"),
        (np.diag([0.55, 0.55, 1.0]), "times its area"),
        (np.diag([0.5, 0.5, 1.0]), "times its area"),
        (np.diag([-1.0, 1.0, 1.0]), "order"),
        (np.array([[1, 0, 0], [0, 1, 0], [-0.01, 0, 1.0]]), "infinity"),
    ],
)
def test_distorting_homographies_are_refused(homography, words):
    for side, pair in (("right", (np.eye(3), homography)), ("left", (homography, np.eye(3)))):
        with pytest.raises(RectificationError, match=f"the {side} picture.*{words}"):
            check_homographies(pair, (100, 200), np.zeros(5))


def test_rectification_with_an_area_within_a_third_and_one_match_in_twenty_off_its_row_holds():
    for side in (1.7, 0.6):
        check_homographies((np.diag([side, side, 1.0]), np.eye(3)), (100, 200), np.zeros(5))
    for share, offset_px, refused in ((0.04, 9.0, False), (0.06, 3.1, True), (0.06, 2.9, False)):
        offsets = np.where(np.arange(1000) < 1000 * share, offset_px, 0.0)
        with pytest.raises(RectificationError) if refused else nullcontext():
            check_homographies((np.eye(3), np.eye(3)), (100, 200), offsets)


@pytest.mark.parametrize(
    ("low", "high", "start"), [(0.0, 20.0, -4), (10.0, 90.0, 0), (-3.0, 17.0, -7), (-20.0, 80.0, -30), (4.5, 9.0, 0)]
)
def test_search_starts_below_all_but_stray_disparities(low, high, start):
    """A tenth of their range below, and 4 px at least, one in a hundred left out at each end; never above 0."""
    disparity = np.linspace(low, high, 981)
    stray = np.concatenate([np.full(10, -500.0), disparity, np.full(10, 900.0)])
    assert rectification._search_start(stray) == start


class TestEvidence:
    def matches(self, asked=slice(None)):
        cameras = {"turn": (0.02, -0.05, 0.03), "move_m": (-0.3, 0.02, 0.05)}
        return seen_points(**cameras, noise_px=0.2, count=120).select(asked)

    @pytest.mark.parametrize(("count", "believed"), [(29, False), (36, True)])
    def test_geometry_of_under_thirty_matches_is_not_trusted(self, count, believed):
        """Two or three of 36 stand off by more than a pixel."""
        assert rectify(Views(BLANK, BLANK), matches=self.matches(slice(count))).skipped != believed

    def test_held_out_matches_that_disagree_are_not_trusted(self):
        left, right = (points.copy() for points in self.matches())
        right[1::2, 1] += np.random.default_rng(0).uniform(20, 200, len(right[1::2]))
        assert "of the held-out matches" in rectify(Views(BLANK, BLANK), matches=Matches(left, right)).why


@pytest.mark.parametrize("radial", [-0.15, 0.1])
def test_lens_distortion_is_estimated(radial):
    shape = HEIGHT, WIDTH
    cameras = {"turn": (0.02, -0.05, 0.03), "move_m": (-0.3, 0.02, 0.05), "count": 400}
    exact, noisy = (
        Matches(*(distort(points, radial, shape) for points in seen_points(**cameras, noise_px=noise)))
        for noise in (0.0, 0.2)
    )
    rectified = rectify(Views(BLANK, BLANK), matches=noisy)
    assert rectified.left_radial == pytest.approx(radial, abs=0.02)
    assert rectified.right_radial == pytest.approx(radial, abs=0.02)
    shift = rectified.left_place_px(exact.left_px) - rectified.right_place_px(exact.right_px)
    assert np.percentile(np.abs(shift[:, 1]), 95) <= 0.3
    assert "radial distortion of the lenses" in rectified.why


@pytest.mark.parametrize("radial", [-0.2, 0.0, 0.1])
def test_distortion_is_removed_and_restored(radial):
    points = np.random.default_rng(0).uniform(0, [WIDTH, HEIGHT], (200, 2))
    straight = undistort(points, radial, (HEIGHT, WIDTH))
    assert distort(straight, radial, (HEIGHT, WIDTH)) == pytest.approx(points)


@pytest.mark.parametrize(("rows", "columns"), [(200, 400), (400, 200)])
def test_distortion_keeps_the_middle_and_a_circle_of_half_the_longer_side_over_root_two(rows, columns):
    """At the radius r, in half the longer side, a point moves to r (1 + k / 2) / (1 + k r^2)."""
    middle = np.array([(columns - 1) / 2, (rows - 1) / 2])
    points = middle + np.array([[0, 0], [100, 100], [0, 50], [-200, 0]])
    moved = undistort(points, -0.2, (rows, columns)) - middle
    expected = [[0, 0], [100, 100], [0, 50 * 0.9 / (1 - 0.2 / 16)], [-200 * 0.9 / 0.8, 0]]
    assert moved == pytest.approx(np.array(expected))


def test_lens_and_parts_of_a_picture_are_exact():
    """Each pixel of the original gets what stands at its place in the turned view, and leads to its match."""
    size = np.indices((60, 80), np.uint8).sum(axis=0).astype(np.uint8)
    bent = warp_pair(Views(size, size), (np.eye(3), np.eye(3)), "", 0, (-0.1, -0.1))
    place = np.indices(bent.views.shape, np.float32)[1]
    back = bent.to_original(DisparityMap(place)).disparity_px
    y, x = np.indices(size.shape)
    expected = bent.left_place_px(np.column_stack([x.ravel(), y.ravel()]))[:, 0].reshape(size.shape)
    assert np.abs(back - expected)[1:-1, 1:-1].max() <= 0.5
    still = bent.right_px(np.zeros(size.shape, np.float32))
    assert still == pytest.approx(np.dstack([x, y]).astype(float), abs=1e-6)
    # A grey that grows along the diagonal is where the lens's inverse puts it.
    rows, columns = bent.to_original(DisparityMap(bent.views.left.astype(np.float32))).disparity_px, size
    assert np.abs(rows - columns)[2:-2, 2:-2].max() <= 2
    x, y = np.meshgrid(np.arange(4) * 200 + 100, np.arange(4) * 50 + 25)
    points = np.column_stack([x.ravel(), y.ravel()]).astype(float)
    assert rectifying_rotation._count_parts(points, (200, 800)) == 16
    assert rectifying_rotation._count_parts(points[:6], (200, 800)) == 6
    assert (
        rectifying_rotation._count_parts(np.array([[0, 0], [799, 0], [800, 0], [0, 200], [799, 199.5]]), (200, 800))
        == 4
    )


@pytest.mark.parametrize(
    ("shape", "expected"), [((600, 800), 1), ((1500, 1000), 1), ((3000, 6000), 4), ((6000, 30), 4)]
)
def test_inliers_lie_within_a_pixel_or_a_share_of_the_longer_side(shape: tuple[int, int], expected: float):
    assert threshold_px(shape) == expected


def test_equal_matches_count_once_and_keep_their_order():
    left = np.array([[5, 1], [2, 2], [5, 1], [2, 2], [0, 9], [5, 1.0]])
    right = np.array([[4, 1], [1, 2], [4, 1], [0, 2], [0, 9], [4, 1.0]])
    found = unique_matches(Matches(left, right))
    assert found.left_px.tolist() == [[5, 1], [2, 2], [2, 2], [0, 9]]
    assert found.right_px.tolist() == [[4, 1], [1, 2], [0, 2], [0, 9]]


@pytest.mark.parametrize(("alike", "high"), [(4, 10), (5, 41)])
def test_range_is_rounded_outwards_and_a_match_needs_four_others_that_are_like_it(alike: int, high: int):
    """Groups of nine close matches: in each of ten, `alike` ones lie at 40 px, and the others at 0, 10, ... px."""
    random = np.random.default_rng(0)
    points = np.concatenate([at + random.uniform(0, 1, (9, 2)) for at in random.uniform(0, 9000, (60, 2))])
    disparity = np.tile(np.full(9, 9.5), (60, 1))
    disparity[:10] = 1000 * np.arange(9)
    disparity[:10, :alike] = 40.5
    assert verified_range(points, disparity.ravel()) == (9, high)
    for sign, found in ((1, (10, 11)), (-1, (-11, -10))):
        assert verified_range(np.random.default_rng(0).uniform(0, 100, (50, 2)), np.full(50, 10.5 * sign)) == found


LEFT, RIGHT = np.random.default_rng(0).integers(0, 256, (2, 20, 31), np.uint8)
STILL = np.eye(3), np.eye(3)


@pytest.mark.parametrize("start_px", [0, -5, 4])
def test_right_view_moves_so_that_the_start_becomes_zero(start_px: int):
    found = warp_pair(Views(LEFT, RIGHT), STILL, "", start_px, verified_px=(-3, 9))
    assert np.array_equal(found.views.left, LEFT)
    columns = np.clip(np.arange(31) - start_px, 0, 30)
    assert np.array_equal(found.views.right, RIGHT[:, columns])
    assert (found.offset_px, found.verified_px) == (start_px, (-3 - start_px, 9 - start_px))


def test_canvas_holds_the_left_picture_and_its_values_and_counts_the_move():
    found = warp_pair(Views(LEFT, RIGHT), STILL, "", -5)
    disparity_px = np.full((20, 31), np.float32(7))
    back = found.to_original(DisparityMap(disparity_px, np.full((20, 31), np.float32(0.5))))
    assert (back.disparity_px == 2).all()
    assert (back.confidence == 0.5).all()
    y, x = np.indices((20, 31), np.float64)
    assert found.right_px(back.disparity_px) == pytest.approx(np.dstack([x - 2, y]))
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    found = warp_pair(Views(LEFT, RIGHT), (turn, turn), "")
    assert np.array_equal(found.views.left, np.rot90(LEFT, -1))
    values = np.indices(found.views.shape, np.float32).sum(axis=0)
    assert np.array_equal(found.to_original(DisparityMap(values)).disparity_px, np.rot90(values))
    step = np.where(np.arange(31) < 15, 0.2, 0.7) * np.ones((20, 1))
    half = np.array([[1, 0, 0.5], [0, 1, 0], [0, 0, 1.0]])
    found = warp_pair(Views(step, step), (STILL[0], half), "")
    assert (found.views.right.min(), found.views.right.max()) == (0.2, 0.7)


def test_other_pictures_are_warped_alike_and_those_of_a_skipped_pair_stay():
    turn = np.array([[1, 0.1, 2], [-0.1, 1, 3], [0, 0, 1.0]])
    found = warp_pair(Views(LEFT, RIGHT), (turn, turn), "", -2)
    again = found.warp(Views(RIGHT, LEFT)).warp(Views(LEFT, RIGHT))
    assert np.array_equal(again.views.left, found.views.left)
    assert np.array_equal(again.views.right, found.views.right)
    other = Views(RIGHT, LEFT)
    assert unchanged_pair(Views(LEFT, RIGHT), "").warp(other).views is other

"""Semi-global matching as a method: exact scenes, ranges, skips, and pairs that are hard to take."""

import logging
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from stereo_scenes import known_pair, slanted, step
from tangible_core.data import Views
from tangible_core.errors import PictureError
from tangible_core.plugins.notes import collected
from tangible_depth.dense import refinement
from tangible_depth.dense.filling import gaps
from tangible_depth.dense.filling.four_directions import fill_from_four_directions
from tangible_depth.dense.speckles import Specks
from tangible_depth.semi_global import SemiGlobal


def share_within(found, truth, px, where=True):
    """Share of the pixels `where` whose disparity is within `px` of the truth; unknown is not."""
    return float(np.mean((np.abs(found - truth) <= px)[np.broadcast_to(where, truth.shape)]))


@pytest.mark.parametrize("offset", [2.5, 6.0, 7.25, 11.6])
def test_frontal_plane_is_matched_to_a_fraction_of_a_pixel(offset):
    views, truth = slanted(offset=offset)
    found = SemiGlobal(max_disparity_px=32).estimate(views)
    assert np.median(np.abs(found.disparity_px - truth)) <= 0.25  # census costs are drawn to whole pixels
    assert share_within(found.disparity_px, truth, 0.5) >= 0.995
    assert found.disparity_px.dtype == found.confidence.dtype == np.float32


@pytest.mark.parametrize(("across", "down"), [(0.05, 0.0), (0.0, 0.08), (-0.04, 0.06)])
def test_slanted_plane_is_matched(across, down):
    views, truth = slanted(across=across, down=down, offset=9.0)
    found = SemiGlobal(max_disparity_px=32).estimate(views).disparity_px
    seen = np.indices(truth.shape)[1] >= truth
    assert share_within(found, truth, 0.5, seen) >= 0.97
    assert share_within(found, truth, 1.0) >= 0.97


def test_occlusion_at_a_step_is_filled_from_behind():
    views, truth, hidden = step()
    found = SemiGlobal(max_disparity_px=32).estimate(views)
    assert share_within(found.disparity_px, truth, 0.5) >= 0.985
    assert share_within(found.disparity_px, truth, 0.5, hidden) >= 0.95
    assert np.isfinite(found.disparity_px).all()
    assert found.confidence[hidden].mean() < 0.2 < 0.6 < found.confidence[~hidden].mean()


def test_occlusion_without_filling_stays_unknown():
    views, truth, hidden = step()
    found = SemiGlobal(max_disparity_px=32, fill=False).estimate(views)
    assert np.isnan(found.disparity_px[hidden]).mean() >= 0.9
    known = np.isfinite(found.disparity_px)
    assert known[~hidden].mean() >= 0.85
    assert share_within(found.disparity_px, truth, 0.5, known) >= 0.99
    assert (found.confidence[~known] == 0).all()


def test_strict_check_keeps_fewer_matches():
    views, _, _ = step()
    kept = [
        np.isfinite(SemiGlobal(max_disparity_px=32, fill=False, check=check).estimate(views).disparity_px).sum()
        for check in ("strict", "soft")
    ]
    assert kept[0] <= kept[1]


@pytest.mark.parametrize("offset", [-9.0, 3.0, 30.0])
def test_range_of_either_sign_is_estimated(offset):
    views, truth = slanted(shape=(120, 240), offset=offset)
    with collected() as notes:
        found = SemiGlobal().estimate(views).disparity_px
    assert share_within(found, truth, 0.5) >= 0.98
    assert any("as none was found up to 192 px; for nearer things write `max_disparity_px`" in each for each in notes)


def test_requested_range_around_zero_is_matched():
    views, truth = slanted(across=0.1, offset=-8.0)
    found = SemiGlobal(min_disparity_px=-12, max_disparity_px=16).estimate(views).disparity_px
    assert share_within(found, truth, 0.5, np.indices(truth.shape)[1] >= truth) >= 0.95


def test_exchanged_views_are_matched_with_a_warning(caplog):
    views, truth, _ = step(shape=(120, 240), box=(30, 90, 80, 180))
    with caplog.at_level(logging.WARNING, "tangible_depth"):
        found = SemiGlobal().estimate(Views(views.right, views.left)).disparity_px
    assert "exchanged" in caplog.text
    assert np.isclose(np.median(found), -np.median(truth), atol=0.5)
    assert (found < 0).all()


def test_views_in_order_give_no_warning(caplog):
    with caplog.at_level(logging.WARNING, "tangible_depth"):
        SemiGlobal().estimate(slanted(shape=(120, 240))[0])
    assert "exchanged" not in caplog.text


def test_requested_range_bounds_the_disparities():
    views, _ = slanted(offset=20.0)
    found = SemiGlobal(max_disparity_px=10, fill=False).estimate(views).disparity_px
    assert not (found[np.isfinite(found)] > 9.5).any()


def test_identical_views_are_not_matched():
    left = slanted()[0].left
    with collected() as notes:
        found = SemiGlobal().estimate(Views(left, left.copy()))
    assert (found.disparity_px == 0).all()
    assert any("identical" in each for each in notes)
    matched = SemiGlobal(skip_identical=False, max_disparity_px=16).estimate(Views(left, left.copy()))
    assert share_within(matched.disparity_px, np.zeros(left.shape), 0.5) >= 0.99


def test_strips_without_texture_are_not_matched():
    views, truth = slanted(shape=(400, 120))
    pair = [np.array(each) for each in (views.left, views.right)]
    for each in pair:
        each[:256] = 90
    with collected() as notes:
        found = SemiGlobal(max_disparity_px=32).estimate(Views(*pair))
    assert any("no texture" in each for each in notes)
    assert (found.confidence[:250] == 0).all()
    assert share_within(found.disparity_px[264:], truth[264:], 0.5) >= 0.98
    with collected() as notes:
        SemiGlobal(max_disparity_px=32, skip_flat=False).estimate(Views(*pair))
    assert not any("no texture" in each for each in notes)


@pytest.mark.parametrize("options", [{}, {"skip_identical": False}, {"skip_identical": False, "skip_flat": False}])
def test_constant_pair_has_no_confidence(options):
    flat = np.full((80, 120), 77, np.uint8)
    for right in (flat, flat + np.uint8(20)):
        found = SemiGlobal(**options).estimate(Views(flat, right))
        assert not (np.isfinite(found.disparity_px) & (found.confidence > 0)).any()


def test_preview_at_half_resolution_has_the_full_size():
    views, truth, _ = step(shape=(151, 223), back=8, front=24, box=(40, 110, 90, 170))
    with collected() as notes:
        found = SemiGlobal(max_disparity_px=48, resolution="half").estimate(views)
    assert found.disparity_px.shape == truth.shape
    assert any("full resolution" in each for each in notes)
    assert share_within(found.disparity_px, truth, 1.0) >= 0.96


def test_speckle_size_scales_with_the_resolution():
    assert Specks(20, 60, 200).downsample(2) == Specks(5, 15, 50)


def test_exposure_hardly_changes_the_map():
    views, truth, _ = step()
    darker = np.rint(0.7 * views.right + 20).astype(np.uint8)
    found = SemiGlobal(max_disparity_px=32).estimate(Views(views.left, darker)).disparity_px
    assert share_within(found, truth, 0.5) >= 0.98


def test_offset_rows_are_realigned():
    views, truth = slanted(shape=(160, 200))
    moved = Views(views.left, np.roll(views.right, 1, axis=0))
    with collected() as notes:
        found = SemiGlobal(max_disparity_px=32).estimate(moved).disparity_px
    assert any("realigned by 1.0" in each or "realigned by 0.9" in each for each in notes)
    assert share_within(found[4:-4], truth[4:-4], 0.5) >= 0.98
    with collected() as notes:
        SemiGlobal(max_disparity_px=32, realign_rows=False, cost="sharp", rectify="never").estimate(moved)
    assert notes == []


def test_noisy_pair_gets_another_cost():
    views, truth = slanted(shape=(160, 200))
    rng = np.random.default_rng(0)
    noisy = [
        np.clip(0.25 * each + rng.normal(96, 9, each.shape), 0, 255).astype(np.uint8)
        for each in (views.left, views.right)
    ]
    with collected() as notes:
        chosen = SemiGlobal(max_disparity_px=32).estimate(Views(*noisy)).disparity_px
    sharp = SemiGlobal(max_disparity_px=32, cost="sharp").estimate(Views(*noisy)).disparity_px
    assert any(each.startswith("cost ") for each in notes)
    assert share_within(chosen, truth, 1.0) > share_within(sharp, truth, 1.0)


@pytest.mark.parametrize("effort", ["balanced", "best"])
def test_grey_levels_are_compared_at_equal_exposure_only(effort):
    views, truth, _ = step()
    darker = Views(views.left, np.rint(0.6 * views.right).astype(np.uint8))
    levels = SemiGlobal(max_disparity_px=32, cost="levels", effort=effort)
    with collected() as notes:
        alike = SemiGlobal(max_disparity_px=32, effort=effort).estimate(views)
    assert not any("grey levels" in each for each in notes)
    assert alike.digest() == levels.estimate(views).digest()
    with collected() as notes:
        other = SemiGlobal(max_disparity_px=32, effort=effort).estimate(darker)
    assert any("skipped: comparing grey levels" in each for each in notes)
    misled = levels.estimate(darker)
    assert share_within(other.disparity_px, truth, 0.5) > share_within(misled.disparity_px, truth, 0.5)


def test_best_effort_has_fewer_wrong_pixels():
    wrong = {"balanced": [], "best": []}
    for seed in (1, 3):
        pair = known_pair("spheres", 240, 180, seed=seed)
        for effort, found in wrong.items():
            disparity_px = SemiGlobal.model_validate({"effort": effort}).estimate(pair.views).disparity_px
            found.append(1 - share_within(disparity_px, pair.truth_px, 2.0))
    assert np.mean(wrong["best"]) < 0.95 * np.mean(wrong["balanced"])


@pytest.mark.parametrize("resolution", ["full", "half"])
def test_best_effort_closes_gaps_that_the_right_view_sees(resolution, monkeypatch):
    """Without the right view's own matches there are more errors where both views show a pixel."""
    pairs = [known_pair(kind, 240, 180, seed=seed) for kind in ("steps", "spheres") for seed in (3, 5)]
    wrong = []
    for reconcile in (lambda matched, _: matched, refinement.reconcile):
        monkeypatch.setattr(refinement, "reconcile", reconcile)
        found = [SemiGlobal(effort="best", resolution=resolution).estimate(each.views) for each in pairs]
        seen = [
            np.abs(map_.disparity_px - pair.truth_px)[pair.visible] for map_, pair in zip(found, pairs, strict=True)
        ]
        wrong.append(np.mean(np.concatenate(seen) > 2))
    assert wrong[1] < 0.95 * wrong[0]


@pytest.mark.parametrize(("effort", "times"), [("balanced", 0), ("best", 1)])
def test_best_effort_alone_fills_from_eight_directions(effort, times, monkeypatch):
    filled = []
    monkeypatch.setattr(
        gaps, "fill_from_eight_directions", lambda *each: filled.append(each) or fill_from_four_directions(*each)
    )
    SemiGlobal(max_disparity_px=32, effort=effort).estimate(step()[0])
    assert len(filled) == times


@pytest.mark.parametrize(("across", "down"), [(0.05, 0.0), (-0.04, 0.06)])
def test_best_effort_follows_slanted_planes(across, down):
    views, truth = slanted(across=across, down=down, offset=9.0)
    found = SemiGlobal(max_disparity_px=32, effort="best").estimate(views)
    assert share_within(found.disparity_px, truth, 0.5, np.indices(truth.shape)[1] >= truth + 1) >= 0.97
    assert share_within(found.disparity_px, truth, 1.0) >= 0.97


@pytest.mark.parametrize("cost", ["sharp", "levels", "light", "heavy"])
def test_every_cost_finds_the_step(cost):
    views, truth, _ = step()
    found = SemiGlobal(max_disparity_px=32, cost=cost).estimate(views).disparity_px
    assert share_within(found, truth, 0.5) >= 0.95


@pytest.mark.parametrize("shape", [(1, 1), (1, 2), (1, 200), (200, 1), (2, 2), (3, 40), (5, 5), (40, 9)])
@pytest.mark.parametrize(
    "options", [{}, {"max_disparity_px": 500}, {"resolution": "half"}, {"fill": False}, {"effort": "best"}]
)
def test_small_pictures_are_answered(shape, options):
    rng = np.random.default_rng(1)
    views = Views(*rng.integers(0, 255, (2, *shape), np.uint8))
    found = SemiGlobal(**options).estimate(views)
    assert found.disparity_px.shape == shape
    assert not np.isinf(found.disparity_px).any()
    assert (np.abs(found.disparity_px[np.isfinite(found.disparity_px)]) < max(shape[1], 2)).all()


def test_every_dtype_gives_the_same_map():
    views, _, _ = step()
    options = SemiGlobal(max_disparity_px=32)
    expected = options.estimate(views).digest()
    for same in (lambda z: z.astype(np.uint16) * 257, lambda z: z / 255, lambda z: np.asfortranarray(z)):
        assert options.estimate(Views(same(views.left), same(views.right))).digest() == expected


def test_two_simultaneous_calls_are_independent():
    pairs = [step()[0], slanted(offset=12.0)[0], slanted(shape=(130, 90))[0]] * 3
    method = SemiGlobal(max_disparity_px=32)
    alone = [method.estimate(each).digest() for each in pairs]
    with ThreadPoolExecutor(4) as pool:
        assert [each.digest() for each in pool.map(method.estimate, pairs)] == alone


def test_range_too_wide_for_full_size_is_matched_smaller():
    views, truth = slanted(shape=(40, 1400), offset=310.0)
    with collected() as notes:
        found = SemiGlobal(min_disparity_px=0, max_disparity_px=400).estimate(views).disparity_px
    assert any("matched at 1/2" in each for each in notes)
    assert share_within(found, truth, 1.0) >= 0.97


def test_missing_right_view_is_refused():
    with pytest.raises(PictureError, match="right one is missing"):
        SemiGlobal().estimate(Views(np.zeros((4, 4), np.uint8)))


def test_empty_range_is_refused():
    with pytest.raises(PictureError, match=r"the search range 8\.\.4 px is empty"):
        SemiGlobal(min_disparity_px=8, max_disparity_px=5).estimate(slanted()[0])


def test_second_process_does_not_compile():
    noise = np.random.default_rng(0).integers(0, 255, (40, 60), np.uint8)
    SemiGlobal(max_disparity_px=16).estimate(Views(noise, np.roll(noise, -3, 1)))
    script = (
        "import numpy as np; from tangible_core.data import Views; from tangible_depth.semi_global import SemiGlobal;"
        "z = np.random.default_rng(0).integers(0, 255, (40, 60), np.uint8);"
        "SemiGlobal(max_disparity_px=16).estimate(Views(z, np.roll(z, -3, 1)))"
    )
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stderr
    assert "compiling" not in said

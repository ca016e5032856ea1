"""Semi-global matching on scenes that are exactly known: else the default's depths are wrong."""

import numpy as np
import pytest

from stereo_scenes import known_pair, slanted, step
from tangible_core.data import Views
from tangible_core.errors import PictureError
from tangible_core.plugins.notes import collected
from tangible_depth.dense import refinement
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


def test_occlusion_at_a_step_is_filled_from_behind_or_stays_unknown():
    views, truth, hidden = step()
    found = SemiGlobal(max_disparity_px=32).estimate(views)
    assert share_within(found.disparity_px, truth, 0.5) >= 0.985
    assert share_within(found.disparity_px, truth, 0.5, hidden) >= 0.95
    assert np.isfinite(found.disparity_px).all()
    assert found.confidence[hidden].mean() < 0.2 < 0.6 < found.confidence[~hidden].mean()
    found = SemiGlobal(max_disparity_px=32, fill=False).estimate(views)
    assert np.isnan(found.disparity_px[hidden]).mean() >= 0.9
    known = np.isfinite(found.disparity_px)
    assert known[~hidden].mean() >= 0.85
    assert share_within(found.disparity_px, truth, 0.5, known) >= 0.99
    assert (found.confidence[~known] == 0).all()


@pytest.mark.parametrize("offset", [-9.0, 3.0, 30.0])
def test_range_of_either_sign_is_estimated(offset):
    views, truth = slanted(shape=(120, 240), offset=offset)
    with collected() as notes:
        found = SemiGlobal().estimate(views).disparity_px
    assert share_within(found, truth, 0.5) >= 0.98
    assert any("as none was found up to 192 px; for nearer things write `max_disparity_px`" in note for note in notes)


def test_identical_views_and_strips_without_texture_are_not_matched():
    left = slanted()[0].left
    with collected() as notes:
        found = SemiGlobal().estimate(Views(left, left.copy()))
    assert (found.disparity_px == 0).all()
    assert any("identical" in note for note in notes)
    matched = SemiGlobal(skip_identical=False, max_disparity_px=16).estimate(Views(left, left.copy()))
    assert share_within(matched.disparity_px, np.zeros(left.shape), 0.5) >= 0.99
    views, truth = slanted(shape=(400, 120))
    pair = [np.array(each) for each in (views.left, views.right)]
    for each in pair:
        each[:256] = 90
    with collected() as notes:
        found = SemiGlobal(max_disparity_px=32).estimate(Views(*pair))
    assert any("no texture" in note for note in notes)
    assert (found.confidence[:250] == 0).all()
    assert share_within(found.disparity_px[264:], truth[264:], 0.5) >= 0.98
    with collected() as notes:
        SemiGlobal(max_disparity_px=32, skip_flat=False).estimate(Views(*pair))
    assert not any("no texture" in note for note in notes)


def test_preview_has_the_full_size_and_noise_another_cost():
    views, truth, _ = step(shape=(151, 223), back=8, front=24, box=(40, 110, 90, 170))
    with collected() as notes:
        found = SemiGlobal(max_disparity_px=48, resolution="half").estimate(views)
    assert found.disparity_px.shape == truth.shape
    assert any("full resolution" in note for note in notes)
    assert share_within(found.disparity_px, truth, 1.0) >= 0.96
    views, truth = slanted(shape=(160, 200))
    rng = np.random.default_rng(0)
    noisy = [
        np.clip(0.25 * each + rng.normal(96, 9, each.shape), 0, 255).astype(np.uint8)
        for each in (views.left, views.right)
    ]
    with collected() as notes:
        chosen = SemiGlobal(max_disparity_px=32).estimate(Views(*noisy)).disparity_px
    sharp = SemiGlobal(max_disparity_px=32, cost="sharp").estimate(Views(*noisy)).disparity_px
    assert any(note.startswith("cost ") for note in notes)
    assert share_within(chosen, truth, 1.0) > share_within(sharp, truth, 1.0)


@pytest.mark.parametrize("effort", ["balanced", "best"])
def test_grey_levels_are_compared_at_equal_exposure_only_and_every_cost_finds_the_step(effort):
    views, truth, _ = step()
    for cost in ("sharp", "levels", "light", "heavy"):
        found = SemiGlobal(max_disparity_px=32, cost=cost, effort=effort).estimate(views).disparity_px
        assert share_within(found, truth, 0.5) >= 0.95, cost
    darker = Views(views.left, np.rint(0.6 * views.right).astype(np.uint8))
    levels = SemiGlobal(max_disparity_px=32, cost="levels", effort=effort)
    with collected() as notes:
        alike = SemiGlobal(max_disparity_px=32, effort=effort).estimate(views)
    assert not any("grey levels" in note for note in notes)
    assert alike.digest() == levels.estimate(views).digest()
    with collected() as notes:
        other = SemiGlobal(max_disparity_px=32, effort=effort).estimate(darker)
    assert any("skipped: comparing grey levels" in note for note in notes)
    misled = levels.estimate(darker)
    assert share_within(other.disparity_px, truth, 0.5) > share_within(misled.disparity_px, truth, 0.5)


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


def test_empty_range_is_refused():
    with pytest.raises(PictureError, match=r"the search range 8\.\.4 px is empty"):
        SemiGlobal(min_disparity_px=8, max_disparity_px=5).estimate(slanted()[0])

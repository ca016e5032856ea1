"""The choice of a cost and the steps round it: else noisy, exchanged or large pairs are matched wrongly."""

import numpy as np
import pytest

from tangible_core.data import DisparityMap, Views
from tangible_core.plugins.notes import collected
from tangible_depth.dense.confidence import zero_disparity
from tangible_depth.dense.refinement import DenseMatches
from tangible_depth.dense.span import UNKNOWN, Span
from tangible_depth.dense.speckles import ISLAND_PX, remove_speckles
from tangible_depth.matching import adaptive as module
from tangible_depth.matching import chain, feature_chain, scaling
from tangible_depth.matching.adaptive import Fixed, Matched, MatchedView
from tangible_depth.matching.chain import Search, low_confidence_share, match_in_order
from tangible_depth.matching.scaling import Scaling
from tangible_depth.matching.window_matching import match_by_correlation, match_by_difference
from tangible_depth.rectify.projective import warp_pair
from tangible_depth.row_alignment.common_rows import shift_rows
from tangible_depth.search.pairs import Pair
from tangible_depth.sgm.costs import LEVELS, SHARP
from tangible_depth.sgm.strips import StripMatches
from tangible_depth.sparse.matches import NO_MATCHES


@pytest.mark.parametrize(
    ("effort", "loss", "differing", "name"),
    [
        ("balanced", 0.2, 0.0, "heavy"),
        ("balanced", 0.19, 0.0, "light"),
        ("balanced", 0.06, 0.0, "light"),
        ("balanced", 0.05, 0.27, "sharp"),
        ("balanced", 0.0, 0.28, "light"),
        ("best", 0.1, 0.31, "sharp"),
        ("best", 0.11, 0.0, "light"),
        ("best", 0.0, 0.315, "light"),
    ],
)
def test_cost_follows_from_speckles_or_from_differing_bits(effort, loss: float, differing: float, name: str):
    assert module._cost_for_noise(module._Health(loss, differing), effort).name == name


@pytest.mark.parametrize(
    ("loss", "differing", "apart", "why"),
    [
        (0.0, 0.0, 0.59, ""),
        (0.0, 0.0, 0.6, "60% of them are far apart where the views match: the exposures differ"),
        (0.06, 0.1, 0.0, "6% of the matches are speckles, and 10% of bits and levels differ"),
        (0.05, 0.265, 0.1, "5% of the matches are speckles, and 26% of bits and levels differ"),
        (0.059, 0.264, 0.59, ""),
    ],
)
def test_reason_against_levels_is_the_one_that_holds(loss: float, differing: float, apart: float, why: str):
    assert module._why_levels_mislead(module._Health(loss, differing), apart) == why


def test_probes_are_the_first_rows_of_strips_in_the_middles_of_equal_parts():
    rows = [(y, min(y + 100, 1150)) for y in range(0, 1150, 100)]
    probes, rest = module._probes(rows)
    assert probes == [(200, 264), (600, 664), (1000, 1064)]
    assert [row for row in rows if row not in rest] == [(200, 300), (600, 700), (1000, 1100)]
    assert sorted([*probes, *rest]) == sorted(
        [row for row in rows if row[0] not in (200, 600, 1000)]
        + [part for y in (200, 600, 1000) for part in ((y, y + 64), (y + 64, y + 100))]
    )
    assert module._probes([(0, 50)]) == ([(0, 50)], [])
    assert module._probes([(0, 90), (90, 130)]) == ([(0, 64), (90, 130)], [(64, 90)])


@pytest.mark.parametrize(
    ("loss", "tried", "chosen"),
    [
        (0.05, ["levels"], "levels"),
        (0.06, ["levels", "sharp"], "sharp"),
        (0.39, ["levels", "sharp"], "sharp"),
        (0.4, ["levels"], "heavy"),
    ],
)
def test_order_alone_is_not_tried_where_noise_is_far_too_strong(
    loss: float, tried: list[str], chosen: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
):
    costs: list[str] = []

    def health(one: module._Trial, rows: module.Rows) -> module._Health:
        costs.append(one.cost.name)
        one.sweep(rows)
        return module._Health(loss if one.cost is LEVELS else 0.0, 0.1)

    monkeypatch.setattr(module._Trial, "health", health)
    left = np.random.default_rng(0).integers(0, 256, (130, 60), np.uint8)
    pair = Pair.of(left, np.roll(left, -3, axis=1))
    with caplog.at_level("INFO"):
        found = module.match(pair, Span(-4, 11), [(0, 100), (100, 130)], Fixed(None, 1.08, False, "balanced"))
    assert found.mirrored_right is None
    assert (costs, found.cost.name) == (tried, chosen)
    assert np.mean(np.abs(found.left.matches.disparity[:, 8:-8] - 48) <= 8) > 0.8
    why = "cost heavy: 40% of the matches are speckles"
    assert [message for message in caplog.messages if message.startswith("cost")] == [why] * (chosen == "heavy")


def trial(pair: Pair, cost=LEVELS):
    """Return a trial of this pair."""
    return module._Trial(pair, Span(-4, 11), cost, 1.08, "best")


def test_views_are_compared_where_they_match_by_the_share_that_differs():
    """Halved levels that differ by four are far apart: one of four in the first row, and the only one of the 17th."""
    left = np.full((17, 12), 100, np.uint8)
    right = np.full((17, 12), 150, np.uint8)
    looked = trial(Pair.of(left, right))
    looked.out.disparity[0, 4:8] = [32, 39, 40, -16]
    right[0, [2, 3, 3, 8]] = [100, 107, 107, 108]
    looked.out.disparity[16, 11] = 16 * 9
    right[16, 2] = 93
    looked.pair = Pair.of(left, right)
    assert looked.levels_apart([(0, 17)]) == pytest.approx(2 / 5)
    looked.out.disparity[1:16] = 0  # of every 16th row alone
    assert looked.levels_apart([(0, 17)]) == pytest.approx(2 / 5)
    assert looked.levels_apart([(1, 2)]) == 1
    left = np.random.default_rng(0).integers(0, 256, (80, 60), np.uint8)
    right = np.roll(left, -3, axis=1)
    right[:, :25] = np.random.default_rng(1).integers(0, 256, (80, 25))
    looked = trial(Pair.of(left, right), SHARP)
    found = looked.health([(0, 40), (60, 80)])
    known = specks = bits = 0
    for rows in (slice(0, 40), slice(60, 80)):
        part = looked.out.disparity[rows].copy()
        known += np.count_nonzero(part != UNKNOWN)
        specks += remove_speckles(part, ISLAND_PX)
        bits += looked.out.sums[rows][part != UNKNOWN].sum(dtype=int)
    assert specks > 0
    assert found.loss == specks / known
    assert found.differing == pytest.approx(bits / (4 * 24 * (known - specks)))
    assert (looked.out.disparity[40:60] == UNKNOWN).all()


@pytest.mark.parametrize("row_offset_px", [0.0, 0.5])
def test_best_effort_matches_the_exchanged_pair_at_the_same_cost_and_rows(row_offset_px, monkeypatch):
    monkeypatch.setattr(module, "_row_offset", lambda *_: row_offset_px)
    left, right = np.random.default_rng(0).integers(0, 256, (2, 40, 60), np.uint8)
    right[:, :-5] = left[:, 5:]
    pair, span = Pair.of(left, right), Span(-4, 11)
    found = module.match(pair, span, [(0, 40)], Fixed(None, 1.08, True, "best"))
    assert found.mirrored_right is not None
    aligned = shift_rows(pair, row_offset_px) if row_offset_px else pair
    assert np.array_equal(found.left.grey, aligned.left)
    assert np.array_equal(found.mirrored_right.grey, aligned.right[:, ::-1])
    again = module.match(aligned.exchange(), span, [(0, 40)], Fixed(found.cost, 1.08, False, "best")).left.matches
    assert np.array_equal(found.mirrored_right.matches.disparity, again.disparity)
    if not row_offset_px:
        assert np.mean(np.abs(found.mirrored_right.matches.disparity[:, 8:-8] - 80) <= 8) > 0.9


PAIR = Pair.of(*np.random.default_rng(0).integers(0, 256, (2, 6, 9), np.uint8))
SEARCH = Search("auto", "auto", "auto", fill=True)


def asked_by(span: Span) -> tuple[DisparityMap, Pair, Span]:
    """Match the pair within a span by what grows along the rows of the left picture that was given."""
    asked = []

    def match(pair: Pair, span: Span) -> DenseMatches:
        asked.append((pair, span))
        columns = np.indices(pair.left.shape)[1]
        return DenseMatches((16 * columns).astype(np.int16), (columns / 10).astype(np.float32))

    found = match_in_order(PAIR, span, True, match)
    return found, *asked[0]


@pytest.mark.parametrize("span", [Span(-9, 1), Span(0, 30)])
def test_range_with_positive_disparities_is_matched_as_it_is(span: Span):
    found, pair, asked = asked_by(span)
    assert (asked, pair is PAIR) == (span, True)
    assert found.disparity_px[0].tolist() == list(range(9))


@pytest.mark.parametrize(("span", "turned"), [(Span(-9, -2), Span(2, 9)), (Span(-30, 0), Span(0, 30))])
def test_range_without_positive_disparities_is_matched_in_a_mirror(span: Span, turned: Span):
    found, pair, asked = asked_by(span)
    assert asked == turned
    assert np.array_equal(pair.left, PAIR.left[:, ::-1])
    assert np.array_equal(pair.right, PAIR.right[:, ::-1])
    assert found.disparity_px[0].tolist() == list(range(-8, 1))
    assert found.confidence[0] == pytest.approx(np.arange(8, -1, -1) / 10)


def test_pixels_are_unknown_where_flat_and_known_at_the_least_confidence():
    left = np.full((9, 14), 80, np.uint8)
    left[:, 9:] = np.arange(5) * 30
    for fill in (True, False):
        found = zero_disparity(left, fill)
        assert np.array_equal(np.isnan(found.disparity_px), (np.arange(14) < 7) & (not fill) & (left > -1))
        assert np.array_equal(found.confidence, (np.arange(14) >= 7) * np.ones((9, 1)))
        assert np.isnan(zero_disparity(left[:, :5], fill).disparity_px).all()
    confidence = np.float32([[0.1, 0.15, 0.2, 0.14]])
    assert chain.LOW_CONFIDENCE == 0.15
    confidence[0, 1] = 0.15000001
    assert low_confidence_share(DisparityMap(np.zeros((1, 4), np.float32), confidence)) == 0.5
    exact = np.array([[0.1, 0.125, 0.2, 0.14]], np.float32)
    assert low_confidence_share(DisparityMap(np.zeros((1, 4), np.float32), exact)) == 0.75


@pytest.mark.parametrize(("better", "worse"), [((0.2, 0.2), (0.2, 0.1)), ((0.2, 0.1), (0.2, 0.1))])
def test_first_map_stays_unless_the_rectified_one_is_better(better, worse, monkeypatch: pytest.MonkeyPatch):
    again, first = (
        DisparityMap(np.zeros((1, 2), np.float32), np.array([each], np.float32)) for each in (better, worse)
    )
    monkeypatch.setattr(chain, "_match_rectified", lambda *_: again)
    views = Views(PAIR.left, PAIR.right)
    with collected() as notes:
        found = chain._retry_rectified(views, "", SEARCH, lambda *_: None, first)
    assert found is (again if better != worse else first)
    assert notes == ["retried with rectification: 50% of the pixels have low confidence"]


OPTIONS = Scaling("auto", "balanced", "auto", "soft", realign_rows=True, skip_flat=True)


@pytest.mark.parametrize(
    ("resolution", "disparities", "factor"),
    [("auto", 256, 1), ("auto", 257, 2), ("auto", 600, 4), ("full", 512, 1), ("full", 513, 2), ("half", 20, 2)],
)
def test_pictures_are_smaller_where_more_disparities_are_tried_than_fit(resolution, disparities: int, factor: int):
    with collected() as notes:
        found = scaling._factor(Span(0, disparities - 1), OPTIONS._replace(resolution=resolution))
    assert found == factor
    assert notes == [f"skipped: full resolution, matched at 1/{factor}"] * (factor > 1)


def test_strips_have_texture_and_confidence_by_their_windows(monkeypatch: pytest.MonkeyPatch):
    grey = np.full((40, 30), 90, np.uint8)
    grey[20, 7] = 91
    assert [scaling._has_texture(grey, y, y + 4) for y in (14, 15, 20, 22, 23)] == [False, True, True, True, False]
    grey = np.random.default_rng(0).integers(0, 256, (20, 60), np.uint8)
    sums = np.tile(np.repeat([0, 24, 48, 96, 255], 12), (20, 1)).astype(np.uint8)
    disparity = np.full(grey.shape, np.int16(64))
    assert (disparity != UNKNOWN).all()
    view = MatchedView(StripMatches(disparity.copy(), sums), grey)
    monkeypatch.setattr(scaling, "match", lambda *_: Matched(view, None, SHARP))
    found = scaling.match_scaled(Pair.of(grey, grey), Span(0, 15), OPTIONS)
    np.testing.assert_allclose(found.confidence[0], np.repeat([1, 0.75, 0.5, 0.2, 0.2], 12), atol=1e-6)


def test_right_view_is_completed_by_the_picture_that_was_matched(monkeypatch):
    """The given one before its rows were realigned would put its edges on other rows than the matches have."""
    left, right, moved = np.random.default_rng(0).integers(0, 256, (3, 20, 60), np.uint8)
    known, other = (StripMatches(np.full((20, 60), np.int16(each)), np.zeros((20, 60), np.uint8)) for each in (64, 80))
    views = MatchedView(known, left), MatchedView(other, np.ascontiguousarray(moved[:, ::-1]))
    monkeypatch.setattr(scaling, "match", lambda *_: Matched(*views, SHARP))
    seen = {}

    def complete(disparity, sums, by_sum, grey, *more):
        seen[int(disparity[0, 0])] = grey
        return module_complete(disparity, sums, by_sum, grey, *more)

    module_complete = scaling.complete
    monkeypatch.setattr(scaling, "complete", complete)
    scaling.match_scaled(Pair.of(left, right), Span(0, 15), OPTIONS._replace(effort="best"))
    assert np.array_equal(seen[64], left)
    assert np.array_equal(seen[80], moved[:, ::-1])


VIEWS = Views(*np.random.default_rng(0).integers(0, 256, (2, 20, 90), np.uint8))


@pytest.mark.parametrize(("start_px", "most", "span"), [(0, 40, (0, 40)), (-8, 40, (8, 48)), (5, 40, (-5, 35))])
def test_requested_range_counts_from_the_original_picture(start_px: int, most: int, span: tuple[int, int]):
    rectified = warp_pair(VIEWS, (np.eye(3), np.eye(3)), "", start_px)
    assert feature_chain._range(NO_MATCHES, rectified, most) == span


@pytest.mark.parametrize("window_px", [3, 7])
@pytest.mark.parametrize("brighter", [0, 10, 20])
def test_confidence_of_squared_differences_is_that_of_their_mean(window_px: int, brighter: int):
    """It falls to 1 / e at a difference of 20 levels."""
    left = np.random.default_rng(0).integers(0, 230, (30, 60), np.uint8)
    pair = Pair.of(left, left + np.uint8(brighter))
    found = match_by_difference(pair, Span(0, 0), window_px).confidence[10:-10, 10:-10]
    np.testing.assert_allclose(found, np.exp(-((brighter / 20) ** 2)), atol=1 / 255)
    assert match_by_correlation(pair, Span(0, 0), window_px).confidence[15, 20] == pytest.approx(1, abs=1e-4)

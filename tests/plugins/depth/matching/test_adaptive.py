"""The choice of a cost: its thresholds, its trials, and the reasons that it gives."""

import numpy as np
import pytest

from tangible_depth.dense.span import UNKNOWN, Span
from tangible_depth.dense.speckles import ISLAND_PX, remove_speckles
from tangible_depth.matching import adaptive as module
from tangible_depth.matching.adaptive import Fixed
from tangible_depth.row_alignment.row_offset import shift_rows
from tangible_depth.search.pairs import Pair
from tangible_depth.sgm.costs import LEVELS, SHARP


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
    assert [each for each in rows if each not in rest] == [(200, 300), (600, 700), (1000, 1100)]
    assert sorted([*probes, *rest]) == sorted(
        [each for each in rows if each[0] not in (200, 600, 1000)]
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
    """Levels lose this share of their matches, and the order alone none."""
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
    assert [each for each in caplog.messages if each.startswith("cost")] == [why] * (chosen == "heavy")


def trial(pair: Pair, cost=LEVELS):
    """Return a trial of this pair."""
    return module._Trial(pair, Span(-4, 11), cost, 1.08, "best")


def test_levels_are_compared_where_the_views_match():
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


def test_health_is_the_share_of_speckles_and_that_of_bits_that_differ_elsewhere():
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

"""Medians, means, ratios, fronts, tables: exact answers from rows that are made up."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_bench.measuring.rows import Row
from tangible_bench.results.summary import cells, lines, spread
from tangible_bench.results.table import Results, front, tables
from tangible_bench.tasks.task import load_task

ROW = Row("k", "depth", "m", "m", {}, "d 1", "s", "digest", "none", (), 0, {}, {"processor": "p"}, seconds=1.0)


def row(method: str, repeat: int, seconds: float | None, scene: str = "s", perturb: str = "none", **more) -> Row:
    key = f"{method} {scene} {perturb} {repeat}"
    return replace(ROW, key=key, method=method, repeat=repeat, seconds=seconds, scene=scene, perturb=perturb, **more)


def test_ratio_is_median_of_pairs_within_a_round():
    """The machine slows down tenfold in the last round: pairs do not notice, medians of each alone would."""
    rows = [row("base", 0, 1.0), row("fast", 0, 0.5), row("base", 1, 1.0), row("fast", 1, 0.5)]
    rows += [row("base", 2, 10.0), row("fast", 2, 5.0)]
    found = cells(rows, "base")
    assert found["fast", "s", "none"].ratios == [0.5, 0.5, 0.5]
    assert found["base", "s", "none"].ratios == [1, 1, 1]
    assert cells(rows[1:], "base")["fast", "s", "none"].ratios == [0.5, 0.5], "no baseline in the first round"
    (base, fast) = lines(found, "none", ["s"])
    assert (base.ratio, fast.ratio, fast.seconds) == (1, 0.5, 0.5)


def test_lines_over_scenes_are_means():
    rows = [
        row("m", 0, 1.0, "a", measures={"bad2": 2.0}, peak_memory_bytes=10),
        row("m", 0, 3.0, "b", measures={"bad2": 4.0}, peak_memory_bytes=30),
        row("base", 0, 2.0, "a", measures={"bad2": 1.0}),
        row("base", 0, 1.5, "b", measures={"bad2": None}),
    ]
    m, base = lines(cells(rows, "base"), "none", ["a", "b"])
    assert (m.seconds, m.measures["bad2"], m.memory_bytes, m.done) == (2.0, 3.0, 30, 2)
    assert m.ratio == pytest.approx(math.sqrt(0.5 * 2.0))
    assert math.isnan(base.measures["bad2"])
    assert math.isnan(base.memory_bytes)


def test_scene_without_truth_does_not_count_in_means():
    """No method has the measure on it: unlike one on which only this method lacks it."""
    rows = [row(name, 0, 1.0, "a", measures={"bad2": value}) for name, value in (("m", 2.0), ("n", None))]
    rows += [row(name, 0, 3.0, "b", measures={"bad2": None}) for name in "mn"]
    m, n = lines(cells(rows, None), "none", ["a", "b"])
    assert (m.seconds, m.measures["bad2"], m.done) == (2.0, 2.0, 2)
    assert math.isnan(n.measures["bad2"])


def test_method_without_result_on_a_scene_has_no_mean():
    rows = [row("m", 0, 1.0, "a", measures={"bad2": 2.0}), row("m", 0, None, "b", error="no")]
    (m,) = lines(cells(rows, None), "none", ["a", "b"])
    assert math.isnan(m.seconds)
    assert (m.measures, m.done, m.scenes) == ({}, 1, 2)


def test_spread_is_scaled_median_deviation():
    assert spread([1, 2, 3, 4, 100]) == pytest.approx(1.4826)
    assert (spread([5]), spread([])) == (0, 0)


points = st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), max_size=12)


@given(points)
def test_front_has_exactly_the_unbeaten_points(found: list[tuple[int, int]]):
    best = [found[index] for index in front(found)]
    assert best == sorted(best)
    for point in found:
        beaten = any(other != point and other[0] <= point[0] and other[1] <= point[1] for other in found)
        assert (point in best) is not beaten
    assert front([(1.0, float("nan")), (float("nan"), 0.0), (2.0, 2.0)]) == [2]


def results() -> Results:
    rows = [
        row("slow", 0, 2.0, measures={"bad2": 1.0, "density": 100.0}),
        row("fast", 0, 1.0, measures={"bad2": 3.0, "density": 90.0}),
        row("bad", 0, 3.0, measures={"bad2": 9.0, "density": 80.0}),
        row("slow", 0, 2.0, perturb="noise 5", measures={"bad2": 2.0}),
        row("fast", 0, 1.0, perturb="noise 5", measures={"bad2": 30.0}),
        row("bad", 0, None, perturb="noise 5", error="gone"),
    ]
    return Results(load_task("depth"), cells(rows, "fast"), "fast")


def test_tables_have_means_perturbations_and_failures():
    overview, perturbed, failures = tables(results())
    assert [(line[0], line[1], line[2], line[3]) for line in overview.rows] == [
        ("slow", "*", "2000.0", "2.00"),
        ("fast", "*", "1000.0", "1.00"),
        ("bad", "", "3000.0", "3.00"),
    ]
    assert perturbed.headings == ("method", "none", "noise 5")
    assert perturbed.rows == (("slow", "1.00", "2.00"), ("fast", "3.00", "30.00"), ("bad", "9.00", "-"))
    assert failures.rows == (("bad", "s, noise 5", "gone"),)
    detailed = tables(results(), detail=True)
    assert [table.title for table in detailed[2:-1]] == ["s", "s, noise 5"]
    assert "density noc %" in detailed[2].headings and "A90 px" not in detailed[2].headings


def test_measure_that_is_better_when_high_ranks_the_other_way():
    found = results()
    lines_ = found.means()
    assert [line.method for line in sorted(lines_, key=lambda line: found.loss(line, "density"))] == [
        "slow",
        "fast",
        "bad",
    ]
    assert [lines_[index].method for index in found.on_front(lines_, "density")] == ["fast", "slow"]

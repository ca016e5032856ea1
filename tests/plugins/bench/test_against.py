"""Regressions between two files of results: noise, tolerances, and files that cannot be compared."""

from dataclasses import replace

import pytest

from tangible_bench.measuring.rows import Row
from tangible_bench.results.regressions import find_regressions
from tangible_core.errors import ResultsError

ROW = Row("k", "depth", "m", "m", {}, "d 1", "s", "digest", "none", (), 0, {}, {"processor": "p"})


def rows(seconds: list[float], method: str = "m", bad2: float | None = 5.0, memory: int = 10**8, **more) -> list[Row]:
    return [
        replace(
            ROW, method=method, repeat=repeat, seconds=second, peak_memory_bytes=memory, measures={"bad2": bad2}, **more
        )
        for repeat, second in enumerate(seconds)
    ]


def worse(before: list[Row], after: list[Row]) -> list[str]:
    return [each.what for each in find_regressions(before, after).worse]


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [
        ([1.0, 1.0, 1.0], [1.09, 1.09, 1.09], []),
        ([1.0, 1.0, 1.0], [1.11, 1.11, 1.11], ["time s"]),
        ([1.0, 1.0, 1.0], [0.1, 0.1, 0.1], []),
        ([0.9, 1.0, 1.1], [1.3, 1.4, 1.5], []),
        ([0.9, 1.0, 1.1], [1.6, 1.7, 1.8], ["time s"]),
        ([1.0], [1.05], []),
    ],
    ids=["within a tenth", "over a tenth", "faster", "within the noise", "over the noise", "one repeat"],
)
def test_time_is_worse_beyond_a_tenth_and_the_noise(before: list[float], after: list[float], expected: list[str]):
    assert worse(rows(before), rows(after)) == expected


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [(5.0, 5.004, []), (5.0, 5.006, ["bad2 %"]), (5.0, 1.0, []), (5.0, None, ["bad2 %"]), (None, 5.0, [])],
)
def test_error_is_worse_beyond_its_tolerance(before: float | None, after: float | None, expected: list[str]):
    assert worse(rows([1.0], bad2=before), rows([1.0], bad2=after)) == expected


def test_memory_and_measures_that_are_better_when_high_have_their_own_bounds():
    for before, after, expected in ((10**8, 104 * 10**6, []), (10**8, 106 * 10**6, ["memory bytes"]), (0, 10**6, [])):
        assert worse(rows([1.0], memory=before), rows([1.0], memory=after)) == expected
    high, low = ([replace(ROW, seconds=1.0, measures={"density": value})] for value in (90.0, 80.0))
    assert worse(high, low) == ["density %"] and worse(low, high) == []
    (found,) = find_regressions(rows([0.9, 1.0, 1.1]), rows([1.6, 1.7, 1.8])).worse
    assert found.allowed == pytest.approx(3 * 2**0.5 * 1.4826 * 0.1), "three standard deviations"
    assert (found.before, found.after) == (1.0, 1.7)


def test_method_that_fails_now_is_worse():
    (found,) = find_regressions(rows([1.0]), [replace(ROW, error="gone")]).worse
    assert (found.what, found.why) == ("fails", "gone")
    assert worse([replace(ROW, error="gone")], rows([1.0])) == []
    assert worse([replace(ROW, error="gone")], [replace(ROW, error="still")]) == []


def test_times_with_a_common_baseline_are_compared_as_ratios():
    before = rows([1.0], baseline="base") + rows([2.0], "base", baseline="base")
    other = {"baseline": "base", "machine": {"processor": "q"}}
    assert worse(before, rows([10.0], **other) + rows([20.0], "base", **other)) == []
    assert worse(before, rows([12.0], **other) + rows([20.0], "base", **other)) == ["time / baseline"]


def test_cells_in_one_file_only_are_reported_missing():
    verdict = find_regressions(rows([1.0]) + rows([1.0], "gone"), rows([1.0]) + rows([1.0], "new"))
    assert (verdict.compared, verdict.missing) == (1, ("gone | s | none", "new | s | none"))


@pytest.mark.parametrize(
    ("after", "why"),
    [
        ([], "a file without rows"),
        (rows([1.0], compare="texture"), "compares depth, the other texture"),
        (rows([1.0], machine={"processor": "q"}), "seconds on p and on q"),
        (rows([1.0], "other"), "in common"),
        (rows([1.0], scene_digest="other"), "in common"),
    ],
)
def test_files_without_common_ground_are_refused(after: list[Row], why: str):
    with pytest.raises(ResultsError, match=why):
        find_regressions(rows([1.0]), after)

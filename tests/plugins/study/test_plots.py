"""What plots of a study draw: points, curves, intervals and words on the axes."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from tangible_study.analysis.plots import _draw_curves, _draw_figures
from tangible_study.analysis.rows import ALL, Result, Row, What
from tangible_study.statistics.intervals import Estimate
from tangible_study.statistics.psychometric import Blocks, Curve

LEVELS = np.array([1.0, 2.0, 3.0])


def curve(chance: float = 0.0) -> Curve:
    return Curve(Estimate(2.0, 1.8, 2.2), Estimate(1.0, 0.8, 1.3), 0.02, chance)


@pytest.mark.parametrize(
    ("chance", "unit", "label", "shares", "line"),
    [
        (0.0, "mm", "level, mm", "share of answers 'higher'", 0.5),
        (0.0, "", "level", "share of answers 'higher'", 0.5),
        (1 / 3, "N", "difference, N", "share of right answers", 1 / 3),
    ],
)
def test_curves_have_their_points_and_axes(chance: float, unit: str, label: str, shares: str, line: float):
    """Two conditions of two participants: curves of one colour a condition, and points as large as they count."""
    keys = ("S01/one", "S01/two", "S02/one", "S02/two")
    blocks = Blocks(LEVELS, np.array([1.0, 5, 8]), np.array([10.0, 5, 8]))
    rows = [Row(What("point of equality", "one"), "S01", Estimate(2.0), unit)]
    result = Result(
        "c", "higher", ["S01", "S02"], rows, "point of equality",
        dict.fromkeys(keys, curve(chance)), dict.fromkeys(keys, blocks),
    )  # fmt: skip
    axes = Figure().subplots()
    _draw_curves(axes, result)
    assert (axes.get_xlabel(), axes.get_ylabel()) == (label, shares)
    *drawn, one, two, level = axes.lines
    assert [each.get_color() for each in drawn] == [one.get_color(), two.get_color()] * 2
    assert one.get_color() != two.get_color() and one.get_marker() != two.get_marker()
    assert level.get_ydata() == [line, line]
    for each in drawn:
        assert (each.get_xdata()[0], each.get_xdata()[-1], len(each.get_xdata())) == (1.0, 3.0, 200)
        assert np.array_equal(each.get_ydata(), curve(chance).at(each.get_xdata()))
        assert each.get_linewidth() < 1
    for points in axes.collections:
        assert np.array_equal(points.get_offsets(), [[1, 0.1], [2, 1.0], [3, 1.0]])
        assert points.get_sizes().tolist() == [34.0, 19.0, 28.0]
    assert [each.get_text() for each in axes.get_legend().texts] == ["one", "two"]


def test_figures_have_their_intervals_and_single_participants():
    measure = "mean rating"
    rows = [
        Row(What(measure, "one"), ALL, Estimate(3.0, 2.0, 4.5), "", 9, None, 2.5),
        Row(What(measure, "two", "one"), ALL, Estimate(5.0), "", 9, None, 2.5),
        Row(What(measure, "one"), "S01", Estimate(2.0)),
        Row(What(measure, "one"), "S02", Estimate(4.0)),
        Row(What("other", "one"), "S01", Estimate(9.0)),
    ]
    axes = Figure().subplots()
    _draw_figures(axes, Result("c", "rating", ["S01", "S02"], rows, measure))
    drawn = [tuple(list(each) for each in line.get_data()) for line in axes.lines]
    (single, interval, value), (none, alone), (chance,) = drawn[:3], drawn[3:5], drawn[5:]
    assert single[0] == [2.0, 4.0] and single[1] == pytest.approx([0.18, 0.2])
    assert interval == ([2.0, 4.5], [0, 0])
    assert value == ([3.0], [0])
    assert none[0] == [] and alone == ([5.0], [1])
    assert chance[0] == [2.5, 2.5]
    assert [each.get_text() for each in axes.get_yticklabels()] == ["one", "two / one"]
    assert axes.get_xlabel() == measure and axes.get_ylim() == (1.5, -0.5)

"""If a case fails, a description says a false value of a bar, or one of a picture that is no chart."""

import numpy as np
import pytest

from tangible_core.data import PictureText
from tangible_core.drawing import bar_values

BARS = {1: (40, 30.5), 2: (90, 12.0), 3: (140, 20.0)}
AXIS = ("0", "10", "20", "30", "40")


def chart(axis: tuple[str, ...] = AXIS, step: int = 40, level: bool = False) -> tuple[np.ndarray, list[PictureText]]:
    """Return bars of 4 px for each one on a sheet of 200 x 200 px, and an axis of numbers `step` px apart."""
    labels = np.zeros((200, 200), np.int32)
    for number, (left, value) in BARS.items():
        labels[180 - round(4 * value) : 180, left : left + 30] = number
    labels[20:25, 60:120], labels[185:199, 0:30] = 4, 5  # a legend, and a field at the rim
    tops = [176 - step * place for place in range(len(axis))]
    boxes = [(0.1 - 0.02 * len(text), top / 200, 0.1, (top + 8) / 200) for text, top in zip(axis, tops, strict=True)]
    if level:
        labels = np.ascontiguousarray(np.rot90(labels, -1))
        boxes = [(1 - (top + 8) / 200, 0.94, 1 - top / 200, 0.98) for top in tops]
    return labels, [PictureText(*both) for both in zip(axis, boxes, strict=True)]


@pytest.mark.parametrize("level", [False, True])
@pytest.mark.parametrize("axis", [AXIS, ("0", "10", "20", "80", "40"), ("O", "10", "20", "", "40")])
def test_bars_have_the_values_of_their_axis_though_a_number_is_misread(axis, level):
    values = bar_values(*chart(axis, level=level))
    assert values == pytest.approx({number: value for number, (_, value) in BARS.items()}, abs=0.6)


def test_scale_may_have_commas_and_fall_below_nothing():
    values = bar_values(*chart(("\N{MINUS SIGN}0,5", "0", "0,5", "1", "1,5")))
    assert values == pytest.approx({number: value / 20 - 0.5 for number, (_, value) in BARS.items()}, abs=0.03)


def test_picture_without_an_even_axis_or_bars_on_one_line_has_no_values():
    assert bar_values(*chart(("7", "19", "2", "30", "11"))) == {}
    assert bar_values(*chart(("0", "10"))) == {} and bar_values(chart()[0], []) == {}
    labels, texts = chart()
    assert bar_values(np.zeros_like(labels), texts) == {} and bar_values(np.zeros((1, 1), np.int32), texts) == {}
    rows, columns = np.indices(labels.shape)
    assert bar_values((np.hypot(rows - 90, columns - 90) < 60).astype(np.int32), texts) == {}

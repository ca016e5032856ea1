"""If one of these fails, a picture is divided at other borders, or into more segments, than was asked for."""

import numpy as np
import pytest

from tangible_core.data import SegmentTree

LABELS = np.array([[0, 0, 1], [2, 3, 1]], np.int32)
JOINS = np.array([[1, 3], [0, 2], [4, 5]], np.int32)
LEVELS = np.array([0.125, 0.5, 0.875], np.float32)  # exact in single precision: a level itself is kept


@pytest.mark.parametrize(
    ("most", "level", "labels", "confidence"),
    [
        (9, 0.0, [[0, 0, 1], [2, 3, 1]], [[0.5, 0.5, 0.125], [0.5, 0.125, 0.125]]),
        (3, 0.0, [[0, 0, 2], [1, 2, 2]], [[0.5, 0.5, 0.875], [0.5, 0.875, 0.875]]),
        (9, 0.125, [[0, 0, 1], [2, 3, 1]], [[0.5, 0.5, 0.125], [0.5, 0.125, 0.125]]),
        (9, 0.2, [[0, 0, 2], [1, 2, 2]], [[0.5, 0.5, 0.875], [0.5, 0.875, 0.875]]),
        (9, 0.6, [[1, 1, 0], [1, 0, 0]], [[0.875] * 3] * 2),
        (2, 0.2, [[1, 1, 0], [1, 0, 0]], [[0.875] * 3] * 2),
        (1, 0.0, [[0] * 3] * 2, [[1.0] * 3] * 2),
        (9, 1.0, [[0] * 3] * 2, [[1.0] * 3] * 2),
    ],
)
def test_cut_keeps_borders_of_the_level_and_at_most_the_number(
    most: int, level: float, labels: list[list[int]], confidence: list[list[float]]
):
    found = SegmentTree(LABELS, JOINS, LEVELS).cut(most, level)
    assert found.labels.tolist() == labels
    assert found.confidence == pytest.approx(np.array(confidence, np.float32))

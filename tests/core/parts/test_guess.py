"""If one of these fails, guessed heights of parts are in a wrong order."""

import numpy as np
import pytest

from tangible_core.data import PartMap, SegmentMap
from tangible_core.parts import find_parts, guess_heights
from tangible_core.parts import guess as guess_module
from tangible_core.parts import neighbours as neighbours_module
from tangible_core.parts.neighbours import in_front, neighbours


def parts_of(labels) -> PartMap:
    return find_parts(SegmentMap(np.asarray(labels, np.int32)))


def discs(*centres: tuple[int, int], shape: tuple[int, int] = (200, 300), radius: int = 40) -> np.ndarray:
    """Return labels of discs at [x, y] on a ground, each over the earlier ones."""
    row, column = np.indices(shape)
    labels = np.zeros(shape, np.int32)
    for number, (x, y) in enumerate(centres, 1):
        labels[(column - x) ** 2 + (row - y) ** 2 < radius**2] = number
    return labels


def guess(labels: np.ndarray) -> dict[int, float]:
    """Guess heights by label."""
    parts = parts_of(labels)
    return dict(zip(parts.segments, guess_heights(parts, 0.004).heights_m, strict=True))


def sure_of(labels: np.ndarray) -> dict[tuple[int, int], float]:
    """Return the certainty, by pair of labels, that the second is in front."""
    parts = parts_of(labels)
    beside = neighbours(parts)
    of = np.asarray(parts.segments)
    pairs = zip(of[beside.low].tolist(), of[beside.high].tolist(), in_front(parts, beside).tolist(), strict=True)
    return {tuple(sorted((low, high))): sure if low < high else -sure for low, high, sure in pairs}


@pytest.mark.parametrize(
    ("first", "second"), [((120, 100), (170, 100)), ((170, 90), (120, 110)), ((150, 130), (150, 80))]
)
def test_disc_whose_border_runs_on_is_in_front(first, second):
    labels = discs(first, second)
    assert sure_of(labels)[1, 2] > 0.4
    heights_m = guess(labels)
    assert heights_m[0] < heights_m[1] < heights_m[2]


@pytest.mark.parametrize(("inside", "order"), [([60, 90, 160], (0, 2, 1)), ([220, 40, 30], (0, 1, 2))])
def test_enclosed_part_of_the_colour_beyond_is_a_hole(inside, order):
    """A dark ring low in the picture on blue; its middle is blue too, or red as a thing on a plate."""
    labels = discs((150, 140), radius=50)
    labels[discs((150, 150), radius=25) == 1] = 2
    picture = np.uint8([[70, 95, 150], [50, 40, 30], inside])[labels]
    parts = parts_of(labels)
    heights = guess_heights(parts, 0.004, picture)
    by_label = dict(zip(parts.segments, heights.heights_m, strict=True))
    assert sorted(by_label, key=by_label.__getitem__) == [order.index(rank) for rank in range(3)]
    assert ("it is behind part 2" in heights.reasons[2]) == (order == (0, 2, 1))
    assert dict(zip(parts.segments, guess_heights(parts, 0.004).heights_m, strict=True))[2] == 0.004


def regions(seed: int, shape: tuple[int, int] = (61, 83)) -> np.ndarray:
    """Return regions of all sizes, one within another, another at the lower rim with one neighbour, and specks."""
    rng = np.random.default_rng(seed)
    row, column = np.indices(shape)
    at = rng.uniform((0, 0), shape, (14, 2))
    labels = np.argmin([np.hypot(row - y, column - x) - rng.uniform(0, 8) for y, x in at], axis=0)
    for number, (y, x) in enumerate([at[0], at[1], (shape[0] - 1, at[2, 1]), (0, at[3, 1]), (at[4, 0], 0)], 20):
        labels[np.hypot(row - y, column - x) < 3.6] = number
    for number, (y, x) in enumerate(rng.integers(1, 60, (4, 2)), 30):
        labels[y, x] = number
    return labels


@pytest.mark.parametrize("seed", range(12))
def test_guess_is_the_solution_of_its_equations(seed: int):
    """A part's nearness is between its own cues and the weighted mean of its neighbours' with the cues between them."""
    parts = parts_of(regions(seed))
    labels, count, (rows, columns) = parts.labels, parts.count, parts.labels.shape
    pixels = [[(y, x) for y in range(rows) for x in range(columns) if labels[y, x] == each] for each in range(count)]
    rim = [*labels[0].tolist(), *labels[:, 0].tolist(), *labels[:, -1].tolist()]
    at_edge = {*rim, *labels[-1].tolist()}
    sides: dict[tuple[int, int], int] = {}
    for y, x in np.ndindex(rows, columns):
        for other in ((y + 1, x), (y, x + 1)):
            if other[0] < rows and other[1] < columns and labels[other] != labels[y, x]:
                pair = tuple(sorted((int(labels[y, x]), int(labels[other]))))
                sides[pair] = sides.get(pair, 0) + 1
    sure = dict(zip(sorted(sides), in_front(parts, neighbours(parts)).tolist(), strict=True))
    beside = {each: [pair for pair in sides if each in pair] for each in range(count)}

    matrix, right = np.zeros((count, count)), np.zeros(count)
    for each, own in enumerate(pixels):
        down = sorted((y for y, _ in own), reverse=True)
        foot, middle = (down[len(own) // 20] + 1) / rows, (sum(down) / len(own) + 0.5) / rows
        cues = guess_module.FOOT * foot + guess_module.MIDDLE * middle - guess_module.RIM * rim.count(each) / len(rim)
        cues -= guess_module.SIZE * len(own) / labels.size
        whole = sum(sides[pair] ** 0.5 for pair in beside[each])
        matrix[each, each], right[each] = 1 + guess_module.OWN, guess_module.OWN * cues
        for pair in beside[each]:
            (other,) = {*pair} - {each}
            nearer = guess_module.FRONT * sure[pair] * (1 if each == pair[1] else -1)
            for inner, sign in ((each, 1), (other, -1)):
                if len(beside[inner]) == 1 and inner not in at_edge:
                    nearer += sign * guess_module.ENCLOSED
            matrix[each, other] -= sides[pair] ** 0.5 / whole
            right[each] += sides[pair] ** 0.5 / whole * nearer
    nearness = np.linalg.solve(matrix, right)

    found = np.array(guess_heights(parts, 0.004).heights_m)
    large = [each for each in range(count) if len(pixels[each]) >= guess_module.SPECK * labels.size]
    assert len(large) < count, "there are specks"
    order = sorted(large, key=lambda each: nearness[each])
    expected = {each: 0.004 * rank / (len(large) - 1) for rank, each in enumerate(order)}
    gaps = np.diff(nearness[order])
    clear = [each for at, each in enumerate(order) if min([*gaps[max(0, at - 1) : at + 1]]) > 1e-6]
    assert len(clear) > 0.8 * len(large)
    assert found[clear] == pytest.approx([expected[each] for each in clear])
    for speck in {*range(count)} - {*large}:
        behind = [each for each in large if nearness[each] < nearness[speck]]
        assert found[speck] == pytest.approx(max([expected[each] for each in behind], default=0.0))


def wall(*joints: int, shape: tuple[int, int] = (80, 120)) -> np.ndarray:
    """Return a slab of 1 on bricks of 2, 3, ... with joints at these columns; the border is level and in the middle."""
    labels = np.ones(shape, np.int32)
    labels[shape[0] // 2 :] = 2 + np.searchsorted(joints, np.arange(shape[1]), side="right")
    return labels


def test_certainty_counts_the_junctions_whose_disc_is_within_the_picture():
    """The border of the slab runs straight on at each joint: n votes are sure by n / (1 + n). The radius is 2."""
    joints = (1, 20, 50, 90, 119)
    for turns in range(4):
        sure = sure_of(np.rot90(wall(*joints), turns))
        assert [sure[1, brick] for brick in range(2, 8)] == pytest.approx([0, -1 / 2, -2 / 3, -2 / 3, -1 / 2, 0])
        assert [sure[brick, brick + 1] for brick in range(2, 7)] == [0] * 5
        edge = sure_of(np.rot90(wall(2, 118), turns))
        assert [edge[1, brick] for brick in (2, 3, 4)] == pytest.approx([-1 / 2, -2 / 3, -1 / 2])


@pytest.mark.parametrize(("rows", "steps"), [(40, 3), (41, 2)])
def test_a_thousandth_of_the_picture_takes_a_step_and_less_does_not(rows: int, steps: int):
    labels = np.zeros((rows, 25), np.int32)
    labels[rows // 2 :], labels[rows - 4, 12] = 1, 2
    assert len({*guess(labels).values()}) == steps


def test_certainty_falls_with_the_angle_of_the_border():
    row, column = np.indices((400, 400)) - 199.5
    for degrees in (0, 10, 20, -10, -20, 40):
        bent = np.where(column > 0, row > column * np.tan(np.radians(degrees)), row > 0)
        labels = np.where(bent, 2 + (column > 0), 1)
        expected = max(0.0, 1 - abs(degrees) / 360 / neighbours_module.STRAIGHT)
        assert -sure_of(labels)[1, 2] == pytest.approx(expected / (1 + expected), abs=0.06)

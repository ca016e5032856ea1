"""Heights guessed from size, place and border ownership."""

import numpy as np
import pytest
from scipy.stats import spearmanr

from drawn_parts import drawn
from tangible_core.data import PartMap, SegmentMap
from tangible_core.parts import find_parts, guess_heights
from tangible_core.parts import guess as guess_module
from tangible_core.parts import neighbours as neighbours_module
from tangible_core.parts.neighbours import in_front, neighbours
from tangible_core.scene.scene import Scene


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


def test_neighbours_are_listed_with_the_lengths_of_their_borders():
    pairs = neighbours(parts_of([[0, 0, 1], [0, 2, 1], [3, 3, 3]]))
    assert list(zip(*(each.tolist() for each in pairs), strict=True)) == [
        (0, 1, 1), (0, 2, 2), (0, 3, 1), (1, 2, 1), (1, 3, 1), (2, 3, 1),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("first", "second"), [((120, 100), (170, 100)), ((170, 90), (120, 110)), ((150, 130), (150, 80))]
)
def test_disc_whose_border_runs_on_is_in_front(first, second):
    labels = discs(first, second)
    assert sure_of(labels)[1, 2] > 0.4
    heights_m = guess(labels)
    assert heights_m[0] < heights_m[1] < heights_m[2]


def test_symmetric_junctions_decide_nothing():
    """Judge three parts that meet at equal angles, and four that meet in a cross."""
    row, column = np.indices((120, 120)) - 59.5
    thirds = ((np.arctan2(row, column) + np.pi) / (2 * np.pi / 3)).astype(int)
    assert max(map(abs, sure_of(thirds).values())) < 0.2
    assert not any(sure_of((row > 0) + 2 * (column > 0)).values())


def test_low_part_is_near_and_part_at_the_rims_is_far():
    labels = np.zeros((120, 160), np.int32)
    labels[90:110, 20:60] = 1
    labels[20:40, 80:120] = 2
    heights_m = guess(labels)
    assert heights_m[0] == 0
    assert heights_m[2] < heights_m[1] == 0.004


def test_enclosed_part_is_in_front():
    labels = discs((150, 100), radius=60)
    labels[60:75, 140:160] = 2
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


def test_two_parts_that_one_encloses_are_not_holes_in_it():
    labels = discs((80, 100), (220, 100))
    picture = np.uint8([[150, 180, 230], [30, 30, 30], [32, 30, 30]])[labels]
    parts = parts_of(labels)
    heights_m = guess_heights(parts, 0.004, picture).heights_m
    assert heights_m[0] == 0 < min(heights_m[1:])


def test_guess_does_not_depend_on_the_resolution():
    few = guess_heights(drawn("coffee").parts, 0.004)
    labels = drawn("coffee").parts.labels.repeat(2, axis=0).repeat(2, axis=1)  # large enough to be reduced again
    assert guess_heights(parts_of(labels), 0.004) == few


def test_specks_take_no_height_step():
    labels = discs((120, 100), (170, 100))
    with_specks = labels.copy()
    with_specks[::20, ::20] = 3
    plain, speckled = guess(labels), guess(with_specks)
    assert {label: speckled[label] for label in plain} == pytest.approx(plain)


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
    """A part's nearness is between its own cues and the weighted mean of its neighbours' with the cues between them.

    Each cue is counted pixel by pixel, and the equations are solved at once. What nearly ties has no order.
    """
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


def test_three_parts_meet_at_each_corner_with_three_labels():
    labels = np.random.default_rng(0).integers(0, 4, (40, 60)).astype(np.int32)
    expected = [[len({*labels[y : y + 2, x : x + 2].ravel().tolist()}) == 3 for x in range(59)] for y in range(39)]
    assert neighbours_module._three_meet(labels).tolist() == expected


@pytest.mark.parametrize(("rows", "steps"), [(40, 3), (41, 2)])
def test_a_thousandth_of_the_picture_takes_a_step_and_less_does_not(rows: int, steps: int):
    labels = np.zeros((rows, 25), np.int32)
    labels[rows // 2 :], labels[rows - 4, 12] = 1, 2
    assert len({*guess(labels).values()}) == steps


def test_hole_of_one_pixel_has_its_colour():
    labels = np.zeros((20, 30), np.int32)
    labels[8:18, 8:22], labels[12, 15] = 1, 2
    picture = np.uint8([[70, 95, 150], [50, 40, 30], [70, 95, 150]])[labels]
    assert "; it is behind part 2" in guess_heights(parts_of(labels), 0.004, picture).reasons[2]


def test_many_junctions_are_thinned_evenly(monkeypatch: pytest.MonkeyPatch):
    """Of seven junctions, three may be examined: every third of them is."""
    monkeypatch.setattr(neighbours_module, "MOST_JUNCTIONS", 3)
    sure = sure_of(wall(*range(15, 120, 15)))
    assert [sure[1, brick] for brick in range(2, 10)] == pytest.approx(
        [-1 / 2, -1 / 2, 0, -1 / 2, -1 / 2, 0, -1 / 2, -1 / 2]
    )


def test_certainty_falls_with_the_angle_of_the_border():
    """A border that bends at the junction: its part has so much more or less than a half of the disc."""
    row, column = np.indices((400, 400)) - 199.5
    for degrees in (0, 10, 20, -10, -20, 40):
        bent = np.where(column > 0, row > column * np.tan(np.radians(degrees)), row > 0)
        labels = np.where(bent, 2 + (column > 0), 1)
        expected = max(0.0, 1 - abs(degrees) / 360 / neighbours_module.STRAIGHT)
        assert -sure_of(labels)[1, 2] == pytest.approx(expected / (1 + expected), abs=0.06)


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (7, 1), (300, 2)])
def test_guess_of_a_single_part_is_zero(shape):
    assert guess_heights(parts_of(np.zeros(shape)), 0.004).heights_m == (0,)


def test_guess_takes_a_part_for_every_pixel():
    heights = guess_heights(parts_of(np.arange(30 * 40).reshape(30, 40)), 0.004)
    assert len(heights.heights_m) == len(heights.reasons) == 1200
    assert (min(heights.heights_m), max(heights.heights_m)) == (0, 0.004)


def test_reasons_name_the_place_of_a_part_and_what_it_hides():
    heights = guess_heights(parts_of(discs((120, 100), (170, 100))), 0.004)
    assert heights.reasons == (
        "guessed, 1 of 3 from the back: it reaches down to 96 % of the picture's height and has 100 % of its upper and "
        "side rims; it is behind part 3",
        "guessed, 2 of 3 from the back: it reaches down to 68 % of the picture's height and has 0 % of its upper and "
        "side rims; it is behind part 3",
        "guessed, 3 of 3 from the back: it reaches down to 66 % of the picture's height and has 0 % of its upper and "
        "side rims; it is in front of parts 1 and 2",
    )


@pytest.mark.parametrize(("name", "least"), [("astronaut", 0.8), ("coffee", 0.8)])
def test_guess_is_near_the_heights_that_a_person_gave(name, least):
    _, parts, _, heights_m = drawn(name)
    guess = np.float32(guess_heights(parts, 0.004).heights_m)[parts.labels]
    assert spearmanr(guess.ravel(), np.float32(heights_m)[parts.labels].ravel())[0] > least


def test_guess_has_about_the_order_of_true_depth():
    parts, truth = drawn("motorcycle").parts, Scene.builtin("motorcycle").truth
    assert truth is not None
    guess = np.float32(guess_heights(parts, 0.004).heights_m)[parts.labels]
    known = np.isfinite(truth)
    assert spearmanr(guess[known], truth[known])[0] > 0.68

"""Single checks: if a case fails, a verdict has a false value, place or cure."""

from collections.abc import Sequence
from math import log

import numpy as np
import pytest

from tangible_core.data import MaterialMap, PartMap, Relief
from tangible_core.materials.assignment import library
from tangible_core.preflight import Verdict
from tangible_legibility import PROFILES
from tangible_legibility.checks import gap, materials, part, shape, steps
from tangible_legibility.legibility_input import LegibilityInput

PITCH_M = 0.00025


def given(
    labels: np.ndarray,
    medium: str = "print",
    *,
    heights_m: Sequence[float] | None = None,
    names: Sequence[str] = (),
    of: Sequence[str] = (),
) -> LegibilityInput:
    """Return parts with a height each, and a material of the library each; cells are quarters of a millimetre."""
    rows, columns = labels.shape
    extent_m = (PITCH_M * columns, PITCH_M * rows)
    relief = None if heights_m is None else Relief(np.float32(heights_m)[labels], extent_m)
    made_of = MaterialMap(tuple(library()[each] for each in of), ("",) * len(of)) if of else None
    divided = PartMap(labels.astype(np.int32), tuple(range(int(labels.max()) + 1)))
    return LegibilityInput(PROFILES[medium], divided, PITCH_M, extent_m[0], relief, made_of, names, None)


def stripes(*columns: int, rows: int = 80) -> np.ndarray:
    return np.repeat(np.arange(len(columns)), columns)[None].repeat(rows, 0)


def told(verdicts: Sequence[Verdict]) -> list[tuple[str, str, str, str]]:
    return [(verdict.check, verdict.verdict, verdict.of, verdict.says) for verdict in verdicts]


def test_steps_of_pairs_have_their_place_and_what_is_lacking():
    """Steps of 0.25, 0.65 and 2 mm between four stripes of 20 mm, of which all but the first have a name."""
    data = given(stripes(*[80] * 4), heights_m=[0.001, 0.00125, 0.0019, 0.0039], names=["", "sea", "shore", "sky"])
    step, named, unfelt = found = list(steps(data))
    assert told(found) == [
        (
            *("step", "illegible", "part 2 (sea) next to part 1, on the left, halfway down"),
            "part 2 (sea) next to part 1 is hardly higher or lower than it on the left, halfway down",
        ),
        (
            *("named step", "warn", "part 3 (shore) next to part 2 (sea), in the middle"),
            "part 3 (shore) next to part 2 (sea) is not much higher or lower than it in the middle",
        ),
        ("unfelt borders", "warn", "the borders of parts", "the borders of parts are partly not felt as steps"),
    ]
    assert (step.value, named.value, unfelt.value) == pytest.approx((0.00025, 0.00065, 1 / 3), rel=1e-4)
    assert step.at == ((pytest.approx(0.25, abs=0.002), pytest.approx(0.5, abs=0.01)),)
    assert step.cure == "make one of them 0.3 mm higher (`height_m` under `parts:`, with `heights:`)"
    assert named.cure.startswith("make one of them 0.4 mm higher")
    assert unfelt.changes == () and unfelt.cure.startswith("make the relief of parts (`heights: {by: given}`)")


@pytest.mark.parametrize(("rows", "judged"), [(12, False), (13, True)])
def test_borders_no_longer_than_a_gap_are_not_judged(rows: int, judged: bool):
    """3.2 mm are 12.8 sides of cells."""
    labels = stripes(80, 80)
    labels[rows:] = 2
    of = {"heights_m": [0.001, 0.0012, 0.01], "of": ["wood", "wood", "ice"]}
    (step, *_), (same, *_) = steps(given(labels, **of)), materials(given(labels, "force", **of))
    found = [(each.verdict, each.of.startswith("part 2 next to part 1")) for each in (step, same)]
    assert found == [("illegible", True) if judged else ("ok", False)] * 2


def test_the_worst_of_many_pairs_have_a_verdict_each_and_the_others_one():
    """Ten stripes, each a little higher than the one before, by 0.1 mm and by ever a hundredth more."""
    heights_m = np.cumsum([0.001, *(0.0001 + 0.00001 * ((7 * n) % 9) for n in range(9))])
    found = [step for step in steps(given(stripes(*[40] * 10), heights_m=heights_m)) if step.check == "step"]
    assert [each.value for each in found] == pytest.approx([0.0001, 0.00011, 0.00012, 0.00013, 0.00014], rel=1e-3)
    assert [each.of.split(",")[0] for each in found[:2]] == ["part 2 next to part 1", "part 6 next to part 5"]
    assert (found[-1].of, found[-1].says) == (
        "5 more pairs of neighbours",
        "5 more pairs of neighbours are of hardly another height",
    )
    assert len(found[-1].at) == 5
    five = [step for step in steps(given(stripes(*[40] * 6), heights_m=heights_m[:6])) if step.check == "step"]
    assert len(five) == 5 and "more" not in five[-1].of


def test_materials_of_level_neighbours_are_compared_and_the_least_apart_is_said():
    plain, ice = library()["plain"], library()["ice"]
    data = given(stripes(*[80] * 3), "force", heights_m=[0.001] * 3, of=["wood", "wood", "rubber"])
    (same,) = materials(data)
    assert (same.value, same.of) == (0.0, "part 2 next to part 1, on the left, halfway down")
    assert same.says == "part 2 next to part 1 is of nearly the same material and height on the left, halfway down"
    assert same.cure.startswith("give one of them another material (`material` under `parts:`)")
    (fine,) = materials(given(stripes(80, 80), "force", heights_m=[0.001] * 2, of=["plain", "ice"]))
    assert (fine.verdict, fine.of) == ("ok", "pairs of neighbours")
    assert fine.value == pytest.approx(abs(log(plain.stiffness_n_per_m / ice.stiffness_n_per_m)) / log(1.45))
    for height_m, verdict in ((0.00149, "illegible"), (0.00151, "ok")):
        (found,) = materials(given(stripes(80, 80), "force", heights_m=[0.001, height_m], of=["wood"] * 2))
        assert found.verdict == verdict


def test_narrow_and_small_parts_have_the_width_that_cures_them():
    """A stripe of 2.5 mm, and a square of 4 mm: the whole is 60 mm wide."""
    labels = stripes(110, 10, 120, rows=160)
    labels[20:36, 200:216] = 3
    data = given(labels, "swell", names=["", "mast", "", "moon"])
    (narrow,) = gap(data)
    assert narrow.of.startswith("part 2 (mast), ")
    assert narrow.says.startswith("part 2 (mast) is too narrow for a finger ")
    assert narrow.value == pytest.approx(0.0025, rel=1e-2)
    assert [(change.key, change.value, change.towards) for change in narrow.changes] == [
        ("simplify.gap_m", "0.0032", "at least"),
        ("workspace.width_m", "0.077", "at least"),
    ]
    small = list(part(data))
    assert [(each.of.split(",")[0], round(1000 * each.value, 1)) for each in small] == [
        ("part 2 (mast)", 2.5),
        ("part 4 (moon)", 4.0),
    ]
    assert [each.changes[1].value for each in small] == ["0.16", "0.096"]
    ((x, y),) = small[1].at
    assert (x, y) == (pytest.approx(208 / 240, abs=0.01), pytest.approx(28 / 160, abs=0.01))


@pytest.mark.parametrize(("side", "grade"), [(25, "none"), (26, "warn"), (50, "warn"), (51, "ok")])
def test_shape_of_a_part_that_holds_a_finger_needs_half_an_inch(side: int, grade: str):
    """From 6.4 mm, 25.6 cells, to 12.7 mm, 50.8 cells. A smaller one fails as a part, and has no shape to judge."""
    labels = np.zeros((160, 240), np.int64)
    labels[40 : 40 + 26, 60 : 60 + side] = 1
    (found,) = shape(given(labels, "swell"))
    if grade == "none":
        assert (found.verdict, found.value) == ("ok", pytest.approx(0.06))
    else:
        assert (found.verdict, found.value) == (grade, pytest.approx(side * PITCH_M))
    assert found.says.startswith("part 2 is so small that its shape is hard to recognise ") is (grade == "warn")


def test_a_width_of_more_than_two_metres_is_not_proposed():
    wide = LegibilityInput(PROFILES["swell"], given(stripes(110, 10, 120)).parts, 0.0001, 2.0, None, None, (), None)
    (narrow,) = gap(wide)
    assert [change.key for change in narrow.changes] == ["simplify.gap_m"]
    assert narrow.cure == "`simplify.gap_m: 0.0032`, or have fewer and larger parts"

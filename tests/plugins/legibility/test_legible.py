"""Verdicts by the rules of each medium: what passes and what fails, with its place, text and cure."""

import json
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from tangible_core.data import MaterialMap, PartMap, Relief, SegmentMap
from tangible_core.materials.assignment import library as shipped
from tangible_core.parts import find_parts
from tangible_export.braille import DOT_HEIGHT_M
from tangible_legibility import PROFILES, apart, legibility, sizes
from tangible_legibility.pins import PIN_PITCH_M
from tangible_legibility.rules import table

DOCS = Path(__file__).parents[3] / "docs"
PITCH_M = 1e-4


def two_parts(left: int = 300, right: int = 300, rows: int = 400) -> PartMap:
    """Return two parts side by side, in tenths of a millimetre."""
    labels = np.zeros((rows, left + right), np.int32)
    labels[:, left:] = 1
    return PartMap(labels, (0, 1))


def width_m(parts: PartMap) -> float:
    return PITCH_M * parts.labels.shape[1]


def relief_of(parts: PartMap, *heights_m: float) -> Relief:
    rows, columns = parts.labels.shape
    return Relief(np.float32(heights_m)[parts.labels], (PITCH_M * columns, PITCH_M * rows))


def verdicts(medium, parts, **known) -> dict[str, list]:
    found: dict[str, list] = {}
    for each in legibility(medium, parts, width_m(parts), **known):
        found.setdefault(each.check, []).append(each)
    return found


def grades(medium, parts, **known) -> dict[str, str]:
    return {check: found[0].verdict for check, found in verdicts(medium, parts, **known).items()}


def test_legibility_two_large_parts_pass_in_every_medium():
    parts = two_parts()
    relief = relief_of(parts, 0.001, 0.003)
    for medium in PROFILES:
        found = legibility(medium, parts, width_m(parts), relief=relief)
        assert found.grade == "ok", found
        assert found.sentence == "Legible: fingers can read it."


def test_verdict_has_part_place_bound_source_and_cure():
    labels = two_parts().labels.copy()
    labels[100:140, 100:140] = 2
    parts = PartMap(labels, (0, 1, 2))
    (small,) = verdicts("swell", parts, names=("", "", "moon"))["part"]
    assert (small.of, small.verdict, small.bound) == ("part 3 (moon), at the upper left", "illegible", 0.0064)
    assert small.value == pytest.approx(0.004, rel=3e-3)
    assert small.source == "tactilegraphics.org"
    assert small.says == "part 3 (moon) is smaller than a fingertip at the upper left"
    ((x, y),) = small.at
    assert 100 <= 600 * x <= 140
    assert 100 <= 400 * y <= 140
    assert [(each.key, each.setting) for each in small.changes] == [
        ("simplify.part_m", 0.0064),
        ("workspace.width_m", pytest.approx(0.1, abs=0.005)),
    ]
    data = json.loads(json.dumps(legibility("swell", parts, width_m(parts)).as_data()))
    assert data["readable"] is False
    assert next(each for each in data["verdicts"] if each["verdict"] != "ok")["at"] == [[x, y]]


def test_legibility_width_of_the_cure_passes():
    labels = two_parts().labels.copy()
    labels[150:250, 60:110] = 2
    parts = PartMap(labels, (0, 1, 2))
    found = legibility("swell", parts, width_m(parts))
    (wrong,) = [each for each in found if each.verdict == "illegible"]
    wider = next(each.setting for each in wrong.changes if each.key == "workspace.width_m")
    assert legibility("swell", parts, wider).readable
    assert not legibility("swell", parts, 0.97 * wider).readable


def test_legibility_many_failures_share_a_verdict():
    tiles = np.arange(10_000, dtype=np.int32).reshape(100, 100)
    parts = find_parts(SegmentMap(tiles.repeat(8, 0).repeat(8, 1)))
    found = legibility("swell", parts, 0.16)
    assert len(found) <= 20
    small = [each for each in found if each.check == "part"]
    assert small[-1].of == "9996 more parts"
    assert small[-1].says == "9996 more parts are smaller than a fingertip"
    assert 1 < len(small[-1].at) <= 64


def test_legibility_one_part_or_none_fails():
    one = PartMap(np.zeros((200, 300), np.int32), (0,))
    assert grades("swell", one)["parts"] == "illegible"
    assert legibility("swell", None, 0.1).grade == "illegible"
    assert legibility("print", None, 0.1, relief=relief_of(two_parts(), 0, 0.004)).grade == "warn"
    assert legibility("print", None, 0.1, relief=relief_of(two_parts(), 0.004, 0.004)).grade == "illegible"


@pytest.mark.parametrize("medium", PROFILES)
def test_legibility_one_pixel_has_verdicts(medium):
    relief = Relief(np.zeros((1, 1), np.float32), (0.1, 0.1))
    assert legibility(medium, PartMap(np.zeros((1, 1), np.int32), (0,)), 0.1, relief=relief).grade == "illegible"


def test_textures_named_parts_are_not_counted():
    parts = PartMap(np.repeat(np.arange(7), 100)[None].repeat(300, 0).astype(np.int32), tuple(range(7)))
    (found,) = verdicts("swell", parts)["textures"]
    assert (found.verdict, found.value, found.changes[0].setting) == ("illegible", 7, 5)
    assert grades("swell", parts, names=("", "", "", "", "", "a", "b"))["textures"] == "ok"
    assert grades("swell", parts, textures=3)["textures"] == "ok"
    assert grades("swell", parts, textures=6, names=tuple("abcdefg"))["textures"] == "illegible"


@pytest.mark.parametrize(
    ("step_m", "grade", "named"), [(0.0004, "illegible", "ok"), (0.0007, "ok", "warn"), (0.0012, "ok", "ok")]
)
def test_step_bounds_of_a_print_with_and_without_names(step_m, grade, named):
    parts = two_parts()
    found = grades("print", parts, relief=relief_of(parts, 0.002 + step_m, 0.002), names=("sea", "shore"))
    assert (found["step"], found["named step"]) == (grade, named)


def test_step_is_measured_at_the_border_on_any_grid():
    parts = two_parts()
    x = np.linspace(0, 1, 211, dtype=np.float32)
    heights = np.where(x < 0.5, np.float32(0.003) * x, np.float32(0.0015) + np.float32(0.0008))
    relief = Relief(np.broadcast_to(heights, (97, 211)).copy(), (0.06, 0.04))
    (found,) = verdicts("print", parts, relief=relief)["step"]
    assert found.value == pytest.approx(0.0008, abs=1e-4)


def test_print_flat_relief_fails():
    parts = two_parts()
    found = verdicts("print", parts, relief=relief_of(parts, 0.002, 0.002))
    assert found["height"][0].verdict == "illegible"
    assert found["unfelt borders"][0].verdict == "warn"
    assert found["unfelt borders"][0].value == 1


def test_materials_neighbours_must_differ_in_material_or_height():
    parts, library = two_parts(), shipped()
    wood, rubber = library["wood"], library["rubber"]
    same, other = (MaterialMap((wood, each), ("", "")) for each in (wood, rubber))
    flat, stepped = relief_of(parts, 0.002, 0.002), relief_of(parts, 0.002, 0.003)
    assert grades("force", parts, materials=same, relief=flat)["materials"] == "illegible"
    assert grades("force", parts, materials=other, relief=flat)["materials"] == "ok"
    assert grades("force", parts, materials=same, relief=stepped)["materials"] == "ok"
    assert grades("force", parts, materials=same)["materials"] == "illegible"


def test_materials_one_a_segment_are_used_for_its_parts():
    labels = np.repeat(np.arange(3), 150)[None].repeat(300, 0).astype(np.int32)
    parts, library = PartMap(labels, (0, 1, 0)), shipped()
    materials = MaterialMap((library["wood"], library["glass"]), ("", ""))
    assert grades("force", parts, materials=materials)["materials"] == "ok"


def test_apart_shipped_materials_differ_in_their_largest_difference():
    library = shipped()
    least = min((apart(library[a], library[b]), a, b) for a, b in combinations(library, 2))
    assert least == (pytest.approx(np.log(1400 / 800) / np.log(1.45)), "plain", "ice")
    assert apart(library["leather"], library["rubber"]) == pytest.approx(2.3, abs=0.1)
    wood = library["wood"]
    assert apart(wood, wood) == 0
    assert apart(wood, library["ice"]) == apart(library["ice"], wood)


def test_pins_part_of_one_pin_and_hidden_borders_fail():
    pin = round(PIN_PITCH_M / PITCH_M)
    labels = np.zeros((20 * pin, 40 * pin), np.int32)
    labels[:, 20 * pin :] = 1
    assert grades("pins", PartMap(labels, (0, 1))) == {"parts": "ok", "pins": "ok", "kept borders": "ok"}
    labels[pin : 2 * pin, pin : 2 * pin] = 2
    (few,) = verdicts("pins", PartMap(labels, (0, 1, 2)), names=("", "", "star"))["pins"]
    assert (few.value, few.of) == (1, "part 3 (star), at the upper left")
    labels[:, 10 * pin : 10 * pin + pin // 5] = 2
    assert grades("pins", PartMap(labels, (0, 1, 2)))["kept borders"] == "illegible"


def test_sizes_of_an_exporter_are_checked_by_the_same_rules():
    assert sizes("print", base=0.0015, line=0.0011, braille_height=DOT_HEIGHT_M).grade == "ok"
    assert [each.check for each in sizes("print", base=0.0005, line=0.002) if each.verdict == "illegible"] == ["base"]


def test_table_of_rules_is_on_the_page():
    assert table() in (DOCS / "legibility.md").read_text(encoding="utf-8")


def test_rules_have_a_source_or_are_our_convention():
    rules = [rule for profile in PROFILES.values() for rule in profile.rules.values()]
    assert all(rule.citation and rule.bound > 0 for rule in rules)
    assert all(check == rule.check for profile in PROFILES.values() for check, rule in profile.rules.items())

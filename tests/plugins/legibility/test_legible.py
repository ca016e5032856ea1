"""Verdicts by the rules of each medium: if a case fails, a person prints what fingers cannot read."""

import json

import numpy as np
import pytest

from tangible_core.data import PartMap, Relief
from tangible_export.braille import DOT_HEIGHT_M
from tangible_legibility import legibility, sizes
from tangible_legibility.neighbours import PIN_PITCH_M

PITCH_M = 1e-4
ROUND_TABLE = "Round Table on Information Access for People with Print Disabilities"


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
    assert [(change.key, change.setting) for change in small.changes] == [
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
    wider = next(change.setting for change in wrong.changes if change.key == "workspace.width_m")
    assert legibility("swell", parts, wider).readable
    assert not legibility("swell", parts, 0.97 * wider).readable


def test_legibility_one_part_or_none_fails():
    one = PartMap(np.zeros((200, 300), np.int32), (0,))
    assert grades("swell", one)["parts"] == "illegible"
    assert legibility("swell", None, 0.1).grade == "illegible"
    assert legibility("print", None, 0.1, relief=relief_of(two_parts(), 0, 0.004)).grade == "warn"
    assert legibility("print", None, 0.1, relief=relief_of(two_parts(), 0.004, 0.004)).grade == "illegible"


def test_textures_named_parts_are_not_counted():
    parts = PartMap(np.repeat(np.arange(7), 100)[None].repeat(300, 0).astype(np.int32), tuple(range(7)))
    (found,) = verdicts("swell", parts)["textures"]
    assert (found.verdict, found.value, found.changes[0].setting) == ("illegible", 7, 5)
    assert grades("swell", parts, names=("", "", "", "", "", "a", "b"))["textures"] == "ok"
    assert grades("swell", parts, textures=3)["textures"] == "ok"
    assert grades("swell", parts, textures=6, names=tuple("abcdefg"))["textures"] == "illegible"


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


def test_source_of_a_bound_says_when_it_is_a_convention_of_ours():
    finger = "a convention of ours, as on swell paper"
    for medium, part, gap in (
        ("swell", "tactilegraphics.org", "tactilegraphics.org, which advises 6.4 mm on capsule paper"),
        ("print", finger, f"{finger}; {ROUND_TABLE}: 2 mm in a double line, 5 mm between lines"),
        ("force", *[finger + ", though a tip is finer than a finger"] * 2),
    ):
        found = verdicts(medium, two_parts())
        assert (found["part"][0].source, found["gap"][0].source) == (part, gap)


def test_sizes_of_an_exporter_are_checked_by_the_same_rules():
    assert sizes("print", base=0.0015, line=0.0011, braille_height=DOT_HEIGHT_M).grade == "ok"
    assert [size.check for size in sizes("print", base=0.0005, line=0.002) if size.verdict == "illegible"] == ["base"]

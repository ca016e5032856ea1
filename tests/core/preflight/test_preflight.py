"""All verdicts together. Otherwise one cure would undo another, or an unsafe surface be called safe."""

import json
import math
from pathlib import Path

import pytest

from tangible_core.pipeline.config.editing import edit_text
from tangible_core.preflight import Preflight, Verdict
from tangible_core.preflight.verdict import Change, check_bound

RELIEF = "workspace.relief_m"


def low(value: str, worse: str = "warn") -> Verdict:
    """Return a verdict whose cure is a lower relief."""
    cure = [Change(RELIEF, value, "at most"), ", or press less"]
    return check_bound(
        "slope", "a wall", 2.0, "<=", 1.0, "share", "", cure=cure, says=f"it is over {value}", worse=worse
    )


def high(value: str) -> Verdict:
    return check_bound(
        "features", "3 mm wide", 1.0, ">=", 2.0, "m", "", cure=[Change(RELIEF, value, "at least")], says="too low"
    )


OK = check_bound("stiffness", "the law", 1.0, "<=", 2.0, "N/m", "", cure="softer", says="too stiff")


@pytest.mark.parametrize(
    ("verdicts", "sentence", "grade"),
    [
        ([OK], "Safe: nothing is wrong.", "ok"),
        ([OK, low("0.01")], "Safe, but it is over 0.01.", "warn"),
        ([low("0.01"), low("0.02")], "Safe, but it is over 0.01 and it is over 0.02.", "warn"),
        ([low("0.01"), low("0.02", "unsafe"), OK], "Unsafe, because it is over 0.02.", "unsafe"),
        ([low("0.01")] * 3 + [low("0.02")], "Safe, but it is over 0.01 and it is over 0.02.", "warn"),
        (
            [low(f"0.0{n}") for n in range(1, 6)],
            "Safe, but it is over 0.01, it is over 0.02, it is over 0.03 and 2 more things.",
            "warn",
        ),
    ],
)
def test_sentence_summarises_the_worst_verdicts(verdicts: list[Verdict], sentence: str, grade: str):
    found = Preflight.of(verdicts)
    assert (found.sentence, found.grade, found.safe) == (sentence, grade, grade != "unsafe")
    assert repr(found).splitlines()[0] == sentence
    assert len(repr(found).splitlines()) == 1 + sum(verdict.verdict != "ok" for verdict in verdicts)


def test_cures_of_one_key_get_the_strictest_value():
    found = Preflight.of([low("0.01"), low("0.0021"), low("0.014")])
    assert {each.cure for each in found} == {"`workspace.relief_m: 0.0021`, or press less"}
    assert {change.value for each in found for change in each.changes} == {"0.0021"}


def test_cure_that_undoes_a_worse_one_is_left_out():
    one, other = Preflight.of([high("0.02"), low("0.01", "unsafe")])
    assert one.changes == ()
    assert one.cure == "(not by `workspace.relief_m`, which another check wants at most 0.01)"
    assert other.cure.startswith("`workspace.relief_m: 0.01`")


def test_as_data_has_all_fields_and_applicable_changes():
    fit = check_bound(
        *("textures", "brick", math.inf, "<=", 1.0, "N/m", "here"),
        cure=[Change("materials.fit", "device", "is"), "; or ", Change(RELIEF, "0.0012", "at most")],
        says="brick buzzes",
        worse="unsafe",
    )
    said = json.loads(json.dumps(Preflight.of([fit, OK]).as_data(), allow_nan=False))
    assert (said["grade"], said["safe"], said["sentence"]) == ("unsafe", False, "Unsafe, because brick buzzes.")
    wrong, fine = said["verdicts"]
    assert (wrong["verdict"], wrong["check"], wrong["of"], wrong["says"]) == (
        "unsafe", "textures", "brick", "brick buzzes",
    )  # fmt: skip
    assert (wrong["value"], wrong["bound"], wrong["stands"]) == (None, 1.0, "inf N/m > 1 N/m")
    assert wrong["changes"] == [
        {"key": "materials.fit", "value": "device", "towards": "is"},
        {"key": RELIEF, "value": 0.0012, "towards": "at most"},
    ]
    assert (fine["changes"], fine["cure"], fine["stands"]) == ([], "", "1 N/m <= 2 N/m")
    text = "scene: builtin/brick\nmaterials: {by: rules}  # mine\nworkspace: {relief_m: 4 mm}\n"
    cured = edit_text(text, Path("p.yaml"), {each["key"]: each["value"] for each in wrong["changes"]})
    assert cured == text.replace("rules}", "rules, fit: device}").replace("4 mm", "1.2 mm")

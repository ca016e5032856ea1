"""Messages with foreign text: printable and short."""

import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.errors import (
    MAX_IN_LINE,
    MAX_LINES,
    MAX_QUOTED,
    Complaint,
    ConfigError,
    TangibleError,
    UnknownMethod,
    check_positive,
    did_you_mean,
    quoted,
    shown,
)


@given(st.lists(st.text(st.characters(), max_size=2000), max_size=50))
def test_complaint_of_any_text_is_one_printable_line(complaints: list[str]):
    lines = str(TangibleError(*complaints)).split("\n")
    assert all(line.isprintable() and len(line) <= MAX_IN_LINE for line in lines)
    assert len(lines) == min(max(1, len(complaints)), MAX_LINES + (len(complaints) > MAX_LINES))


def test_message_has_plain_text_or_the_first_of_many_complaints():
    assert str(ConfigError("a.yaml:1:1: wörong", "a.yaml:2:1: again")) == "a.yaml:1:1: wörong\na.yaml:2:1: again"
    lines = str(ConfigError(*map(str, range(MAX_LINES + 7)))).splitlines()
    assert lines == [*map(str, range(MAX_LINES)), "and 7 more"]


def test_text_is_escaped_and_keeps_its_length_and_both_ends():
    assert str(TangibleError("a\x1b[31m\r\nb\u2028\u202e\udcff")) == r"a\x1b[31m\r\nb\u2028\u202e\udcff"
    line = str(TangibleError("the place: " + "x" * 10_000 + "; the cure"))
    assert len(line) == MAX_IN_LINE
    assert line.startswith("the place: xxx")
    assert line.endswith("xxx; the cure")
    assert len(shown("\U000e0001" * 70)) == MAX_QUOTED


def test_pickled_errors_keep_their_message_and_places():
    error = ConfigError("a\x1b", "b")
    assert str(pickle.loads(pickle.dumps(error))) == str(error)
    error = ConfigError("p.yaml:3:1: a\x1b", complaints=[Complaint(("render", "use"), "a\x1b" * 999, 3, 1)])
    (complaint,) = pickle.loads(pickle.dumps(error)).complaints
    assert (complaint.location, complaint.line, complaint.column) == (("render", "use"), 3, 1)
    assert complaint.text.isprintable() and len(complaint.text) <= MAX_IN_LINE
    assert ConfigError("no place").complaints == (Complaint((), "no place"),)


LONG = ("x" * 10**6, 10**5000, -(10**5000), [[[[1] * 99] * 99] * 99] * 99, {"k": {"k": {"k": {"k": 1}}}}, b"x" * 999)


@pytest.mark.parametrize("value", LONG, ids=lambda each: type(each).__name__)
def test_quoted_value_of_any_size_is_short(value: object):
    assert len(quoted(value)) <= MAX_QUOTED


def test_long_words_and_quoted_values_are_told_in_short():
    from ruamel.yaml import YAML

    tree = YAML(typ="rt").load("{a: [1, 2.5, 'x', 0x1F], b: {c: yes}}")
    assert quoted(tree) == "{'a': [1, 2.5, 'x', 31], 'b': {'c': 'yes'}}"
    many = YAML(typ="rt").load("".join(f"k{number}: 1\n" for number in range(9)))
    assert quoted(many) == "{'k0': 1, 'k1': 1, 'k2': 1, 'k3': 1, ...}"
    assert quoted(YAML(typ="rt").load(f"[{', '.join('x' * 500)}]")) == "['x', 'x', 'x', 'x', 'x', 'x', ...]"
    assert did_you_mean("x" * 1000, ["x" * 1000]) == ""
    assert "'dep\\x1bth'" in did_you_mean("depth", ["dep\x1bth"])
    assert len(str(UnknownMethod("depth", "x" * 10_000, ["zncc"]))) < 200


@pytest.mark.parametrize("value", [0, -1.0, float("nan"), float("inf"), -float("inf")])
def test_check_positive_refuses_other_numbers(value: float):
    with pytest.raises(ConfigError, match=f"^seconds: is {value}; it must be positive and finite$"):
        check_positive("seconds", value)


@pytest.mark.parametrize("value", [5e-324, 1, 1.7e308])
def test_check_positive_accepts_positive_finite_numbers(value: float):
    check_positive("seconds", value)

"""The counts of words: each rule finds what it is there for, and leaves plain English alone."""

from pathlib import Path

import pytest

from benchmarks.house_words import PLAINER, is_bare_participle, opens_badly, turns_of_phrase

DIALECT = (
    "the page is told",
    "it is said twice",
    "the map is put right",
    "a wall is no spring",
    "it is none of its parts",
    "in colours of one's own",
    "a picture of so many pixels",
    "the page shows what is felt",
    "files are handed on",
    "the product that was asked for",
    "for whoever comes by",
)
PLAIN = (
    "parts are told apart by their names",
    "noise cannot be told from texture",
    "there is no file of this name",
    "the slope is no steeper than before",
    "the map is said to be dense",
)


@pytest.mark.parametrize("text", DIALECT)
def test_turn_of_phrase_is_found_once(text: str, tmp_path: Path):
    (tmp_path / "page.md").write_text(f"First line.\n{text}\n")
    (tmp_path / "module.py").write_text(f'def f():\n    raise ValueError("{text}")  # {text}\n')
    for name in ("page.md", "module.py"):
        assert [place.line for place in turns_of_phrase(tmp_path / name)] == [2]


def test_turns_of_phrase_each_have_an_example():
    assert len(DIALECT) == len(PLAINER)


@pytest.mark.parametrize("text", PLAIN)
def test_plain_text_has_no_turn_of_phrase(text: str, tmp_path: Path):
    (tmp_path / "page.md").write_text(text)
    assert not list(turns_of_phrase(tmp_path / "page.md"))


@pytest.mark.parametrize(("name", "found"), [("told", True), ("_filtered", True), ("read", False), ("notify", False)])
def test_bare_participle_is_told_from_a_verb(name: str, found: bool):
    assert is_bare_participle(name) is found


@pytest.mark.parametrize(("text", "found"), [("Of a part.", True), ("The width.", False), ("Return it.", False)])
def test_docstring_with_a_function_word_first_opens_badly(text: str, found: bool):
    assert opens_badly(text) is found

"""Words in every language: if a case fails, a text lacks a word or a value in one of them."""

import string
from collections import Counter

import pytest

from tangible_core.materials.assignment import library
from tangible_legibility.words.languages import LANGUAGES, TABLES, language_of, part_label


def placeholders(text: str) -> Counter[str]:
    return Counter(name for _, name, _, _ in string.Formatter().parse(text) if name is not None)


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_language_has_all_words_and_placeholders(language):
    english, table = TABLES["en"], TABLES[language]
    assert table.words.keys() == english.words.keys()
    for key, text in table.words.items():
        assert text.strip(), key
        assert placeholders(text) == placeholders(english.words[key]), key
    assert table.materials.keys() == library().keys()
    assert table.after_like.keys() in (set(), library().keys())


@pytest.mark.parametrize(
    ("tag", "language"), [("en", "en"), ("de-CH", "de"), ("DE", "de"), ("fr-CA", "fr"), ("pt", "en"), ("den", "en")]
)
def test_tag_selects_the_language_of_the_words(tag: str, language: str):
    assert language_of(tag) == language


def test_part_label_is_its_name_or_its_number():
    labels = part_label(" helmet\n"), part_label("a\tb\ud800"), part_label(0), part_label(3, "fr"), part_label(3, "pt")
    assert labels == ("helmet", "a b", "part 1", "partie 4", "part 4")

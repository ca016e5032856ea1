"""The catalogues: each has all that the program shows, and nothing else."""

import pytest

import catalogues
from tangible_core.translation.catalogue import catalogue
from tangible_legibility.words.languages import TABLES

HOW = (
    "run `python tests/helpers/catalogues.py`, and fill in the empty `msgstr` of "
    "tangible_core/translation/{language}.po (CONTRIBUTING.md, “Texts in other languages”)"
)


@pytest.mark.parametrize("language", catalogues.WHOLE)
def test_every_text_that_the_program_shows_is_translated(language: str) -> None:
    missing = list(catalogues.missing(language))
    assert not missing, HOW.format(language=language)


@pytest.mark.parametrize("language", ["de", "fr"])
def test_no_translation_is_of_a_text_that_is_gone(language: str) -> None:
    gone = list(catalogues.stale(language))
    assert not gone, f"these are in {language}.po alone: run `python tests/helpers/catalogues.py`"


@pytest.mark.parametrize("language", ["de", "fr"])
def test_translations_have_the_placeholders_of_their_texts(language: str) -> None:
    assert not list(catalogues.misfits(language))


@pytest.mark.parametrize("language", ["de", "fr"])
def test_places_are_called_as_in_descriptions(language: str) -> None:
    english, own = TABLES["en"].words, TABLES[language].words  # pyright: ignore[reportArgumentType]
    places = [key for key in english if len(key) == 3 and key[1] == " " and key != "- -"]
    assert len(places) == 15
    translated = catalogue(language)
    assert [translated(english[key]) for key in places] == [own[key] for key in places]


def test_a_new_text_is_missing_and_named() -> None:
    assert catalogues.normal("{path}: is {size} mm") == catalogues.normal("{file}: is {width_m} mm")
    assert catalogues.normal("{a} of {b}") != catalogues.normal("{b} of {c} mm")

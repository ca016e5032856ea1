"""The catalogues. Otherwise a text would stay English in a German program."""

import pytest

import catalogues

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

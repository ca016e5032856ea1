"""Text in braille, by liblouis and by our own tables: if a case fails, a blind reader reads other letters."""

import ctypes
import os
from collections.abc import Callable, Iterator

import pytest

from tangible_core.errors import BrailleError
from tangible_core.plugins.notes import collected
from tangible_export.braille import as_ascii, as_unicode, in_grade, translate, translation, written_by
from tangible_export.braille.latin import LANGUAGES, LETTERS, read_code, translate_by_table
from tangible_export.braille.louis import CONTRACTED, TABLES, Louis, louis

ORDINARY = {
    "en": (
        "Astronaut", "The space shuttle (1990), 160 by 90 mm.", "part 3", "Is it high? Yes!", "5 % of A4; 2.5 mm",
        "3a 12k 4J", "NASA", "HMS Victory", "MacDonald", "ABCdef", "THE BIG RED CAR", "the THE BIG RED CAR is",
        "1 000 000", "it's", '"Hi", he said', "Café, Łódź, ærø, Málaga, Besançon, São, Åbo, Straße, naïve",
        "a/b + c = d & e", "well-known: yes", "At 45°",
        "98 \u00d7 74 cm", "Untitled #3 [detail] — © 1990", "~5 m², ±1 < 2 > 1", "9½ Weeks", "¿Dónde?",
        "ABcd", "AB cd", '("Hi")', 'a " b', '["x"]',
    ),
    "de": (
        "Überfluß, Äpfel, Öl", "Teil 3", "Der Raumanzug (1990), 160 mal 90 mm.", "5 % von A4; 2,5 mm",
        "Ist es hoch? Ja!", "3a 12k 4J 5B", "NASA-Foto", "z. B. um 5:", '"Hallo", sagte er', "„Hallo“", "»5«", '("ja")',
        "Café, Besançon, Ærø, Łódź", "a/b + c = d", "(5)", "45°",
        "Ohne Titel [Ausschnitt]", "Nr. #3", "5 m²", "Brâncuși",
    ),
    "fr": (
        "Nature morte aux pommes", "partie 3", "Le casque (1990), 160 sur 90 mm.", "5 % de A4 ; 2,5 mm : oui",
        "Où ? Là !", "3e 12 B", "« L\u2019été à Besançon »", "Œuvre, cœur, Noël, île, août, maïs, Curaçao, ex æquo",
        "NASA", "ABCdef", "(15 %)", "12-15, 3/4", '"oui"', "peut-être", "Düsseldorf & Köln", "45°",
        "98 \u00d7 74 cm", "Sans titre [détail] — © 1990", "n° #3", "5 m²", "1 ± 2 < 3", "Joan Miró, España, Århus",
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def installed() -> Louis:
    """Liblouis, which is there on the machine of CI."""
    library = louis()
    if isinstance(library, str):
        pytest.fail(library) if os.environ.get("CI") else pytest.skip(library)
    return library


@pytest.fixture
def without(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[object], None]]:
    """Has something else in place of liblouis, or an error where it is looked for."""

    def replace(library: object) -> None:
        def load(name: str) -> object:
            if isinstance(library, Exception):
                raise library
            return library

        louis.cache_clear()
        monkeypatch.setattr(ctypes, "CDLL", load)

    yield replace
    louis.cache_clear()


@pytest.mark.parametrize("language", ORDINARY)
def test_liblouis_and_our_tables_agree_on_texts(installed: Louis, language: str):
    for text in ORDINARY[language]:
        plain = translation._plain(text, language)
        assert as_unicode(translate(text, language)) == as_unicode(translate_by_table(plain, language)), text


def test_quotation_mark_between_spaces_closes():
    """More often a space was left before the closing mark than after the opening one."""
    assert as_unicode(translate_by_table('a " b', "de")) == "⠁⠀⠴⠀⠃"


@pytest.mark.parametrize("language", LANGUAGES)
def test_liblouis_and_our_tables_agree_on_every_letter_and_digit(installed: Louis, language: str):
    """Small and capital, within words; accents of all languages where theirs stand before the letter."""
    letters = [
        *LETTERS,
        *(sign for sign in read_code(language).signs if sign.isalpha() and sign.upper().lower() == sign),
        *("éèêñčōŭïåç" if read_code(language).marks else ""),
    ]
    for word in (word for letter in letters for word in (f"a{letter}a", f"{letter.upper()}a", f"m{letter}")):
        if language == "en" and word[0] in "ÆŒ":  # liblouis repeats the sign of capitals within the ligature
            continue
        if language == "fr" and word[0] == "Ø":  # liblouis has another letter for the capital
            continue
        assert as_unicode(translate(word, language)) == as_unicode(translate_by_table(word, language)), word
    for number in (*range(120), 999, 1000, 1099):
        assert translate(str(number), language) == translate_by_table(str(number), language), number


@pytest.mark.parametrize(("language", "text", "braille"), [
    ("en", "Part 3", "⠠⠏⠁⠗⠞⠀⠼⠉"),
    ("en", "NASA 3b", "⠠⠠⠝⠁⠎⠁⠀⠼⠉⠰⠃"),
    ("de", "Süß 20,5", "⠎⠳⠮⠀⠼⠃⠚⠂⠑"),
    ("de", "3b", "⠼⠉⠠⠃"),
    ("fr", "Été 1990", "⠨⠿⠞⠿⠀⠠⠡⠪⠪⠼"),
    ("fr", "Où ?", "⠨⠕⠾⠢"),
    ("pt", "a", "⠁"),
])  # fmt: skip
def test_translation_matches_the_books_of_the_codes(
    without: Callable[[object], None], language: str, text: str, braille: str
):
    """With and without liblouis: digits of French are Antoine's, German marks no capitals."""
    assert as_unicode(translate(text, language)) == braille
    without(OSError("not found"))
    assert as_unicode(translate(text, language)) == braille


def test_written_by_names_the_translator(installed: Louis, without: Callable[[object], None]):
    assert written_by("de-AT") == written_by("DE") == f"liblouis {installed.version}, de-g0.utb"
    assert written_by("pt") == f"liblouis {installed.version}, en-ueb-g1.ctb, for want of one for 'pt'"
    without(OSError("not found"))
    assert written_by("de-AT") == "our own table of the German Basisschrift (liblouis is not installed)"


@pytest.mark.parametrize(
    ("text", "language", "braille"),
    [("the", "en", "⠮"), ("knowledge", "en", "⠅"), ("und", "de", "⠥"), ("b", "en", "⠃"), ("abc", "en", "⠁⠃⠉")],
)
def test_contracted_braille_is_that_of_the_codes(installed: Louis, text: str, language: str, braille: str):
    contracted = in_grade(language, 2)
    assert as_unicode(translate(text, contracted)) == braille and written_by(contracted).endswith(CONTRACTED[language])
    assert len(translate("quelque chose", in_grade("fr", 2))) < len(translate("quelque chose", in_grade("fr", 1)))


@pytest.mark.parametrize(
    ("library", "language", "says"),
    [
        (OSError("not found"), "de-AT", r"needs liblouis, and liblouis is not installed; install it .*{grade: 1}"),
        ("three calls", "en", r"cannot use its table en-ueb-g2.ctb; install all of its tables .*{grade: 1}"),
        (OSError("not found"), "pt", r"no contracted braille for 'pt'; there is for en, de and fr, or .*{grade: 1}"),
    ],
)
def test_contracted_braille_is_refused_with_the_cure(without, library: object, language: str, says: str):
    without(odd(works=len(TABLES)) if library == "three calls" else library)
    with pytest.raises(BrailleError, match=says):
        in_grade(language, 2)


def odd(size: int = 4, cells: tuple[int, ...] = (1, 3, 9), works: int = 10**9, unread: int = 0) -> object:
    """A library with liblouis's names that writes these cells whatever it is given, so many times."""

    class Library:
        def __init__(self) -> None:
            def version() -> bytes:
                return b"0.0"

            self.lou_version, self.left = version, works

        def lou_setLogLevel(self, level: int) -> None: ...

        def lou_charSize(self) -> int:
            return size

        def lou_translateString(self, table, source, read, target, written, form, spacing, mode) -> int:
            self.left -= 1
            target[: len(cells)] = cells
            written._obj.value = len(cells)
            read._obj.value -= unread
            return self.left >= 0

    return Library()


@pytest.mark.parametrize(
    ("library", "why"),
    [
        (ctypes.CDLL(None), "lou_version"),
        (odd(size=3), "its characters have 3 bytes"),
        (odd(cells=(7, 7)), "it writes abc as (7, 7)"),
        (odd(works=0), "cannot use its table en-ueb-g1.ctb"),
        (odd(unread=1), "cannot use its table en-ueb-g1.ctb"),
    ],
)
def test_broken_liblouis_is_not_used(without: Callable[[object], None], library: object, why: str):
    without(library)
    assert translate("abcd", "en") == translate_by_table("abcd", "en")
    assert why in written_by("en")


def test_liblouis_breaking_later_is_replaced_with_a_note(without: Callable[[object], None]):
    without(odd(works=len(TABLES)))
    with collected() as notes:
        assert translate("abcd", "en") == translate_by_table("abcd", "en")
    assert notes == ["braille by our own table: liblouis 0.0 cannot use its table en-ueb-g1.ctb"]


@pytest.mark.parametrize("there", [True, False])
@pytest.mark.parametrize(
    ("text", "language", "says"),
    [
        ("Tokyo 日本", "en", "'Tokyo 日本': character 7, '日' (U+65E5), is not in "),
        ("ale ł", "fr", "'ale ł': character 5, 'ł' (U+0142), is not in "),
        ("a\ud800", "en", r"'a\ud800': character 2, '\ud800' (U+D800), is not in any braille;"),
        ("a\u0378", "fr", r"'a\u0378': character 2, '\u0378' (U+0378), is not in any braille;"),
    ],
)
def test_translation_of_unknown_character_names_it(
    installed: Louis, without: Callable[[object], None], there: bool, text: str, language: str, says: str
):
    if not there:
        without(OSError("not found"))
    with pytest.raises(BrailleError) as raised:
        translate(text, language)
    assert str(raised.value).startswith(says)
    assert "; spell it with other letters" in str(raised.value)


def test_translation_unifies_spaces_and_composed_letters():
    assert translate("u\u0308\u00a0a\u00adb\tc", "de") == translate("ü ab c", "de")
    assert (translate("", "en"), translate(" ", "fr")) == ((), (0,))


def test_as_ascii_has_a_character_for_every_cell():
    cells = tuple(range(64))
    assert len(set(as_ascii(cells))) == 64
    assert as_ascii(translate("Hello, 12.", "en")) == ",HELLO1 #AB4"

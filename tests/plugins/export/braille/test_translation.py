"""Text in braille: by liblouis and by our own tables, which agree; and what neither can write."""

import ctypes
import os
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from threading import Barrier
from typing import Any

import pytest

from tangible_core.errors import BrailleError
from tangible_core.plugins.notes import collected
from tangible_export.braille import as_ascii, as_unicode, translate, translation, written_by
from tangible_export.braille.latin import LANGUAGES, LETTERS, code_of, translate_by_table
from tangible_export.braille.louis import TABLES, Louis, _units, louis

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


@pytest.mark.parametrize(("language", "text"), [(each, text) for each in ORDINARY for text in ORDINARY[each]])
def test_liblouis_and_our_tables_agree_on_texts(installed: Louis, language: str, text: str):
    plain = translation._plain(text, language)
    assert as_unicode(translate(text, language)) == as_unicode(translate_by_table(plain, language))


@pytest.mark.parametrize(("text", "braille"), [
    ("1 000", "⠼⠁⠐⠚⠚⠚"),
    ("1 0000", "⠼⠁⠀⠼⠚⠚⠚⠚"),
    ("12 345 6", "⠼⠁⠃⠐⠉⠙⠑⠀⠼⠋"),
    ("3 12", "⠼⠉⠀⠼⠁⠃"),
])  # fmt: skip
def test_groups_of_three_digits_alone_are_of_one_number(text: str, braille: str):
    """Liblouis takes any two numbers for one."""
    assert as_unicode(translate_by_table(text, "en")) == braille


@pytest.mark.parametrize("language", ["de", "fr"])
def test_groups_of_digits_are_numbers_of_their_own_where_no_sign_joins_them(language: str):
    first, second = (translate_by_table(number, language) for number in ("1", "000"))
    assert translate_by_table("1 000", language) == (*first, 0, *second)


def test_quotation_mark_between_spaces_closes():
    """More often a space was left before the closing mark than after the opening one."""
    assert as_unicode(translate_by_table('a " b', "de")) == "⠁⠀⠴⠀⠃"


@pytest.mark.parametrize("odd", ["\x07", "\ud800", "\ue000", "\U0010fffd", "\u0378"])
@pytest.mark.parametrize("language", LANGUAGES)
def test_character_that_nobody_can_read_is_refused_with_its_place(odd: str, language: str):
    """Control characters, halves of pairs, private ones and unassigned ones: whatever a table might have for them."""
    with pytest.raises(BrailleError, match=rf"character 3, .*\(U\+{ord(odd):04X}\), is not in any braille"):
        translate(f"ab{odd}c", language)


@pytest.mark.parametrize("language", LANGUAGES)
def test_letter_with_an_accent_that_the_code_lacks_is_refused(language: str):
    """A circumflex and a dot below."""
    with pytest.raises(BrailleError, match="character 2, 'ệ'"):
        translate_by_table("aệ", language)


def test_characters_beyond_two_bytes_are_written_in_two_units():
    assert _units("a", 2) == _units("a", 4) == [97]
    assert (_units("🙂", 2), _units("🙂", 4)) == ([0xD83D, 0xDE42], [0x1F642])


@pytest.mark.parametrize("language", LANGUAGES)
def test_liblouis_and_our_tables_agree_on_every_letter_and_digit(installed: Louis, language: str):
    """Small and capital, within words; accents of all languages where theirs stand before the letter."""
    letters = [
        *LETTERS,
        *(each for each in code_of(language).signs if each.isalpha() and each.upper().lower() == each),
        *("éèêñčōŭïåç" if code_of(language).marks else ""),
    ]
    for word in (word for each in letters for word in (f"a{each}a", f"{each.upper()}a", f"m{each}")):
        if language == "en" and word[0] in "ÆŒ":  # liblouis repeats the sign of capitals within the ligature
            continue
        if language == "fr" and word[0] == "Ø":  # liblouis has another letter for the capital
            continue
        assert as_unicode(translate(word, language)) == as_unicode(translate_by_table(word, language)), word
    for number in range(1100):
        assert translate(str(number), language) == translate_by_table(str(number), language), number


@pytest.mark.parametrize("language", LANGUAGES)
def test_our_tables_have_every_sign_of_a_keyboard_and_of_usual_titles(language: str):
    signs = [chr(code) for code in range(32, 127)] + list("×±²³½¼¾©®™€£¥§°…–—‘’“”„«»¿¡→←éèêëàâäáåãçíîïñóôöúûüœæøß")  # noqa: RUF001
    for sign in signs:
        assert translate_by_table(translation._plain(f"a {sign} b", language), language)


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


def odd(size: int = 4, cells: tuple[int, ...] = (1, 3, 9), works: int = 10**9, unread: int = 0) -> object:
    """A library with liblouis's names that writes these cells whatever it is given, so many times.

    unread: the number of characters that it leaves unread.
    """

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
        ("ok 🙂", "de", "'ok 🙂': character 4, '🙂' (U+1F642), is not in "),
        ("ale ł", "fr", "'ale ł': character 5, 'ł' (U+0142), is not in "),
        ("a\x07", "en", r"'a\x07': character 2, '\x07' (U+0007), is not in "),
        ("a\ud800", "en", r"'a\ud800': character 2, '\ud800' (U+D800), is not in any braille;"),
        ("a\ue000", "de", r"'a\ue000': character 2, '\ue000' (U+E000), is not in any braille;"),
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
    assert translate("", "en") == ()
    assert translate(" ", "fr") == (0,)


def test_translation_in_threads_gives_the_same_cells(installed: Louis):
    jobs = [
        (f"{text} {number}", each) for number, (each, texts) in product(range(6), ORDINARY.items()) for text in texts
    ]
    alone = [translate(*job) for job in jobs]
    start = Barrier(8)

    def all_of_them(_: int) -> list[tuple[int, ...]]:
        start.wait()
        return [translate(*job) for job in jobs]

    with ThreadPoolExecutor(8) as pool:
        assert all(each == alone for each in pool.map(all_of_them, range(8)))


def test_liblouis_is_called_by_one_thread_at_a_time(without: Callable[[object], None]):
    """Seen from within a library, as liblouis itself ends the process where it is disturbed."""
    library, inside, most = odd(), list[None](), list[int]()
    write: Any = library.lou_translateString  # pyright: ignore[reportAttributeAccessIssue]

    def watch(*given: Any) -> int:
        inside.append(None)
        time.sleep(1e-3)
        most.append(len(inside))
        inside.pop()
        return write(*given)

    library.lou_translateString = watch  # pyright: ignore[reportAttributeAccessIssue]
    without(library)
    with ThreadPoolExecutor(4) as pool:
        assert set(pool.map(translate, ["abc"] * 40)) == {(1, 3, 9)}
    assert set(most) == {1}


def test_liblouis_with_missing_table_prints_nothing(installed: Louis, capfd: pytest.CaptureFixture[str]):
    with pytest.raises(OSError, match=r"cannot use its table nowhere\.ctb"):
        installed._call("abc", "nowhere.ctb", 0)
    assert capfd.readouterr() == ("", "")


def test_as_ascii_has_a_character_for_every_cell():
    cells = tuple(range(64))
    assert len(set(as_ascii(cells))) == 64
    assert as_ascii(translate("Hello, 12.", "en")) == ",HELLO1 #AB4"


def test_each_language_has_a_table_of_liblouis():
    assert set(LANGUAGES) == TABLES.keys()

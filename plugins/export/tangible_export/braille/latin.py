"""Uncontracted braille of Latin letters by tables of our own, for where liblouis is not installed.

Sources: English: The Rules of Unified English Braille, 3rd ed., 2024, International Council on English Braille. German:
Das System der deutschen Blindenschrift, 2018, Brailleschriftkomitee der deutschsprachigen Länder: its Basisschrift,
which marks no capitals. French: Code braille français uniformisé pour la transcription des textes imprimés, 2nd ed.,
2008: digits are Antoine's, behind dot 6.
"""

import re
import unicodedata
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from tangible_core.errors import BrailleError

from .cells import Cells
from .louis import not_written


def _cells(text: str) -> Cells:
    """Cells as they are written in tables: the numbers of the raised dots, a cell a word; 0 for an empty one.

    >>> _cells("14 0 6")
    (9, 0, 32)
    """
    return tuple(sum(1 << int(dot) - 1 for dot in cell if dot != "0") for cell in text.split())


def _table(text: str) -> dict[str, Cells]:
    """Each line a character and its cells."""
    rows = (line.split(maxsplit=1) for line in text.strip().splitlines())
    return {character: _cells(cells) for character, cells in rows}


LETTERS = dict(
    zip(
        "abcdefghijklmnopqrstuvwxyz",
        _cells(
            "1 12 14 145 15 124 1245 125 24 245 13 123 134 1345 135 1234 12345 1235 234 2345 136 1236 2456 1346 13456 "
            "1356"
        ),
        strict=True,
    )
)
"""Alike in every Latin braille."""


@dataclass(frozen=True)
class Code:
    """The braille of one language."""

    title: str
    signs: Mapping[str, Cells]
    """Letters that are no plain ones, and punctuation."""
    quotes: tuple[Cells, Cells]
    """Before a word, and behind it."""
    quoting: str
    """Marks that open or close by where they stand."""
    number: Cells
    """Stands before the first digit."""
    digits: Cells
    """From 0 to 9."""
    within_number: str
    """Signs between digits with which the number goes on."""
    before_number: str
    """Signs before a digit that belong to the number: its sign stands before them."""
    after_number: tuple[Cells, str] = ((), "")
    """Stands between a number and one of these characters, which would be read as a digit."""
    thousands: Cells = (0,)
    """A space between groups of three digits."""
    capital: Cells = ()
    capital_word: Cells = ()
    capital_end: Cells = ()
    capital_passage: Cells = ()
    """Stands before three words or more in capitals; the end of capitals behind them."""
    no_space_before: str = ""
    marks: Mapping[str, Cells] = field(default_factory=dict[str, Cells])
    """Accents, as combining characters; they stand before their letter."""


_UPPER = "A-ZÀ-ÖØ-Þ"
_PASSAGE = re.compile(rf"(?<![^ ])[{_UPPER}]+(?: [{_UPPER}]+){{2,}}(?![^ ])")
"""Three words or more in capitals."""
_A_TO_J = _cells("245 1 12 14 145 15 124 1245 125 24")
_ANTOINE = _cells("3456 16 126 146 1456 156 1246 12456 1256 246")

CODES: Mapping[str, Code] = {
    "en": Code(
        title="our own table of Unified English Braille, uncontracted",
        signs=_table("""
            , 2
            ; 23
            : 25
            . 256
            ! 235
            ? 236
            ' 3
            \u2019 3
            - 36
            \u2013 6 36
            ( 5 126
            ) 5 345
            / 456 34
            % 46 356
            & 4 12346
            + 5 235
            = 5 2356
            * 5 35
            @ 4 1
            § 45 234
            € 4 15
            £ 4 123
            $ 4 234
            … 256 256 256
            “ 236
            ” 356
            « 456 236
            » 456 356
            ß 46 2346
            æ 1 45 235 15
            œ 135 45 235 15
            ø 4 16 135
            ł 4 16 123
            ° 45 245
        """),
        quotes=(_cells("236"), _cells("356")),
        quoting='"',
        number=_cells("3456"),
        digits=_A_TO_J,
        within_number=",.",
        before_number=",.",
        after_number=(_cells("56"), "abcdefghij"),
        capital=_cells("6"),
        capital_word=_cells("6 6"),
        capital_end=_cells("6 3"),
        capital_passage=_cells("6 6 6"),
        thousands=_cells("5"),
        marks={
            "\u0300": _cells("45 16"),
            "\u0301": _cells("45 34"),
            "\u0302": _cells("45 146"),
            "\u0303": _cells("45 12456"),
            "\u0304": _cells("4 36"),
            "\u0306": _cells("4 346"),
            "\u0308": _cells("45 25"),
            "\u030a": _cells("45 1246"),
            "\u030c": _cells("45 346"),
            "\u0327": _cells("45 12346"),
        },
    ),
    "de": Code(
        title="our own table of the German Basisschrift",
        signs=_table("""
            , 2
            ; 23
            : 25
            . 3
            ! 235
            ? 26
            ' 6
            \u2019 6
            - 36
            \u2013 6 36
            ( 2356
            ) 2356
            / 5 2
            + 4 235
            = 4 2356
            % 3456 245 356
            & 5 136
            § 346
            € 4 15
            ° 4 356
            … 3 3 3
            „ 236
            ä 345
            ö 246
            ü 1256
            ß 2346
            æ 1 15
            œ 135 15
            ø 4 135
            ł 4 123
        """),
        quotes=(_cells("236"), _cells("356")),
        quoting='"“”«»',
        number=_cells("3456"),
        digits=_A_TO_J,
        within_number=",.",
        before_number=",.",
        after_number=(_cells("6"), 'abcdefghij:;!?)"“”«»'),
        no_space_before="%",
        marks=dict.fromkeys(
            "\u0300\u0301\u0302\u0303\u0304\u0306\u0307\u0308\u030a\u030b\u030c\u0327\u0328", _cells("4")
        ),
    ),
    "fr": Code(
        title="our own table of the Code braille français uniformisé",
        signs=_table("""
            , 2
            ; 23
            : 25
            . 256
            ! 235
            ? 26
            ' 3
            \u2019 3
            - 36
            \u2013 36 36
            ( 236
            ) 356
            / 34
            % 5 346
            & 5 123456
            § 5 1234
            € 45 15
            ° 5 135
            * 35
            @ 345
            + 6 235
            = 6 2356
            … 256 256 256
            « 2356
            » 2356
            à 12356
            â 16
            æ 345
            ç 12346
            è 2346
            é 123456
            ê 126
            ë 1246
            î 146
            ï 12456
            ô 1456
            œ 246
            ù 23456
            û 156
            ü 1256
            ä 345
            ö 246
        """),
        quotes=(_cells("2356"), _cells("2356")),
        quoting='"“”',
        number=_cells("6"),
        digits=_ANTOINE,
        within_number=",.-/",
        before_number="(,.",
        capital=_cells("46"),
        capital_word=_cells("46 46"),
        capital_end=_cells("6 3"),
    ),
}


def translated(text: str, language: str) -> Cells:
    """Cells of one line of composed characters. Raises: BrailleError for a character that is not in the table.

    >>> translated("1a", "en") == _cells("3456 1 56 1")
    True
    """
    code, cells = CODES[language], list[int]()
    if code.no_space_before:
        text = re.sub(f" +([{code.no_space_before}])", r"\1", text)
    capitals = _capitals(text, code)
    for place, each in enumerate(text):
        cells += capitals.get(place, ())
        cells += _number_sign(text, place, code)
        cells.append(code.digits[int(each)]) if _digit(text, place) else cells.extend(_sign(text, place, code))
    return (*cells, *capitals.get(len(text), ()))


def _digit(text: str, place: int) -> bool:
    return 0 <= place < len(text) and text[place] in "0123456789"


def _number_sign(text: str, place: int, code: Code) -> Cells:
    """What stands before a character because a number begins with it, or has ended before it."""
    each, behind_digit = text[place], _digit(text, place - 1)
    if behind_digit:
        cells, mistaken = code.after_number
        return cells if (each if code.capital else each.lower()) in mistaken else ()
    if each in code.before_number and _digit(text, place + 1):
        return code.number
    if not _digit(text, place) or (place and text[place - 1] in code.before_number):
        return ()
    goes_on = _digit(text, place - 2) and (text[place - 1] in code.within_number or _thousands(text, place - 1, code))
    return () if goes_on else code.number


def _thousands(text: str, place: int, code: Code) -> bool:
    """Whether there is a space here before a group of three digits that belongs to the number before it."""
    three = re.match(r" [0-9]{3}(?![0-9])", text[place:])
    return code.thousands != (0,) and _digit(text, place - 1) and three is not None


def _sign(text: str, place: int, code: Code) -> Cells:
    each = text[place]
    if each in code.quoting:
        return code.quotes[_closes(text, place)]
    if each == " ":
        return code.thousands if _thousands(text, place, code) else (0,)
    if (cells := _letter(each, code)) is None:
        raise BrailleError(f"{not_written(each, place + 1, text, code.title)}, or install liblouis")
    return cells


def _closes(text: str, place: int) -> bool:
    """Whether a quotation mark here stands behind what is quoted."""
    return place > 0 and (text[place - 1] not in " ([" or text[place + 1 : place + 2] in ("", " "))


def _letter(each: str, code: Code) -> Cells | None:
    if (lower := each.lower()) in code.signs:
        return code.signs[lower]
    if lower in LETTERS:
        return (LETTERS[lower],)
    base, *marks = unicodedata.normalize("NFD", lower)
    if base not in LETTERS or not marks or not all(mark in code.marks for mark in marks):
        return None
    return (*(cell for mark in marks for cell in code.marks[mark]), LETTERS[base])


def _capitals(text: str, code: Code) -> dict[int, Cells]:
    """By place, what stands before a letter that is a capital, or behind the last of a run of them."""
    if not code.capital:
        return {}
    placed: dict[int, Cells] = {}
    passages = [(found.start(), found.end()) for found in _PASSAGE.finditer(text)] if code.capital_passage else []
    for start, end in passages:
        placed[start], placed[end] = code.capital_passage, code.capital_end
    for start, end in _runs(text):
        if any(first <= start < last for first, last in passages):
            continue
        placed[start] = code.capital_word if end - start > 1 else code.capital
        if end - start > 1 and end < len(text) and text[end].isalpha():
            placed[end] = code.capital_end
    return placed


def _runs(text: str) -> Iterator[tuple[int, int]]:
    """Where capitals stand together: from, and to before."""
    start = 0
    for place in range(len(text) + 1):
        if place == len(text) or not text[place].isupper():
            if place > start:
                yield start, place
            start = place + 1

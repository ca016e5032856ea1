"""A language's catalogue, a .po file as translators know it: English texts of the source with their translations."""

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, cached_property, lru_cache
from importlib.resources import files

UNITS = r"%|[mcu]?m|[mu]?s|N|N/m|N/mm|N s/m|m/s|mm/s|k?Hz|px|[kMG]i?B|bytes|deg|min|h|g|J|dB"
NUMBER = re.compile(rf"([-\u2212+±]?)([1-9]\d{{0,2}}(?:,\d{{3}})+|\d+)(?:\.(\d+))?(e[-+]?\d+)?(?:| ?(?:{UNITS}))")
"""A number alone, with its unit."""
NUMBER_MARKS = {"de": (",", "."), "fr": (",", "\u202f")}  # the decimal mark, and the mark between thousands


class Numerals:
    """The notation of numbers of one language."""

    def __init__(self, language: str) -> None:
        self._decimal, self._thousands = NUMBER_MARKS[language]

    def __call__(self, text: str) -> str | None:
        """Return a number in the notation; None for any other text."""
        if (match := NUMBER.fullmatch(text)) is None:
            return None
        sign, whole, fraction, exponent = match.groups(default="")
        unit = text[match.end(4) if exponent else match.end(3) if fraction else match.end(2) :]
        return (
            f"{sign}{whole.replace(',', self._thousands)}{self._decimal + fraction if fraction else ''}{exponent}{unit}"
        )


PLACEHOLDER = re.compile(r"\{(\w+)(!s)?\}")
LONG = 9  # the fewest characters of a literal that is not in a text twice by chance


class Template:
    """An English text with placeholders such as `{name}`, and its translation."""

    def __init__(self, english: str, translation: str) -> None:
        self.english = english
        self.translation = translation
        self.literals: tuple[str, ...] = tuple(PLACEHOLDER.split(english)[::3])
        self.letters: int = sum(map(str.isalpha, "".join(self.literals)))
        self.longest: str = max(self.literals, key=len)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names of the placeholders, in the order of the English text."""
        return tuple(match[1] for match in PLACEHOLDER.finditer(self.english))

    def is_once_in(self, text: str) -> bool:
        """Return True if a text may be made of this template; two texts of it in one, joined as a list, are not."""
        times = text.count(self.longest)
        return times == 1 or (times > 1 and len(self.longest) < LONG)

    def match(self, text: str) -> Mapping[str, str] | None:
        """Return what stands in place of each placeholder if a text was made of this template."""
        first, *middle, last = self.literals
        if not (text.startswith(first) and text.endswith(last)) or len(text) < len(first) + len(last):
            return None
        begin, end, values = len(first), len(text) - len(last), list[str]()
        for literal in middle:
            place = _place(text, literal, begin, end)
            if place < 0:
                return None
            values.append(text[begin:place])
            begin = place + len(literal)
        values.append(text[begin:end])
        for number in reversed(range(len(middle))):  # of placeholders side by side, the first one has it all
            if not middle[number]:
                values[number], values[number + 1] = values[number + 1], values[number]
        if "\n" not in self.english and any("\n" in value for value in values):
            return None
        return dict(zip(self.names, values, strict=True))

    def fill(self, values: Mapping[str, str], embed: Callable[[str], str]) -> str:
        """Return the translation with these values. embed: puts a value into the language."""
        parts = self.translation.split("`")
        for number, part in enumerate(parts):
            is_code = number % 2 == 1

            def value(match: re.Match[str], is_code: bool = is_code) -> str:
                own = values[match[1]]
                return own if is_code or match[2] else embed(own)

            parts[number] = PLACEHOLDER.sub(value, part)
        return "`".join(parts)


def _place(text: str, literal: str, begin: int, end: int) -> int:
    """Return where a literal stands first, or -1; a full stop alone is not the point in a number."""
    place = text.find(literal, begin, end)
    while literal == "." and place > 0 and text[place - 1].isdigit() and text[place + 1 : place + 2].isdigit():
        place = text.find(literal, place + 1, end)
    return place


ENTRY = re.compile(r'^msgid((?:\s*"(?:[^"\\]|\\.)*")+)\s*msgstr((?:\s*"(?:[^"\\]|\\.)*")+)', re.MULTILINE)
LINE = re.compile(r'"(?:[^"\\]|\\.)*"')
JOINTS = ("; ", ": ", " -> ", ", ", " (", " <= ", " >= ", " < ", " > ", " ≥ ", " ≤ ", " / ", " x ", " and ", " or ")
"""The marks between texts that stand in one line, those that bind least first."""
# Fewest letters of a template that are recognised between words which are not known.
WEAK = 9
MAX_WORDS = 2  # most words of a name, which stays as it is between texts that are known
MAX_CHARACTERS = 3000
# Most marks of one kind at which a text is taken apart: a longer list stays as it is.
MAX_JOINTS = 30
# Texts that are kept with their translations: a page shows the same ones again and again.
CACHED = 8192


class Catalogue:
    """The texts of one language."""

    def __init__(self, entries: dict[str, str], numerals: Numerals) -> None:
        templates = [Template(*each) for each in entries.items()]
        self._exact = {template.english: template.translation for template in templates if not template.names}
        with_values = sorted((template for template in templates if template.names), key=lambda each: -each.letters)
        self._strong = [each for each in with_values if each.letters >= WEAK or "\n" in each.english]
        self._weak = [each for each in with_values if each not in self._strong]
        self._endings = [each for each in with_values if each.english[0] in MARKS]
        self._words: dict[str, list[str]] = {}
        for english in self._exact:
            if english.count(" ") >= MAX_WORDS or english[0] in MARKS:
                self._words.setdefault(english[-LAST:], []).append(english)
        self._numerals = numerals
        self.find: Callable[[str], str | None] = lru_cache(CACHED)(self._find)

    def __call__(self, text: str) -> str:
        """Return a text in the language; what the catalogue does not know stays English, as a whole."""
        return text if (translation := self.find(text)) is None else translation

    def _find(self, text: str) -> str | None:
        """Return a text in the language, or None if it is not known."""
        bare = text.strip()
        if not bare or len(bare) > MAX_CHARACTERS:
            return None
        before, after = text[: text.index(bare)], text[text.index(bare) + len(bare) :]
        ways = (
            self._exactly, self._strongly, self._counted, self._numerals, self._by_lines, self._without_ending,
            self._by_sentences, self._by_joints, self._weakly, self._by_joint_and_names,
            self._without_stop, self._behind_a_name,
        )  # fmt: skip
        translation = next(filter(None, (way(bare) for way in ways)), None)
        if translation is None and after:  # a template whose last placeholder is empty
            translation = self._strongly(f"{bare} ") or self._weakly(f"{bare} ")
            return translation and before + translation + after[1:]
        return None if translation is None else before + translation + after

    def _exactly(self, text: str) -> str | None:
        one_line = " ".join(text.split())
        if (translation := self._exact.get(text) or self._exact.get(one_line)) is not None:
            return translation
        translation = self._exact.get(f"{one_line}.")  # as in a list of commands
        return translation and translation.removesuffix(".")

    def _strongly(self, text: str) -> str | None:
        return self._by_template(text, self._strong)

    def _weakly(self, text: str) -> str | None:
        return self._by_template(text, self._weak, self._fits)

    def _by_template(
        self, text: str, templates: Sequence[Template], fits: Callable[[str], bool] = lambda _: True
    ) -> str | None:
        """Return a text that was made of one of these templates, and whose values fit."""
        for template in templates:
            values = template.match(text) if template.is_once_in(text) else None
            if values is not None and all(map(fits, values.values())):
                return template.fill(values, self)
        return None

    def _fits(self, text: str) -> bool:
        """Return True for a text that is known, a name, or code."""
        return is_name(text.strip()) or self.find(text) is not None

    def _counted(self, text: str) -> str | None:
        """Return a number of known things, such as `3 ok` or `196.1 ns a tick`."""
        count, _, things = text.partition(" ")
        number, translation = self._numerals(count), self._exact.get(things)
        return f"{number} {translation}" if number and translation else None

    def _by_lines(self, text: str) -> str | None:
        for mark in ("\n\n", "\n"):
            if mark in text:
                return mark.join(map(self, text.split(mark)))
        return None

    def _without_ending(self, text: str) -> str | None:
        """Return a text with an addition, such as a hint in brackets, a place, or a further fact."""
        for ending in self._words.get(text[-LAST:], ()):
            start = len(text) - len(ending)
            apart = start > 0 and text.endswith(ending) and (text[start - 1] == " " or ending[0] in MARKS)
            if apart and self._fits(text[:start]):
                return self(text[:start]) + self._exact[ending]
        for template in self._endings:
            place = text.rfind(template.literals[0])
            values = template.match(text[place:]) if place > 0 else None
            if values is not None and all(map(self._fits, (text[:place], *values.values()))):
                return self(text[:place]) + template.fill(values, self)
        return None

    def _by_sentences(self, text: str) -> str | None:
        sentences = re.split(r"(?<=[.!?]) +(?=[A-Z`[])", text)
        are_known = len(sentences) > 1 and all(self.find(sentence) is not None for sentence in sentences)
        return " ".join(map(self, sentences)) if are_known else None

    def _by_joints(self, text: str) -> str | None:
        """Return two texts, such as those of a list or a place and a text, that are known."""
        return self._by_halves(text, lambda each: self.find(each) is not None)

    def _by_joint_and_names(self, text: str) -> str | None:
        """Return a known text next to a name."""
        return self._by_halves(text, self._fits)

    def _by_halves(self, text: str, fits: Callable[[str], bool]) -> str | None:
        for parts, joint in self._halves(text):
            if all(map(fits, parts)) and any(self.find(part) is not None for part in parts):
                return f"{self(parts[0])}{self._joint(joint)}{self(parts[1])}"
        return None

    def _behind_a_name(self, text: str) -> str | None:
        """Return a known text behind a name of somebody's own, of whatever words."""
        name, colon, rest = text.partition(": ")
        translation = self.find(rest) if colon else None
        return translation and f"{name}{colon}{translation}"

    def _without_stop(self, text: str) -> str | None:
        translation = self.find(text[:-1]) if text.endswith(".") else None
        return translation and f"{translation}."

    def _halves(self, text: str) -> Iterator[tuple[tuple[str, str], str]]:
        for joint in (mark for mark in JOINTS if text.count(mark) <= MAX_JOINTS):
            place = text.find(joint)
            while place > 0:
                yield (text[:place], text[place + len(joint) :]), joint
                place = text.find(joint, place + 1)

    def _joint(self, joint: str) -> str:
        word = joint.strip()
        return joint.replace(word, self._exact.get(word, word))


MARKS = " ,;.:(["  # the marks with which an addition to a text begins
LAST = 5  # last letters by which additions are found


def is_name(text: str) -> bool:
    """Return True for a word, a short text that is not English prose, or code between backticks.

    >>> is_name("Novint Falcon"), is_name("`a: 1 mm`"), is_name("halfway down")
    (True, True, False)
    """
    words = text.split()
    short = len(words) < 2 or (len(words) == 2 and not all(word.isalpha() and word.islower() for word in words))
    return short or (text.startswith("`") and text.endswith("`"))


@cache
def catalogue(language: str) -> Catalogue:
    """Return the catalogue of a language other than English."""
    text = files("tangible_core.translation").joinpath(f"{language}.po").read_text(encoding="utf-8")
    return Catalogue(parse(text), Numerals(language))


def parse(text: str) -> dict[str, str]:
    """Return the texts of a .po file with their translations, without those that have none yet."""
    pairs = ((unquoted(english), unquoted(own)) for english, own in ENTRY.findall(text))
    return {english: own for english, own in pairs if english and own}


def unquoted(lines: str) -> str:
    """Return the text of the quoted lines of an entry."""
    return "".join(json.loads(text) for text in LINE.findall(lines))

"""The catalogues of translations, brought up to date: `python tests/helpers/catalogues.py` after a change of a text."""

import json
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from shown_texts import ROOT, described, is_prose, literals, python_files
from tangible_core.translation.catalogue import ENTRY, PLACEHOLDER, unquoted
from tangible_core.translation.translate import MARKS
from tangible_legibility.words.languages import TABLES

FOLDER = ROOT / "tangible_core" / "translation"
WHOLE = ("de",)
"""The languages into which every text is translated; the others have what their catalogues list."""
FUZZY = re.compile(rf"^#, fuzzy\n{ENTRY.pattern.removeprefix('^').partition('msgstr')[0]}", re.MULTILINE)
"""An entry that somebody who speaks the language is to look at."""
HEADER = """# {title}
# A text in English with its translation; placeholders such as {{name}} may stand in another order. {{name!s}}, and what
# stands between backticks, is not translated, and numbers in it keep their points: it goes into a file or a terminal.
# `python tests/helpers/catalogues.py` brings this file up to date.
msgid ""
msgstr ""
"Language: {language}\\n"
"Content-Type: text/plain; charset=UTF-8\\n"
"""
OTHERS = (
    *TABLES["en"].words.values(), *TABLES["en"].materials,
    "its groups lie more than {number} deep", "it takes more than {time} s to draw", "it takes too much memory to draw",
    "page is for a PDF; leave it out",
)  # fmt: skip
"""Words of descriptions, and reasons why a drawing is not read, which other texts may contain."""
OWN = frozenset(["Source: {0}", "and", "or", "integer", "number", "boolean", "string", "warning", "error"])
"""Texts that stand in no literal: sources of methods, joints of lists, types of JSON Schema, levels of logging."""
TYPER = (
    "Usage:", "Arguments", "Options", "Commands", "Show this message and exit.", "[required]", "[default: {value}]",
    "Install completion for the current shell.", "Error: {message}", "Try '{command}' for help.",
    "Show completion for the current shell, to copy it or customize the installation.", "No such command {name}.",
    "No such command {name}. Did you mean {near}?", "No such option: {name}", "Missing argument {name}.",
    "No such option: {name} Did you mean {near}?", "Invalid value for {name}: {why}", "Missing option {name}.",
    "Got unexpected extra argument ({name})", "Got unexpected extra arguments ({name})", "Missing command.",
    "Option {name} requires an argument.", "{value} is not one of {choices}.", "{value} is not a valid float.",
    "{value} is not a valid int.", "{value} is not a valid integer.", "Did you mean {near}?", "Aborted!",
    "(Possible options: {near})", "Did you mean one of: {near}?", "[OPTIONS]", "COMMAND [ARGS]...",
    "[x{bounds}]", "Field required", "Extra inputs are not permitted", "Input should be {expected}",
    "Input should be a valid number, unable to parse string as a number", "Input should be greater than {bound}",
    "Input should be a valid integer, unable to parse string as an integer", "Input should be less than {bound}",
    "Input should be greater than or equal to {bound}", "Input should be less than or equal to {bound}",
    "Input should be a valid string", "Input should be a valid boolean", "Input should be a valid list",
    "Input should be a finite number", "Input should be a multiple of {step}", "Input should be a valid tuple",
    "String should match pattern {pattern}", "String should have at least {count} characters",
    "String should have at most {count} characters", "Input should be a valid boolean, unable to interpret input",
    "List should have at least {count} items after validation, not {value}", "Unable to extract tag",
    "Tuple should have at most {count} items after validation, not {value}", "Input should be a valid path",
    "Input should be a valid integer, got a number with a fractional part", "Input should be an instance of {kind}",
)  # fmt: skip
"""Texts of typer and pydantic that the program shows."""


@cache
def shown() -> dict[str, str]:
    """Return the texts that people may see, with the file that each is from."""
    texts: dict[str, str] = {}
    for path in python_files():
        for text in texts_of(path):
            if is_prose(text):
                texts.setdefault(normal(text), "")
                named.setdefault(normal(text), text)
                texts[normal(text)] = texts[normal(text)] or path.relative_to(ROOT).as_posix()
    for text in described():
        texts.setdefault(normal(text), "options and commands")
        named.setdefault(normal(text), text)
    for text in TYPER:
        texts.setdefault(normal(text), "typer")
        named.setdefault(normal(text), text)
    return texts


named: dict[str, str] = {}
"""Texts by their normal form."""


@cache
def words() -> frozenset[str]:
    """Return all literals of the program: a catalogue may have more than `shown` finds, such as single words."""
    texts = (*OTHERS, *(text for path in python_files() for text in texts_of(path)))
    return frozenset(normal(form) for text in texts for form in (text, MARKS.sub("", text))) | OWN


@cache
def texts_of(path: Path) -> tuple[str, ...]:
    """Return the templates of a module."""
    return tuple(text for _, text in literals(path))


def normal(text: str) -> str:
    """Return a text with numbers for its placeholders, so that a variable may be called anything."""
    numbers: dict[str, int] = {}
    return PLACEHOLDER.sub(lambda found: f"{{{numbers.setdefault(found[1], len(numbers))}}}", text)


def entries(language: str) -> dict[str, tuple[str, str]]:
    """Return the texts of a catalogue by their normal form, with their translations, "" where there is none yet."""
    text = (FOLDER / f"{language}.po").read_text(encoding="utf-8")
    pairs = [(unquoted(english), unquoted(own)) for english, own in ENTRY.findall(text)]
    return {normal(english): (english, own) for english, own in pairs if english}


def missing(language: str) -> Iterator[str]:
    """Yield the texts that a catalogue does not have, or not in its language."""
    known = entries(language)
    yield from (named[each] for each in shown() if not known.get(each, ("", ""))[1])


def stale(language: str) -> Iterator[str]:
    """Yield the texts of a catalogue that the program does not show any more."""
    yield from (english for each, (english, _) in entries(language).items() if each not in shown().keys() | words())


def misfits(language: str) -> Iterator[str]:
    """Yield the texts whose translations have other placeholders, or tear apart what stands side by side."""
    for english, own in entries(language).values():
        known, used = (
            {match[1] for match in PLACEHOLDER.finditer(each.replace("!s}", "}"))} for each in (english, own)
        )
        pairs = re.findall(r"(?=(\{\w+\}\{\w+\}))", english)
        if not used <= known or any(pair not in own.replace("!s}", "}") for pair in pairs):
            yield english


def update(language: str) -> None:
    """Write a catalogue anew: what the program shows, in the order of its files; other words of it below."""
    known, gone = entries(language), {normal(each) for each in stale(language)}
    texts = shown() if language in WHOLE else {each: place for each, place in shown().items() if each in known}
    rest = {each: "words" for each, (_, own) in known.items() if own and each not in texts and each not in gone}
    title = {"de": "German", "fr": "French"}[language]
    unsure = {normal(unquoted(text)) for text in FUZZY.findall((FOLDER / f"{language}.po").read_text(encoding="utf-8"))}
    lines, last = [HEADER.format(title=title, language=language)], ""
    for each, place in {**texts, **rest}.items():
        lines += [f"#: {place}"] if place != last else []
        last = place
        english, own = known.get(each, (named.get(each, each), ""))
        lines += ["#, fuzzy"] if each in unsure else []
        lines.append(f"msgid {_quoted(english)}\nmsgstr {_quoted(own)}\n")
    (FOLDER / f"{language}.po").write_text("\n".join(lines), encoding="utf-8")


def _quoted(text: str) -> str:
    """Return a text as a .po file has it, a line of the text in a line of its own."""
    pieces = re.findall(r"[^\n]*\n|[^\n]+", text) or [""]
    quoted = [json.dumps(piece, ensure_ascii=False) for piece in pieces]
    return "\n".join(quoted if len(quoted) == 1 else ['""', *quoted])


if __name__ == "__main__":
    for each in ("de", "fr"):
        update(each)
        print(each, len(list(missing(each))) if each in WHOLE else "", "left to translate")

"""What a configuration says of parts, as far as that can be checked without their picture."""

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Annotated, Any, cast

from pydantic import AfterValidator, ConfigDict, Field

from ...data import Material
from ...errors import MOST_QUOTED, MaterialError, did_you_mean, quoted
from ...files.source import Location, Source
from ...legibility.choice import SimplifyChoice
from ...materials.assignment import find
from ...parts import HeightChoice, PartChoice
from ...scene.workspace import Section

Said = tuple[Location, str]
"""The keys that a complaint is of, and what is wrong there."""
EXAMPLE = "{0: wall, 6: {name: helmet, height_m: 4 mm}}"
MOST_TITLE = 200
"""Characters of a title."""


_TAG = "^[A-Za-z]{2,8}(-[A-Za-z0-9]{1,8})*$"


def _tag(language: str) -> str:
    if not re.match(_TAG, language):
        raise ValueError("Input should be the tag of a language, such as en, de or pt-BR")
    return language


class Inscription(Section):
    """What the whole is called, and in which language that and the names of its parts are."""

    model_config = ConfigDict(coerce_numbers_to_str=True)  # a title may be a year

    title: Annotated[str, Field(max_length=MOST_TITLE)] = ""
    """What the picture is called, in words of your own; empty for the name of its file."""
    language: Annotated[str, Field(json_schema_extra={"pattern": _TAG}), AfterValidator(_tag)] = "en"
    """The language of the title and of the names of parts, as a tag: `en`, `de`, `pt-BR`."""


def read_parts(source: Source) -> dict[int, PartChoice] | None:
    """What the file says of each part, by number; None where it has no `parts:`. Complains of what makes no sense."""
    if "parts" not in source.tree:
        return None
    block = source.tree["parts"]
    if not isinstance(block, dict | None):
        source.complain(("parts",), f"parts: {_wanted(block)}")
        return {}
    found: dict[int, PartChoice] = {}
    for key, said in cast("dict[Any, Any]", block or {}).items():
        number, place = _number(key), ("parts", key)
        if number is None or number in found:
            source.complain(place, f"parts.{key}: {_no_number(key) if number is None else 'is there twice'}")
        elif not isinstance(said, str | dict | None):
            source.complain(place, f"parts.{key}: {_no_part(said)}")
        elif (choice := source.model(place, PartChoice, {} if said is None else said)) is not None:
            found[number] = choice
    return found


def read_heights(source: Source) -> HeightChoice | None:
    """The file's recipe for a relief of parts; None where it has none, or is told to have none."""
    block = source.tree.get("heights")
    if isinstance(block, str):
        block = {"by": block}
    return None if block is None else source.model(("heights",), HeightChoice, block)


def read_simplify(source: Source) -> SimplifyChoice | None:
    """How the file has its parts simplified; None where it does not."""
    block = source.tree.get("simplify")
    return None if block is None else source.model(("simplify",), SimplifyChoice, block)


def read_inscription(source: Source) -> Inscription | None:
    """The file's title and language; None after a complaint."""
    said = {key: source.tree[key] for key in Inscription.model_fields if source.tree.get(key) is not None}
    return source.model((), Inscription, said)


def _wanted(block: Any) -> str:
    return f"takes a mapping from the number of a part to its name, such as {EXAMPLE}, not {quoted(block)}"


def _no_number(key: Any) -> str:
    return f"the number of a part is a whole number from 0, not {quoted(key)}; such as {EXAMPLE}"


def _no_part(said: Any) -> str:
    return f"takes the name of a part, or {{name: ..., height_m: ..., material: ...}}, not {quoted(said)}"


def _number(key: Any) -> int | None:
    """Of a part; as JSON has it, too."""
    if isinstance(key, str) and key.isdecimal() and len(key) < MOST_QUOTED:
        return int(key)
    return int(key) if isinstance(key, int) and not isinstance(key, bool) and key >= 0 else None


def wrong_of_names(parts: Mapping[int, PartChoice]) -> Iterator[Said]:
    """Names that nobody can say, or that two parts have."""
    of: dict[str, int] = {}
    for number, choice in parts.items():
        wrong = _wrong_name(choice.name)
        other = of.setdefault(choice.name.strip().casefold(), number) if choice.name.strip() else number
        if other != number:
            wrong = f"{quoted(choice.name)} is the name of part {other} as well; give each part a name of its own"
        if wrong:
            yield ("parts", number, "name"), wrong


def _wrong_name(name: str) -> str:
    if name.strip().isdecimal():
        return f"{quoted(name)} would be taken for the number of a part; put a word before it"
    if not name.isprintable():
        return f"{quoted(name)} holds what is no letter; a name is one line of plain text"
    return f"{quoted(name)} is over {MOST_QUOTED} characters; say it in fewer" if len(name) > MOST_QUOTED else ""


def wrong_of_materials(parts: Mapping[int, PartChoice], library: Mapping[str, Material]) -> Iterator[Said]:
    """Materials of parts that are not in the library."""
    for number, choice in parts.items():
        try:
            if choice.material is not None:
                find(choice.material, library)
        except MaterialError as error:
            yield ("parts", number, "material"), str(error)


def wrong_of_rules(named: Iterable[int | str | None], parts: Mapping[int, PartChoice] | None) -> Iterator[Said]:
    """Rules for parts that have no such name.

    named: the part of each rule. parts: None where nothing is by parts.
    """
    names = numbers_of(parts or {})
    for number, part in enumerate(named):
        place = ("materials", "rules", number, "part")
        if part is None:
            continue
        if parts is None:
            yield place, "nothing is by parts; name them under `parts:`, or write `segment:` for a whole segment"
        elif isinstance(part, str) and part.strip() not in names:
            there = f"named are {', '.join(names)}" if names else "`parts:` names none"
            yield place, f"no part is named {quoted(part)}{did_you_mean(part, names)}; {there}"


def numbers_of(parts: Mapping[int, PartChoice]) -> dict[str, int]:
    """The numbers of parts by name."""
    return {choice.name.strip(): number for number, choice in parts.items() if choice.name.strip()}


def names_of(parts: Mapping[int, PartChoice], count: int) -> tuple[str, ...]:
    """A name for each of so many parts; empty for one that has none."""
    return tuple(parts[number].name.strip() if number in parts else "" for number in range(count))


def called(number: int, name: str = "") -> str:
    """A part in a sentence.

    >>> called(6, "helmet"), called(7)
    ('part 6 (helmet)', 'part 7')
    """
    return f"part {number} ({name})" if name else f"part {number}"

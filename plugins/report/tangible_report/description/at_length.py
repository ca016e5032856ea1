"""A long description of a surface: its size, its heights, and its parts from near to far; as lines and as HTML."""

from collections.abc import Callable, Sequence
from html import escape
from importlib.resources import files
from string import Template
from typing import NamedTuple

import numpy as np

from tangible_core.data import HapticSurface, shown_number
from tangible_core.scene import SceneKind
from tangible_legibility.words.languages import Language, Words, one_line
from tangible_legibility.words.places import NOWHERE

from .describing import FLAT_M, PartFacts, heights_in_words, materials_in_words, people_in_words

# The number of parts that are described, the largest; the others are counted.
MAX_PARTS = 60
MIN_SHARE = 0.001  # the share of the picture below which a part without a name is left out
# The height below which a part belongs to the ground, so that its height is left out.
MIN_HIGH_M = 5e-5
MAX_NEIGHBOURS = 4  # the number of neighbours of a part that are named, those with the longest borders
SHARES = (0.5, 0.25, 0.08, 0.0)
"""The shares of the picture from which on another word describes the size of a part."""


class ToldPart(NamedTuple):
    """A part in words."""

    label: str  # the part's name, or `part 3`
    sentences: tuple[str, ...]


class Told(NamedTuple):
    """A long description."""

    title: str
    overview: tuple[str, ...]
    heading: str  # the heading of the list of parts; empty if there are none
    parts: tuple[ToldPart, ...]  # the parts from near to far
    left_out: str  # a sentence on parts that are not in the list; empty if all are


def describe_at_length(
    surface: HapticSurface,
    title: str,
    language: Language = "en",
    parts: Sequence[PartFacts] = (),
    kind: SceneKind | None = None,
    people: int = 0,
) -> tuple[str, ...]:
    """Return the lines of a long description: title, overview, heading, and a line for each part.

    >>> describe_at_length(HapticSurface.from_heights(np.zeros((8, 8))), "A plate")
    ('A plate', '', 'A surface 80 mm wide and 80 mm long. It is flat everywhere.')
    """
    description = tell(surface, title, language, parts, kind, people)
    lines = [description.title, "", " ".join(description.overview)]
    if description.parts:
        lines += ["", description.heading]
    lines += [f"- {end_sentence(part.label)} {' '.join(part.sentences)}" for part in description.parts]
    return (*lines, description.left_out) if description.left_out else tuple(lines)


def page_of(
    surface: HapticSurface,
    title: str,
    language: Language = "en",
    parts: Sequence[PartFacts] = (),
    kind: SceneKind | None = None,
    people: int = 0,
    *,
    named_in: str | None = None,
) -> str:
    """Return `describe_at_length` as accessible HTML. named_in: language of title and names, if another."""
    other = named_in if named_in and named_in != language else ""
    description = tell(surface, title, language, parts, kind, people, lambda text: _quote(text, other))
    items = "".join(
        f"<li><strong>{end_sentence(part.label)}</strong> {' '.join(part.sentences)}</li>\n"
        for part in description.parts
    )
    part_list = f"<h2>{description.heading}</h2>\n<ul>\n{items}</ul>\n" if description.parts else ""
    remark = f"<p>{description.left_out}</p>\n" if description.left_out else ""
    page = files("tangible_report.description").joinpath("page.html").read_text(encoding="utf-8")
    return Template(page).substitute(
        language=language,
        name=escape(one_line(title)) or description.title,
        title=description.title,
        overview=" ".join(description.overview),
        parts=f"{part_list}{remark}",
    )


def tell(
    surface: HapticSurface,
    title: str,
    language: Language,
    parts: Sequence[PartFacts],
    kind: SceneKind | None,
    people: int = 0,
    name_as: Callable[[str], str] = one_line,
) -> Told:
    """Return a long description. given: formats custom names, which are those of the title, of parts and materials."""
    say = Words(language)
    largest = _largest(parts)
    labels = {
        part.number: name_as(part.name) if part.name else say("part number", number=shown_number(part.number))
        for part in parts
    }
    small = [part for part in parts if part not in largest]
    share = _percent(sum(part.share for part in small), say)
    left_out = say("small part" if len(small) == 1 else "small parts", count=len(small), share=share) if small else ""
    materials = "" if any(part.material for part in largest) else materials_in_words(surface, say)
    whole = _size(surface, say), people_in_words(people, say), heights_in_words(surface, say), materials
    return Told(
        name_as(title) if title.strip() else say("nameless"),
        tuple(filter(None, whole)),
        say("part list heights" if kind == "heights" else "part list") if largest else "",
        tuple(ToldPart(labels[part.number], _sentences(part, labels, say, name_as)) for part in largest),
        left_out,
    )


def _largest(parts: Sequence[PartFacts]) -> list[PartFacts]:
    """Return the named parts and then the largest, up to MAX_PARTS, in their old order."""
    large = [part for part in parts if part.name or part.share >= MIN_SHARE]
    by_size = sorted(large, key=lambda part: (not part.name, -part.share))
    numbers = {part.number for part in by_size[:MAX_PARTS]}
    return [part for part in parts if part.number in numbers]


def _size(surface: HapticSurface, say: Words) -> str:
    width, length = (say.number(1000 * side_m) for side_m in surface.extent_m)
    relief_m = float(np.ptp(surface.height_m))
    high = say("high", relief=say.number(1000 * relief_m)) if relief_m > FLAT_M else ""
    return say("length size", width=width, length=length, high=high)


def _sentences(part: PartFacts, labels: dict[int, str], say: Words, name_as: Callable[[str], str]) -> tuple[str, ...]:
    """Return sentences on the place, size, height, material and neighbours of a part."""
    width, length = (say.number(1000 * side_m) for side_m in part.size_m)
    share = say(f"part share {next(round(100 * least) for least in SHARES if part.share >= least)}")
    high = say("part size high", height=say.number(1000 * part.height_m)) if part.height_m >= MIN_HIGH_M else ""
    size = say("part size", share=share, percent=_percent(part.share, say), width=width, length=length, high=high)
    place = say(part.place) if part.place != NOWHERE else ""
    value = "" if part.value is None else say("part value", value=say.number(part.value))
    sentences = [value, end_sentence(f"{place[:1].upper()}{place[1:]}") if place else "", size]
    if part.material:
        sentences.append(say("part feels alone", material=say.material_after_like(part.material, name_as)))
    if neighbours := [labels[neighbour] for neighbour in part.neighbours[:MAX_NEIGHBOURS]]:
        sentences.append(say("part beside", parts=", ".join(neighbours)))
    return tuple(filter(None, sentences))


def _percent(share: float, say: Words) -> str:
    """Return a share in whole per cent, or in tenths below 1 %."""
    return say.number(round(100 * share) if share >= 0.01 else max(0.1, round(100 * share, 1)))


def end_sentence(text: str) -> str:
    """Add a full stop, unless the text ends like a sentence."""
    return text if text.endswith((".", "!", "?")) else f"{text}."


def _quote(text: str, language: str) -> str:
    """Return a custom name as HTML, marked with its language if that is not the page's."""
    html = escape(one_line(text))
    return f'<span lang="{escape(language)}" dir="auto">{html}</span>' if language else html

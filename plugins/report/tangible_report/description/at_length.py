"""A surface described at length: its size, its heights, and its parts one by one from near to far."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from tangible_core.data import HapticSurface
from tangible_core.parts.words.languages import Language, Words, one_line
from tangible_core.parts.words.places import NOWHERE
from tangible_core.scene.workspace import SceneKind

from .describing import FLAT_M, heights_in_words, materials_in_words
from .facts import PartFacts

MOST_PARTS = 60
"""Parts that are described, the largest; of the others, how many they are."""
LEAST_SHARE = 0.001
"""Of the picture: a smaller part that has no name is one of those that are left out."""
LEAST_HIGH_M = 5e-5
"""Lower parts are those of the ground: their height is not said."""
MOST_BESIDE = 4
"""Neighbours of a part that are named, those of the longest borders."""
SHARES = (0.5, 0.25, 0.08, 0.0)
"""Of the picture: from each on, a part is called by another word for its size."""


class ToldPart(NamedTuple):
    """One part in words."""

    label: str
    """Its name, or `part 3`."""
    sentences: tuple[str, ...]


class Told(NamedTuple):
    """A description at length."""

    title: str
    overview: tuple[str, ...]
    """Sentences on the whole."""
    heading: str
    """Of the list of parts; empty where there are none."""
    parts: tuple[ToldPart, ...]
    """From near to far."""
    left_out: str
    """On parts that are not in the list; empty where all are."""


def describe_at_length(
    surface: HapticSurface,
    title: str,
    language: Language = "en",
    parts: Sequence[PartFacts] = (),
    kind: SceneKind | None = None,
) -> tuple[str, ...]:
    """The lines of a description at length: title, overview, heading, and a line a part with its number in the list.

    parts: from near to far, by `facts`. kind: what the scene is made of, where it is known.

    >>> describe_at_length(HapticSurface.from_heights(np.zeros((8, 8))), "A plate")
    ('A plate', '', 'A surface 80 mm wide and 80 mm long. It is flat everywhere.')
    """
    told = tell(surface, title, language, parts, kind)
    lines = [told.title, "", " ".join(told.overview)]
    if told.parts:
        lines += ["", told.heading]
    lines += [f"{place}. {ended(each.label)} {' '.join(each.sentences)}" for place, each in enumerate(told.parts, 1)]
    return (*lines, told.left_out) if told.left_out else tuple(lines)


def tell(
    surface: HapticSurface,
    title: str,
    language: Language,
    parts: Sequence[PartFacts],
    kind: SceneKind | None,
    given: Callable[[str], str] = one_line,
) -> Told:
    """A description in words. given: writes what somebody named: the title, parts, materials of their own."""
    say = Words(language)
    told = _largest(parts)
    labels = {each.number: _label(each, say, given) for each in parts}
    left = [each for each in parts if each not in told]
    share = _percent(sum(each.share for each in left), say)
    left_out = say("small part" if len(left) == 1 else "small parts", count=len(left), share=share) if left else ""
    materials = "" if any(each.material for each in told) else materials_in_words(surface, say)
    return Told(
        given(title) if title.strip() else say("nameless"),
        tuple(filter(None, [_size(surface, say), heights_in_words(surface, say), materials])),
        say("part list heights" if kind == "heights" else "part list") if told else "",
        tuple(ToldPart(labels[each.number], _sentences(each, labels, say, given)) for each in told),
        left_out,
    )


def _largest(parts: Sequence[PartFacts]) -> list[PartFacts]:
    """Those that have a name and then the largest, in the order they come in."""
    large = [each for each in parts if each.name or each.share >= LEAST_SHARE]
    ranked = sorted(large, key=lambda each: (not each.name, -each.share))
    kept = {each.number for each in ranked[:MOST_PARTS]}
    return [each for each in parts if each.number in kept]


def _label(part: PartFacts, say: Words, given: Callable[[str], str]) -> str:
    return given(part.name) if part.name else say("part number", number=part.number)


def _size(surface: HapticSurface, say: Words) -> str:
    width, length = (say.number(1000 * each) for each in surface.extent_m)
    relief_m = float(np.ptp(surface.height_m))
    high = say("high", relief=say.number(1000 * relief_m)) if relief_m > FLAT_M else ""
    return say("length size", width=width, length=length, high=high)


def _sentences(part: PartFacts, labels: dict[int, str], say: Words, given: Callable[[str], str]) -> tuple[str, ...]:
    """Where it is, how large and how high, of what, and what it borders on."""
    width, length = (say.number(1000 * each) for each in part.size_m)
    share = say(f"part share {next(round(100 * least) for least in SHARES if part.share >= least)}")
    high = say("part size high", height=say.number(1000 * part.height_m)) if part.height_m >= LEAST_HIGH_M else ""
    size = say("part size", share=share, percent=_percent(part.share, say), width=width, length=length, high=high)
    said = [_sentence(say(part.place)) if part.place != NOWHERE else "", size]
    if part.material:
        said.append(say("part feels alone", material=say.material_after_like(part.material, given)))
    if beside := [labels[each] for each in part.neighbours[:MOST_BESIDE]]:
        said.append(say("part beside", parts=", ".join(beside)))
    return tuple(filter(None, said))


def _percent(share: float, say: Words) -> str:
    """Whole ones, and tenths where it is less than one."""
    return say.number(round(100 * share) if share >= 0.01 else max(0.1, round(100 * share, 1)))


def ended(text: str) -> str:
    """With a full stop, unless it ends like a sentence."""
    return text if text.endswith((".", "!", "?")) else f"{text}."


def _sentence(words: str) -> str:
    return ended(f"{words[:1].upper()}{words[1:]}")

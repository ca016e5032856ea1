"""What a page tells of: things, each with its parts, its letter and its fill."""

from collections.abc import Sequence
from dataclasses import dataclass
from string import ascii_lowercase
from unicodedata import normalize

import numpy as np

from tangible_core.data import PartMap, Work

from ..labels import label_of

LETTERS = ascii_lowercase[1:] + ascii_lowercase[0]
"""In the order in which they are given. The last is a single dot, which a finger takes for a stray one."""


MOST_THINGS = 100
"""On a page. Their key has nine pages; nobody keeps more apart. A convention of ours."""


@dataclass(frozen=True)
class Thing:
    """One or several parts that have one name."""

    name: str
    numbers: tuple[int, ...]
    """Of its parts."""


def things_of(work: Work, parts: PartMap) -> list[Thing]:
    """Those that have a pixel, the largest first."""
    sizes = np.bincount(parts.labels.ravel(), minlength=parts.count)
    found: dict[str, list[int]] = {}
    for number in np.flatnonzero(sizes).tolist():
        found.setdefault(label_of(number, work), []).append(number)
    things = [Thing(name, tuple(numbers)) for name, numbers in found.items()]
    return sorted(things, key=lambda thing: -int(sizes[list(thing.numbers)].sum()))


def key_letters(names: Sequence[str]) -> list[str]:
    """A text for each name, of which no two are alike: its first letter, else another of its own, else any.

    One letter each where there are letters enough, else two: for no more than MOST_THINGS.
    """
    if len(names) <= len(LETTERS):
        return _chosen([_letters_in(name) for name in names], list(LETTERS))
    pairs = [first + second for first in LETTERS for second in LETTERS]
    return _chosen([_pairs_in(name) for name in names], pairs)


def _chosen(wishes: list[list[str]], others: list[str]) -> list[str]:
    """To each its first wish where nobody before it has the same, then to the rest a later one, or else another."""
    chosen = dict[int, str]()
    for most in (1, None):
        for number, own in enumerate(wishes):
            free = (each for each in (own[:most] if most else [*own, *others]) if each not in chosen.values())
            if number not in chosen and (letter := next(free, None)):
                chosen[number] = letter
    return [chosen[number] for number in range(len(wishes))]


def _letters_in(name: str) -> list[str]:
    """Without their accents, and without the last of all."""
    return [each for each in normalize("NFD", name.lower()) if each in LETTERS[:-1]]


def _pairs_in(name: str) -> list[str]:
    letters = _letters_in(name)
    return [letters[0] + each for each in letters[1:]] if letters else []

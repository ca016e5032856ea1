"""Labels of parts in files and notes; parts grouped by name, and a letter for each name."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from string import ascii_lowercase
from unicodedata import normalize

import numpy as np

from tangible_core.data import PartMap, Work
from tangible_legibility.words.languages import part_label

MAX_LISTED = 6
LETTERS = ascii_lowercase[1:] + ascii_lowercase[0]
"""Letters in the order of their use. The last, `a`, is a single dot, which a finger takes for a stray one."""
# Largest number of names on a page: their key has nine pages, and nobody remembers more. A convention of ours.
MAX_NAMES = 100


def find_label(number: int, work: Work) -> str:
    """Return the name of a part, or "part" and its number in the work's language."""
    name = work.names[number].strip() if number < len(work.names) else ""
    return part_label(name or number, work.language)


def first_labels(labels: Iterable[str]) -> str:
    """Return the first labels, each once, and the number of the others."""
    unique = list(dict.fromkeys(labels))
    more = f" and {len(unique) - MAX_LISTED} more" if len(unique) > MAX_LISTED else ""
    return ", ".join(unique[:MAX_LISTED]) + more


@dataclass(frozen=True)
class NamedParts:
    """All parts of one name."""

    name: str
    numbers: tuple[int, ...]


def group_by_name(work: Work, parts: PartMap) -> list[NamedParts]:
    """Return the parts that have a pixel, by name, the largest first."""
    sizes = np.bincount(parts.labels.ravel(), minlength=parts.count)
    numbers_of: dict[str, list[int]] = {}
    for number in np.flatnonzero(sizes).tolist():
        numbers_of.setdefault(find_label(number, work), []).append(number)
    groups = [NamedParts(name, tuple(numbers)) for name, numbers in numbers_of.items()]
    return sorted(groups, key=lambda group: -int(sizes[list(group.numbers)].sum()))


def key_letters(names: Sequence[str]) -> list[str]:
    """Return a different letter for each name, its first one if free; pairs if there are more names than letters."""
    if len(names) <= len(LETTERS):
        return _choose([_letters_in(name) for name in names], list(LETTERS))
    pairs = [first + second for first in LETTERS for second in LETTERS]
    return _choose([_pairs_in(name) for name in names], pairs)


def _choose(wishes: list[list[str]], others: list[str]) -> list[str]:
    """Return for each name its first wish, unless an earlier name has it; then a later wish, or one of the others."""
    letters = dict[int, str]()
    for most in (1, None):
        for number, own in enumerate(wishes):
            free = (wish for wish in (own[:most] if most else [*own, *others]) if wish not in letters.values())
            if number not in letters and (letter := next(free, None)):
                letters[number] = letter
    return [letters[number] for number in range(len(wishes))]


def _letters_in(name: str) -> list[str]:
    return [letter for letter in normalize("NFD", name.lower()) if letter in LETTERS[:-1]]


def _pairs_in(name: str) -> list[str]:
    letters = _letters_in(name)
    return [letters[0] + letter for letter in letters[1:]] if letters else []

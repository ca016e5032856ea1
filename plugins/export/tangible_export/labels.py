"""Labels of parts in files and notes."""

from collections.abc import Iterable

from tangible_core.data import Work
from tangible_legibility.words.languages import part_label

MOST_LISTED = 6
"""Largest number of labels in a note."""


def label_of(number: int, work: Work) -> str:
    """Return the name of a part, or "part" and its number in the work's language."""
    named = work.names[number].strip() if number < len(work.names) else ""
    return part_label(named or number, work.language)


def first_labels(labels: Iterable[str]) -> str:
    """Return the first labels, each once, and the number of the others."""
    each = list(dict.fromkeys(labels))
    more = f" and {len(each) - MOST_LISTED} more" if len(each) > MOST_LISTED else ""
    return ", ".join(each[:MOST_LISTED]) + more

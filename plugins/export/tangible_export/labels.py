"""What exporters call parts, and lists of these in notes."""

from collections.abc import Iterable

from tangible_core.data import Work
from tangible_core.parts.words.languages import part_label

MOST_LISTED = 6


def label_of(number: int, work: Work) -> str:
    """The name of a part, or its number in words of the work's language."""
    named = work.names[number].strip() if number < len(work.names) else ""
    return part_label(named or number, work.language)


def some(labels: Iterable[str]) -> str:
    """The first of them, each once, and how many more there are."""
    each = list(dict.fromkeys(labels))
    more = f" and {len(each) - MOST_LISTED} more" if len(each) > MOST_LISTED else ""
    return ", ".join(each[:MOST_LISTED]) + more

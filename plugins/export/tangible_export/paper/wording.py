"""Lists of names in notes."""

from collections.abc import Iterable

MOST_NAMES = 6


def some(names: Iterable[str]) -> str:
    """The first of them, each once, and how many more there are."""
    each = list(dict.fromkeys(names))
    more = f" and {len(each) - MOST_NAMES} more" if len(each) > MOST_NAMES else ""
    return ", ".join(each[:MOST_NAMES]) + more

"""A fill for each thing, so that neighbours differ: the colouring of a graph."""

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence

MOST_STEPS = 1000
"""Of the search that follows where the first try does not do, before it takes what there is."""

Beside = Sequence[Collection[int]]
"""The neighbours of each thing."""
Allowed = Sequence[Sequence[str]]
"""The fills that each thing may have, the plainest first; never none."""


def coloured(beside: Beside, allowed: Allowed, sizes: Sequence[float]) -> tuple[list[str], list[tuple[int, int]]]:
    """A fill for each thing, and the pairs of neighbours that have the same one though they have a choice.

    The largest is given its fill first, then the one whose neighbours leave it the fewest, and of those that are left
    it gets the one that is used least: so where there are no more things than fills, none is used twice.
    Source: Brelaz, New methods to color the vertices of a graph, 1979.
    """
    beside = [_with_a_choice(thing, others, allowed) for thing, others in enumerate(beside)]
    given = _at_once(beside, allowed, sizes)
    if alike := list(_alike(beside, given)):
        given = _searched(beside, allowed, sizes) or given
        alike = list(_alike(beside, given))
    return [given[each] for each in range(len(beside))], alike


def _with_a_choice(thing: int, others: Collection[int], allowed: Allowed) -> list[int]:
    """Of neighbours that have the one fill alone, none can be helped."""
    return [other for other in others if len({*allowed[thing], *allowed[other]}) > 1]


def _alike(beside: Beside, given: Mapping[int, str]) -> Iterator[tuple[int, int]]:
    for one in sorted(given):
        yield from ((one, other) for other in beside[one] if one < other and given[one] == given[other])


def _at_once(beside: Beside, allowed: Allowed, sizes: Sequence[float]) -> dict[int, str]:
    given, used = dict[int, str](), Counter[str]()
    while len(given) < len(beside):
        thing = _next(beside, allowed, sizes, given)
        around = [given.get(other) for other in beside[thing]]
        given[thing] = min(allowed[thing], key=lambda fill: (around.count(fill), used[fill]))
        used[given[thing]] += 1
    return given


def _searched(beside: Beside, allowed: Allowed, sizes: Sequence[float]) -> dict[int, str] | None:
    """By going back where a thing is left none; None where there is no way, or none was found in MOST_STEPS."""
    given, used = dict[int, str](), Counter[str]()
    tried = list[tuple[int, list[str]]]()
    for _ in range(MOST_STEPS):
        if len(given) == len(beside):
            return given
        thing = _next(beside, allowed, sizes, given)
        tried.append((thing, sorted(_free(thing, beside, allowed, given), key=lambda fill: used[fill])))
        while tried and not tried[-1][1]:
            tried.pop()
            if tried:
                used[given.pop(tried[-1][0])] -= 1
        if not tried:
            return None
        thing, left = tried[-1]
        given[thing] = left.pop(0)
        used[given[thing]] += 1
    return None


def _next(beside: Beside, allowed: Allowed, sizes: Sequence[float], given: Mapping[int, str]) -> int:
    left = [each for each in range(len(beside)) if each not in given]
    if not given:
        return max(left, key=lambda each: sizes[each])
    return min(left, key=lambda each: (len(_free(each, beside, allowed, given)), -sizes[each]))


def _free(thing: int, beside: Beside, allowed: Allowed, given: Mapping[int, str]) -> list[str]:
    """Those that no neighbour has."""
    around = {given.get(other) for other in beside[thing]}
    return [fill for fill in allowed[thing] if fill not in around]

"""Fills for parts so that neighbours differ, by colouring the graph of neighbours."""

from collections import Counter
from collections.abc import Collection, Mapping, Sequence

MAX_STEPS = 1000  # then the first colouring is taken as it is

Neighbours = Sequence[Collection[int]]
Allowed = Sequence[Sequence[str]]  # the plainest first; at least one


def choose_fills(
    neighbours: Neighbours, allowed: Allowed, sizes: Sequence[float]
) -> tuple[list[str], list[tuple[int, int]]]:
    """Return a fill for each vertex, and the pairs of neighbours that share one although one of them has a choice.

    The largest vertex comes first, then always the one whose neighbours leave it the fewest fills; of these it gets the
    least used one. So no fill is used twice if there are no more vertices than fills.
    Source: Brelaz, New methods to color the vertices of a graph, 1979.
    """
    neighbours = [
        [other for other in others if len({*allowed[vertex], *allowed[other]}) > 1]  # others are bound to be alike
        for vertex, others in enumerate(neighbours)
    ]
    fills = _search(neighbours, allowed, sizes) or _colour_greedily(neighbours, allowed, sizes)
    alike = [
        (one, other) for one in sorted(fills) for other in neighbours[one] if one < other and fills[one] == fills[other]
    ]
    return [fills[vertex] for vertex in range(len(neighbours))], alike


def _colour_greedily(neighbours: Neighbours, allowed: Allowed, sizes: Sequence[float]) -> dict[int, str]:
    fills, uses = dict[int, str](), Counter[str]()
    while len(fills) < len(neighbours):
        vertex = _next(neighbours, allowed, sizes, fills)
        around = [fills.get(other) for other in neighbours[vertex]]
        fills[vertex] = min(allowed[vertex], key=lambda fill: (around.count(fill), uses[fill]))
        uses[fills[vertex]] += 1
    return fills


def _search(neighbours: Neighbours, allowed: Allowed, sizes: Sequence[float]) -> dict[int, str] | None:
    """Search with backtracking; None if no colouring exists, or none was found in MAX_STEPS."""
    fills, uses = dict[int, str](), Counter[str]()
    open_choices = list[tuple[int, list[str]]]()
    for _ in range(MAX_STEPS):
        if len(fills) == len(neighbours):
            return fills
        vertex = _next(neighbours, allowed, sizes, fills)
        free = sorted(_free(vertex, neighbours, allowed, fills), key=lambda fill: uses[fill])
        open_choices.append((vertex, free))
        while open_choices and not open_choices[-1][1]:
            open_choices.pop()
            if open_choices:
                uses[fills.pop(open_choices[-1][0])] -= 1
        if not open_choices:
            return None
        vertex, free_fills = open_choices[-1]
        fills[vertex] = free_fills.pop(0)
        uses[fills[vertex]] += 1
    return None


def _next(neighbours: Neighbours, allowed: Allowed, sizes: Sequence[float], fills: Mapping[int, str]) -> int:
    vertices = [vertex for vertex in range(len(neighbours)) if vertex not in fills]
    if not fills:
        return max(vertices, key=lambda vertex: sizes[vertex])
    return min(vertices, key=lambda vertex: (len(_free(vertex, neighbours, allowed, fills)), -sizes[vertex]))


def _free(vertex: int, neighbours: Neighbours, allowed: Allowed, fills: Mapping[int, str]) -> list[str]:
    around = {fills.get(other) for other in neighbours[vertex]}
    return [fill for fill in allowed[vertex] if fill not in around]

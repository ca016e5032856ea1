"""Joining of neighbouring regions, the pair first that people are least likely to keep apart. Compiled by numba."""

import numpy as np
from jaxtyping import Float64, Int32

from tangible_core.compiled import KERNEL, inner, logarithm, njit

from .regions import Regions

TERMS = 6
_NONE = -1


def join_regions(
    regions: Regions, weights: Float64[np.ndarray, "terms"], constant: float, record: Float64[np.ndarray, "rows 8"]
) -> tuple[Int32[np.ndarray, "joins 2"], Float64[np.ndarray, "joins"], int]:
    """Join the two neighbours whose border costs least, until one is left; return joins, costs and rows written."""
    # That of joining i is node n + i, as in SciPy's linkages. A program that fits weights passes rows for the two nodes
    # and the terms of each border whenever it is measured.
    count, borders = len(regions.areas), len(regions.borders)
    joins, costs = np.empty((count - 1, 2), np.int32), np.empty(count - 1)
    owners = np.concatenate([regions.borders[:, 0], regions.borders[:, 1]]).astype(np.int32)
    links, first, marks = (np.full(size, _NONE, np.int32) for size in (2 * borders, count, count))
    areas, colours, roughness = (sums.copy() for sums in (regions.areas, regions.colours, regions.roughness))
    pairs, strengths, prices = regions.pairs.copy(), regions.strengths.copy(), np.empty(borders)
    rows = _join(
        areas, colours, roughness, owners, links, first, marks, np.arange(count, dtype=np.int32), pairs, strengths,
        prices, weights, constant, np.empty(TERMS), record, joins, costs,
    )  # fmt: skip
    return joins, costs, rows


@njit(**KERNEL)
def _join(
    areas, colours, roughness, owners, links, first, marks, nodes, pairs, strengths, prices, weights, constant, terms,
    record, joins, costs,
):  # fmt: skip
    count, borders, rows, total = areas.size, prices.size, 0, areas.sum()
    # The borders of a region are a linked list of half borders: those of border b are b and b + len(prices).
    for half in range(2 * borders - 1, -1, -1):
        links[half], first[owners[half]] = first[owners[half]], half
    for border in range(borders):
        one, other = owners[border], owners[border + borders]
        _measure(areas, colours, roughness, one, other, pairs[border], strengths[border], total, terms)
        prices[border] = _price(terms, weights, constant)
        rows = _record(record, rows, nodes[one], nodes[other], terms)
    for step in range(count - 1):
        best = np.argmin(prices)
        one, absorbed = owners[best], owners[best + borders]
        joins[step, 0], joins[step, 1], costs[step] = nodes[one], nodes[absorbed], prices[best]
        nodes[one] = count + step
        areas[one] += areas[absorbed]
        for at in range(colours.shape[1]):
            colours[one, at] += colours[absorbed, at]
        for at in range(roughness.shape[1]):
            roughness[one, at] += roughness[absorbed, at]
        _join_borders(one, absorbed, owners, links, first, marks, pairs, strengths, prices)
        half = first[one]
        while half != _NONE:
            border, other = half % borders, owners[(half + borders) % (2 * borders)]
            _measure(areas, colours, roughness, one, other, pairs[border], strengths[border], total, terms)
            prices[border] = _price(terms, weights, constant)
            rows = _record(record, rows, nodes[one], nodes[other], terms)
            half = links[half]
    return rows


@inner()
def _join_borders(one, absorbed, owners, links, first, marks, pairs, strengths, prices):
    """Give the borders of a region to another; of two with the same neighbour the second is added to the first."""
    # Each border has two halves, h and h + borders, one in the list of either region: `links` chains the halves of a
    # region from `first`. `marks` is _NONE everywhere before and after; within, it has the border kept for each
    # neighbour.
    borders = prices.size
    last_half, head = _NONE, _NONE
    for start in (first[one], first[absorbed]):
        half = start
        while half != _NONE:
            following, border = links[half], half % borders
            owners[half] = one
            other = owners[(half + borders) % (2 * borders)]
            if other in (one, absorbed):
                prices[border] = np.inf
            elif prices[border] < np.inf:
                if marks[other] == _NONE:
                    marks[other] = border
                    if last_half == _NONE:
                        head = half
                    else:
                        links[last_half] = half
                    last_half = half
                else:
                    pairs[marks[other]] += pairs[border]
                    strengths[marks[other]] += strengths[border]
                    prices[border] = np.inf
            half = following
    if last_half != _NONE:
        links[last_half] = _NONE
    first[one] = head
    half = head
    while half != _NONE:
        marks[owners[(half + borders) % (2 * borders)]] = _NONE
        half = links[half]


@inner()
def _measure(areas, colours, roughness, one, other, pairs, strength, total, terms):
    """Write the terms of a border's cost: strength, roughness, colour, and logarithms of both areas and its length."""
    alike = 0.0
    for at in range(roughness.shape[1]):
        alike += np.sqrt((roughness[one, at] / areas[one]) * (roughness[other, at] / areas[other]))
    redder = colours[one, 1] / areas[one] - colours[other, 1] / areas[other]
    yellower = colours[one, 2] / areas[one] - colours[other, 2] / areas[other]
    terms[0] = strength / pairs
    terms[1] = np.sqrt(max(0.0, 1 - alike))
    terms[2] = np.sqrt(np.sqrt(redder * redder + yellower * yellower))
    terms[3] = logarithm(np.float32(min(areas[one], areas[other]) / total))
    terms[4] = logarithm(np.float32(max(areas[one], areas[other]) / total))
    terms[5] = logarithm(np.float32(pairs / np.sqrt(total)))


@inner()
def _price(terms, weights, constant):
    price = constant
    for at in range(terms.size):
        price += weights[at] * terms[at]
    return price


@inner()
def _record(record, rows, one, other, terms):
    if rows == len(record):
        return rows
    record[rows, 0], record[rows, 1] = one, other
    for at in range(terms.size):
        record[rows, 2 + at] = terms[at]
    return rows + 1

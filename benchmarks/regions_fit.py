"""Fit the weights of `hierarchy` to regions that people drew: `python -m benchmarks.regions_fit` prints them.

First the weights of cues at cells, by the share of people with a border there; then, in ROUNDS, the weights of a
border's cost, by the share of people who keep apart what it separates: over all borders that the joining with the
weights of the round before looks at, as in Nunez-Iglesias et al., PLoS ONE 8, 2013.
"""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false, reportUnknownMemberType=false

from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np
from numba import njit
from scipy.ndimage import distance_transform_edt
from scipy.optimize import minimize

from tangible_bench.metrics.segments import contingency
from tangible_core.data import SegmentTree, to_rgb
from tangible_core.data.views import border_pixels
from tangible_networks.seeing import look_for_borders
from tangible_texture.features.cells import channels
from tangible_texture.tree.cues import (
    Tensors,
    border_tensors,
    opponent_colours,
    reduce_to_cells,
    shares,
    tensors,
    weighted_strength,
)
from tangible_texture.tree.joining import TERMS, join_regions
from tangible_texture.tree.regions import Regions, measure_regions, small_regions

from .regions_drawn import UNSEEN, Photograph, photographs

ROUNDS, SAMPLES = 4, 5000  # the rounds of fitting, and the borders taken from each photograph in each of them
# The cells taken from each photograph, nearer to a drawn border than this or farther than that from all.
PLACES, NEAR_CELLS, FAR_CELLS = 12_000, 0.8, 3
SIZE_POWER = 0.6  # the power of the smaller region's share of the picture that weights a border
RIDGE = 1e-3  # the penalty on squared weights of standardised terms


class Model(NamedTuple):
    """All weights: of cues at cells, of cues at borders, of the terms of a border, and the constant."""

    at_cells: np.ndarray
    at_borders: np.ndarray
    terms: np.ndarray
    constant: float


class Prepared(NamedTuple):
    """What does not depend on weights."""

    photograph: Photograph
    colours: np.ndarray
    roughness: np.ndarray
    cues: Tensors
    drawn: list[np.ndarray]  # the people's labels of cells


def prepare(photograph: Photograph, seen: bool = False) -> Prepared:
    """Compute the cues of a photograph, and reduce the drawn regions to its cells. seen: with a network's borders."""
    colours = opponent_colours(reduce_to_cells(channels(photograph.picture, colour=True)))
    assert colours is not None
    held = shares(colours)
    size = colours.shape[:0:-1]
    drawn = [cv2.resize(each, size, interpolation=cv2.INTER_NEAREST) for each in photograph.drawn]
    cues = tensors(colours[0], held)
    if seen:
        borders = look_for_borders(to_rgb(photograph.picture), colours.shape[1:])
        assert borders is not None, "no network is here; `tangible networks add borders`"
        cues = np.concatenate([cues, border_tensors(borders)])
    return Prepared(photograph, colours, held["roughness"], cues, drawn)


def fit(prepared: Sequence[Prepared]) -> Model:
    """Fit all weights."""
    rng = np.random.default_rng(1)
    strengths, near = _stacked([_cells(each, rng) for each in prepared])
    at_cells, _ = _logistic(strengths, near)
    model = Model(at_cells, at_cells, np.array([1.0] + [0.0] * (TERMS - 1)), 0.0)
    measured = [Measured(each, at_cells) for each in prepared]
    rows: list[tuple[np.ndarray, ...]] = []
    for _ in range(ROUNDS):
        rows += [each.seen(model, rng) for each in measured]
        terms, apart, sizes = _stacked(rows)
        weights, constant = _logistic(terms, apart, sizes**SIZE_POWER, len(at_cells) + 2)
        model = Model(at_cells, weights[: len(at_cells)], np.r_[1.0, weights[len(at_cells) :]], constant)
    return model


def tree(prepared: Prepared, model: Model) -> SegmentTree:
    """Return the tree of a photograph's cells by a model's weights; its levels are costs."""
    return Measured(prepared, model.at_cells).tree(model)


class Measured:
    """The small regions of a photograph, with the strength of each cue at each border."""

    def __init__(self, prepared: Prepared, at_cells: np.ndarray) -> None:
        cells = small_regions(weighted_strength(prepared.cues, at_cells.astype(np.float32)))
        each = [
            measure_regions(cells, prepared.colours, prepared.roughness, prepared.cues, one)
            for one in _each_alone(prepared.cues)
        ]
        self.regions: Regions = each[0]
        self.strengths = np.stack([regions.strengths for regions in each], axis=1)
        self.drawn = [contingency(cells, labels).astype(np.float64) for labels in prepared.drawn]

    def tree(self, model: Model) -> SegmentTree:
        """Return the tree of cells, whose levels are costs."""
        joins, costs, _ = self._join(model, 0)
        return SegmentTree(self.regions.labels, joins, np.maximum.accumulate(costs).astype(np.float32))

    def seen(self, model: Model, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return of some borders the terms, cue by cue, the share of people who keep them, and the smaller area."""
        joins, _, rows = self._join(model, 100_000)
        rows = rows[rng.choice(len(rows), min(SAMPLES, len(rows)), replace=False)]
        one, other = rows[:, 0].astype(int), rows[:, 1].astype(int)
        first, last = _leaves(joins)
        ends = first[self.regions.borders]
        bounds = np.stack([first[one], last[one], first[other], last[other]], axis=1)
        cues = np.zeros((len(rows), self.strengths.shape[1]))
        _add_between(bounds, ends, self.strengths, self.regions.pairs, cues)
        nodes = [_nodes(counts, joins) for counts in self.drawn]
        apart = np.mean([1 - (held[one] * held[other]).sum(axis=1) for held in nodes], axis=0)
        return np.hstack([cues, rows[:, 3:]]), apart, np.exp(rows[:, 5])

    def _join(self, model: Model, most: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        seen = np.empty((most, TERMS + 2))
        regions = self.regions._replace(strengths=self.strengths @ model.at_borders)
        joins, costs, count = join_regions(regions, model.terms, model.constant, seen)
        return joins, costs, seen[:count]


@njit
def _add_between(bounds, ends, strengths, pairs, cues):
    """Write the mean strengths of the borders between two nodes, each with the places of its leaves."""
    for row in range(len(bounds)):
        low, high, start, stop = bounds[row]
        count = 0.0
        for border in range(len(ends)):
            one, other = ends[border]
            if low <= other < high:
                one, other = other, one
            if low <= one < high and start <= other < stop:
                count += pairs[border]
                cues[row] += strengths[border]
        cues[row] /= count


def _cells(prepared: Prepared, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    away = [np.asarray(distance_transform_edt(~border_pixels(each))) for each in prepared.drawn]
    near = np.mean([each <= NEAR_CELLS for each in away], axis=0).ravel()
    at = np.flatnonzero((near > 0) | (np.min(away, axis=0) > FAR_CELLS).ravel())
    at = rng.choice(at, min(PLACES, at.size), replace=False)
    strengths = [weighted_strength(prepared.cues, one).ravel()[at] for one in _each_alone(prepared.cues)]
    return np.stack(strengths, axis=1), near[at]


def _each_alone(cues: Tensors) -> list[np.ndarray]:
    return list(np.eye(len(cues), dtype=np.float32))


def _stacked(rows: Sequence[tuple[np.ndarray, ...]]) -> list[np.ndarray]:
    """Return the first arrays of all rows as one, then the second ones, and on."""
    return [np.concatenate(each) for each in zip(*rows, strict=True)]


def _leaves(joins: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    count = len(joins) + 1
    sizes, first = np.ones(count + len(joins), int), np.zeros(count + len(joins), int)
    for at, (one, other) in enumerate(joins):
        sizes[count + at] = sizes[one] + sizes[other]
    for at in reversed(range(len(joins))):
        one, other = joins[at]
        first[one], first[other] = first[count + at], first[count + at] + sizes[one]
    return first, first + sizes


def _nodes(counts: np.ndarray, joins: np.ndarray) -> np.ndarray:
    nodes = np.vstack([counts, np.zeros((len(joins), counts.shape[1]))])
    for at, (one, other) in enumerate(joins):
        nodes[len(counts) + at] = nodes[one] + nodes[other]
    return nodes / nodes.sum(axis=1, keepdims=True)


def _logistic(
    terms: np.ndarray, wanted: np.ndarray, weights: np.ndarray | None = None, positive: int | None = None
) -> tuple[np.ndarray, float]:
    middle, spread = terms.mean(axis=0), terms.std(axis=0) + 1e-9
    scaled = np.c_[(terms - middle) / spread, np.ones(len(terms))]
    heavy = np.ones(len(terms)) if weights is None else weights
    heavy = heavy / heavy.sum()
    ridge = np.r_[np.full(terms.shape[1], RIDGE), 0.0]

    def loss(at: np.ndarray) -> tuple[float, np.ndarray]:
        logits = scaled @ at
        off = 1 / (1 + np.exp(-logits)) - wanted
        value = (heavy * (np.logaddexp(0, logits) - wanted * logits)).sum() + 0.5 * (ridge * at * at).sum()
        return float(value), scaled.T @ (heavy * off) + ridge * at

    free = 0 if positive is None else terms.shape[1] - positive
    bounds = [(0, None)] * (terms.shape[1] - free) + [(None, None)] * (free + 1)
    best = minimize(loss, np.zeros(scaled.shape[1]), jac=True, method="L-BFGS-B", bounds=bounds).x
    slopes = best[:-1] / spread
    return slopes, float(best[-1] - (middle * slopes).sum())


def main() -> None:
    """Print the weights fitted to all photographs, and those with a network that did not see them."""
    for end in ("", UNSEEN):
        model = fit([prepare(photograph, seen=bool(end)) for photograph in photographs(end).values()])
        for name, values in model._asdict().items():
            print(name, np.array2string(np.asarray(values), precision=3, separator=", ", suppress_small=True))


if __name__ == "__main__":
    main()

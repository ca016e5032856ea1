"""Segments by the borders that people would draw: a tree of regions, cut where asked."""

import logging
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from jaxtyping import Float32
from pydantic import Field

from tangible_core.data import SegmentMap, SegmentTree, check_picture, to_rgb
from tangible_core.plugins import Hierarchical, note

from .signal.skipping import Dividing, one_segment

log: logging.Logger = logging.getLogger(__name__)

# The level of a border that chance makes: such regions are joined, however many segments are requested.
MIN_LEVEL = 0.12


class Hierarchy(Dividing, Hierarchical):
    """Regions that people would draw in a photograph: small ones, joined pair by pair into a tree.

    The default for a photograph: people, animals, things and the ground become regions that you can name and raise.
    `gabor` finds one material in several places, and `gradient` is faster where shapes have even colours.

    >>> import numpy as np
    >>> from tangible import Hierarchy
    >>> picture = np.zeros((64, 96), np.uint8)
    >>> picture[:, 48:] = 200
    >>> Hierarchy().segment(picture).labels[0, [47, 48]].tolist()
    [0, 1]

    How strongly the picture changes at each of 40,000 cells is a weighted sum of changes in brightness, colour,
    roughness and direction. Its basins are the smallest regions, and the two neighbours that people are least likely to
    keep apart are joined, again and again. The weights are fitted to the regions that people drew in 40 photographs;
    the level of a border is the share of people who are expected to draw it. A network of borders (`tangible networks
    add borders`) is one more cue, whose weights are fitted to 60 photographs that it was not trained on. The result
    does not depend on the picture's size, gain or offset. Labels are in the order of their first pixels, row by row.
    Confidence is the level at which a segment would be joined with another.
    Memory: 40 bytes a pixel and 16 MiB.
    Sources: Arbelaez, Maire, Fowlkes & Malik, Contour detection and hierarchical image segmentation, IEEE TPAMI 33,
    2011 (cues, levels); Nunez-Iglesias et al., Machine learning of hierarchical clustering to segment 2D and 3D images,
    PLoS ONE 8, 2013 (weights fitted along the joinings).
    """

    segments: Annotated[int, Field(ge=1)] | Literal["auto"] = "auto"
    """Largest number of segments, fewer where borders have levels under 0.12, as in noise; `auto`: as many as have
    borders of at least `level`, at most 64, reported with the level of the weakest border."""
    level: Annotated[float, Field(ge=0.02, lt=1)] = 0.5
    """Lowest level of a border under `auto`: the share of people who would draw it. Less gives more and finer segments.
    """

    def reads(self) -> tuple[Path, ...]:
        """Return the network of borders, if there is one."""
        from tangible_networks.store import networks_here

        return tuple(network.path for network in networks_here("borders")[:1])

    def segment(self, picture: np.ndarray) -> SegmentMap:
        """Divide the picture along the borders of highest level. Raises: PictureError as `check_picture`."""
        from .regions.merging import number_in_reading_order
        from .regions.watershed import MAX_SEGMENTS

        if self.segments == 1:
            return one_segment(check_picture(picture).shape[:2])
        tree = self.tree(picture)
        most, level = (MAX_SEGMENTS, self.level) if self.segments == "auto" else (self.segments, MIN_LEVEL)
        division = tree.cut(most, level)
        if self.segments == "auto" and division.count > 1:
            weakest = tree.levels[len(tree.levels) + 1 - division.count]
            why = "the level of the weakest border between two segments"
            note(log, f"segments: {division.count}, estimated with confidence {weakest:.2f}: {why}")
        return SegmentMap(number_in_reading_order(division.labels), division.confidence)

    def tree(self, picture: np.ndarray) -> SegmentTree:
        """Divide the picture into its smallest regions, and join them down to one. Raises: PictureError."""
        from tangible_core.compiled import exponentials

        from .features.cells import channels
        from .regions.refining import refine_regions
        from .tree.cues import border_tensors, opponent_colours, reduce_to_cells, shares, tensors, weighted_strength
        from .tree.joining import join_regions
        from .tree.regions import measure_regions, small_regions
        from .tree.weights import WITH_BORDERS, WITHOUT

        paint = channels(picture, colour=True)
        colours = opponent_colours(reduce_to_cells(paint))
        if colours is None:
            return SegmentTree(np.zeros(picture.shape[:2], np.int32), np.empty((0, 2), np.int32))
        kind_shares = shares(colours)
        cues, weights, borders = tensors(colours[0], kind_shares), WITHOUT, self._borders(picture, colours.shape[1:])
        if borders is not None:
            cues, weights = np.concatenate([cues, border_tensors(borders)]), WITH_BORDERS
        cells = small_regions(weighted_strength(cues, weights.at_cells))
        regions = measure_regions(cells, colours, kind_shares["roughness"], cues, weights.at_borders)
        unseen = np.empty((0, weights.terms.size + 2))
        joins, costs, _ = join_regions(regions, weights.terms, weights.constant, unseen)
        rising = np.maximum.accumulate(costs) if costs.size else costs
        return SegmentTree(refine_regions(cells, paint), joins, 1 / (1 + exponentials(-rising)))

    def _borders(self, picture: np.ndarray, shape: tuple[int, int]) -> Float32[np.ndarray, "r c"] | None:
        if not self.reads():
            return None
        from tangible_networks.seeing import look_for_borders

        return look_for_borders(to_rgb(picture), shape)

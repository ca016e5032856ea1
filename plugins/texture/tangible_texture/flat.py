"""Segments of a flat drawing: its areas of one colour."""

from typing import Annotated

import numpy as np
from pydantic import Field

from tangible_core.data import SegmentMap, Views, check_picture, is_one_colour
from tangible_core.drawing import find_areas
from tangible_core.plugins import Segmenter, Skippable


class Flat(Segmenter, Skippable):
    """The colours of a flat drawing, such as a map or a chart, each a segment.

    The insides of areas are connected pixels that differ little from their neighbours; areas of nearly one colour have
    one number, so that light may change slowly over a scanned page. The blur of edges, noise and JPEG are undone: an
    edge lies where half of the change from one area to the other is done. Lines and letters, which are thin and darker
    than their ground, go to the area next to them. Of more colours than `segments`, those of the smallest areas become
    the ones that they resemble most. Labels are in the order of size. Made for drawings: in a photograph hardly
    anything is of one colour.
    """

    segments: Annotated[int, Field(ge=1)] = 32
    """Largest number of colours."""

    def skip(self, views: Views) -> str | None:
        """Return a reason to make one segment: one flat colour; None otherwise."""
        return "the picture is one flat colour" if is_one_colour(views.left) else None

    def segment(self, picture: np.ndarray) -> SegmentMap:
        """Divide the picture by its colours, with confidence 1. Raises: PictureError as `check_picture`."""
        areas = find_areas(check_picture(picture))
        first, rest = areas.colours[: self.segments], areas.colours[self.segments :]
        nearest = np.abs(rest[:, None] - first).sum(axis=2).argmin(axis=1)
        numbers = np.concatenate([np.arange(len(first)), nearest])
        labels = numbers[areas.labels]
        used = np.bincount(labels.reshape(-1)) > 0
        return SegmentMap((np.cumsum(used) - 1).astype(np.int32)[labels])

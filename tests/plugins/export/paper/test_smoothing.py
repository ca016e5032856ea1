"""Smooth outlines: if a case fails, a finger follows stairs of pixels, or another shape than the part's."""

import numpy as np
import pytest
import shapely

from tangible_core.data import PartMap
from tangible_export.paper.smoothing import smooth_borders

WIDTH_MM = 180.0


def disc_and_halves(columns: int, radius_mm: float) -> PartMap:
    """A disc in the middle of a picture, on a ground of two halves."""
    at = (np.arange(columns) + 0.5) * WIDTH_MM / columns - WIDTH_MM / 2
    labels = np.where(at[None, :] < 3.3, 0, 1) * np.ones((columns, 1), np.int32)
    labels[at[:, None] ** 2 + at[None, :] ** 2 < radius_mm**2] = 2
    return PartMap(labels.astype(np.int32), (0, 1, 2))


def points_along(shape, every_mm: float = 0.1) -> np.ndarray:
    line = shape.exterior
    return shapely.get_coordinates(shapely.line_interpolate_point(line, np.arange(0, line.length, every_mm)))


@pytest.mark.parametrize(
    ("columns", "radius_mm"), [(180, 60.0), (400, 20.0), pytest.param(720, 60.0, marks=pytest.mark.whole)]
)
def test_smooth_border_of_a_disc_is_the_circle_without_stairs(columns, radius_mm):
    disc = smooth_borders(disc_and_halves(columns, radius_mm), WIDTH_MM)[2]
    off = np.abs(np.hypot(*points_along(disc).T) - radius_mm)
    assert off.mean() < 0.1
    assert np.percentile(off, 99) < 0.5 * WIDTH_MM / columns
    ahead = np.diff(shapely.get_coordinates(disc), axis=0)
    turns = np.angle(np.exp(1j * np.diff(np.arctan2(ahead[:, 1], ahead[:, 0]))))
    assert (np.abs(turns) > np.radians(45)).sum() <= 2, "right angles are left at the two places where parts meet alone"


def test_smooth_borders_are_shared_and_fill_the_picture():
    parts = disc_and_halves(400, 30)
    shapes = smooth_borders(parts, WIDTH_MM)
    assert sum(shape.area for shape in shapes) == pytest.approx(WIDTH_MM**2, rel=1e-9)
    assert all(one.intersection(other).area == 0 for one in shapes for other in shapes if one is not other)
    assert shapely.union_all(shapes).equals(shapely.box(-90, -90, 90, 90))
    assert shapely.coverage_is_valid(list(shapes))


def test_smooth_border_of_a_small_disc_keeps_its_area():
    """A Gaussian shrinks a circle by s^2 / 2 r, the second pass takes it back."""
    labels = (disc_and_halves(720, 6).labels == 2).astype(np.int32)
    _, disc = smooth_borders(PartMap(labels, (0, 1)), WIDTH_MM)
    assert disc.area == pytest.approx(labels.sum() * (WIDTH_MM / 720) ** 2, rel=5e-3)


def test_lines_have_no_more_points_than_they_need():
    """An arc that is 0.02 mm off its chord spans 2 arccos(1 - 0.02 / r), so a circle of 20 mm needs 70 chords."""
    ground, disc = smooth_borders(PartMap((disc_and_halves(720, 20).labels == 2).astype(np.int32), (0, 1)), WIDTH_MM)
    assert 40 < len(disc.exterior.coords) < 200
    assert np.hypot(*points_along(disc).T) == pytest.approx(20, abs=0.15)
    assert len(ground.exterior.coords) == 5
    left, right = smooth_borders(PartMap((np.indices((90, 120))[1] > 70).astype(np.int32), (0, 1)), WIDTH_MM)
    assert len(left.exterior.coords) == len(right.exterior.coords) == 5

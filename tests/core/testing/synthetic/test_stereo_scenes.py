"""Synthetic pairs. Otherwise depth methods would be measured against a wrong truth."""

import numpy as np
import pytest

from tangible_bench.metrics.standard_sets import visible_pixels
from tangible_core.testing.synthetic.stereo_scenes import (
    SCENES,
    Surface,
    cap,
    everywhere,
    rectangle,
    right_view,
    slanted_plane,
    synthetic_pair,
    texture,
    truly_visible,
)

SHAPE = (24, 96)


def step(far: float, near: float, edge: int = 60) -> list[Surface]:
    return [slanted_plane(1, everywhere, far), slanted_plane(2, rectangle(edge - 0.5, -1, 1000, 1000), near)]


@pytest.mark.parametrize(("far", "near"), [(3, 8), (0, 17), (5.25, 9.75)])
def test_visible_occluded_strip_at_a_step_is_as_wide_as_the_jump(far: float, near: float):
    hidden = ~truly_visible(step(far, near), SHAPE)
    columns = np.arange(SHAPE[1])
    occluded = (columns - far >= 59.5 - near) & (columns < 60)
    outside = columns - far < -0.5
    np.testing.assert_array_equal(hidden, np.tile(occluded | outside, (SHAPE[0], 1)))
    if float(near - far).is_integer():
        assert occluded.sum() == near - far


@pytest.mark.parametrize(
    "surface",
    [
        slanted_plane(1, everywhere, 6.3),
        slanted_plane(1, everywhere, 12, 0.08, -0.05),
        slanted_plane(1, everywhere, 12, -0.2, 0.1),
        cap(1, (48, 12), 60, 9.5),
        cap(1, (40, 10), 80, 3.0, flatness=1.0),
    ],
)
def test_right_view_shows_the_surface_at_its_disparity(surface: Surface):
    """The right view at x - d(x) shows the surface at x: its texture there, and nothing that was resampled."""
    rows, columns = np.indices(SHAPE, np.float64)
    seen = surface.seen_at(columns, rows)
    np.testing.assert_allclose(seen - surface.disparity_px(seen, rows), columns, atol=1e-9)
    inside = surface.region(seen, rows)
    np.testing.assert_allclose(
        right_view([surface], SHAPE)[inside], texture(1, seen, rows)[inside], atol=40 * (~inside).any()
    )


@pytest.mark.parametrize("name", SCENES)
def test_synthetic_pair_is_repeatable_and_well_formed(name: str):
    pair = synthetic_pair(name, 160, 120, seed=2)
    again = synthetic_pair(name, 160, 120, seed=2)
    assert pair.digest() == again.digest()
    assert pair.digest() != synthetic_pair(name, 160, 120, seed=3).digest()
    assert pair.views.left.dtype == pair.views.right.dtype == np.uint8
    assert pair.truth_px.shape == pair.visible.shape == (120, 160)
    assert pair.truth_px.min() > 0
    assert pair.truth_px.max() < 0.2 * 160
    assert 0.8 < pair.visible.mean() < 1
    # The mask that is made from pixels alone agrees with the exact one except next to edges.
    assert (visible_pixels(pair.truth_px) == pair.visible).mean() > 0.98


@pytest.mark.parametrize("name", SCENES)
def test_synthetic_pair_truth_explains_the_right_view(name: str):
    """Linear interpolation of the right view at x - d tells visible pixels from hidden ones."""
    pair = synthetic_pair(name, 200, 120)
    rows, columns = np.indices(pair.truth_px.shape)
    place = columns - pair.truth_px
    left, share = np.floor(place).astype(int), place % 1
    right = pair.views.right.astype(float)
    sampled = (1 - share) * right[rows, left.clip(0, 199)] + share * right[rows, (left + 1).clip(0, 199)]
    error = np.abs(sampled - pair.views.left)
    assert np.median(error[pair.visible]) < 6
    assert np.median(error[~pair.visible]) > 15

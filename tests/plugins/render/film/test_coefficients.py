"""A frame of a video would feel different from the same still surface."""

import numpy as np
import pytest

from rough_surfaces import rough_surfaces
from tangible_render.film.film import HIGHEST_M, quick_coefficients
from tangible_render.film.scratch import MARGIN, RING, Scratch
from tangible_render.surface.coefficients import spline_coefficients
from tangible_render.surface.jumps import jumps

RNG = np.random.default_rng(3)
ROW, COLUMN = np.indices((61, 97))
HEIGHTS = {
    **{name: each.height_m for name, each in rough_surfaces().items()},
    "waves": 0.01 + 0.005 * np.sin(COLUMN / 7 + ROW / 9),
    "steps": 0.002 + 0.01 * (COLUMN > 40) + 0.003 * (ROW + 0.3 * COLUMN > 50),
    "a step at the border": 0.002 + 0.01 * (COLUMN > 0) + 0.003 * (ROW < 1),
    "two by the border": 0.002 + 0.01 * (COLUMN > 1) + 0.003 * (ROW < 2),
    "noise": RNG.uniform(0, 0.02, (43, 61)),
    "as small as is filtered": RNG.uniform(0, 0.02, (MARGIN + 1, MARGIN + 1)),
    "smaller": RNG.uniform(0, 0.02, (MARGIN, 40)),
    "one cell": np.array([[0.003]]),
}


def coefficients_of(heights: np.ndarray) -> tuple[np.ndarray, Scratch]:
    height_m = np.asarray(heights, np.float32)
    scratch = Scratch.of(*height_m.shape)
    for each in scratch:
        each.fill(1)  # what was there before does not matter
    return quick_coefficients(height_m, scratch), scratch


@pytest.mark.parametrize("name", HEIGHTS)
def test_coefficients_of_a_frame_match_a_still_surface(name: str):
    """The error is within 0.2 micrometres of 20 mm, at jumps too: no groove, no lip."""
    heights = np.asarray(HEIGHTS[name], np.float32)
    found, scratch = coefficients_of(heights)
    assert np.abs(found - spline_coefficients(heights)).max() <= 1e-5 * heights.max()
    if min(heights.shape) > MARGIN:
        assert np.array_equal(scratch.near[RING:-RING, RING:-RING].astype(bool), jumps(heights))


def test_level_ground_has_level_coefficients_to_the_last_bit():
    found, _ = coefficients_of(np.full((40, 50), 0.00731))
    assert np.unique(found).size == 1
    assert found[0, 0] == pytest.approx(0.00731, rel=1e-6)


@pytest.mark.parametrize("shape", [(1, 1), (40, 50)])
def test_heights_beyond_the_bound_are_cut_and_finite(shape: tuple[int, int]):
    found, _ = coefficients_of(np.full(shape, 3e38))
    assert np.isfinite(found).all()
    assert found.max() == pytest.approx(HIGHEST_M, rel=1e-6)

"""`HapticSurface.height_at` and `normal_at`, next to the spline that the default law renders."""

import numpy as np

from tangible_core import HapticSurface
from tangible_render.surface import spline
from tangible_render.surface.coefficients import spline_coefficients

WIDTH_M, CELLS, WAVE_M, AMPLITUDE_M = 0.08, 64, 0.02, 0.001
PITCH_M = WIDTH_M / CELLS
TURN = 2 * np.pi / WAVE_M


def test_heights_and_normals_are_those_of_the_default_law_within_the_stated_bound():
    """On a wave along x and y, known by its formula, between all but the outermost centres."""
    centres = (np.arange(CELLS) + 0.5) * PITCH_M - WIDTH_M / 2
    waves = np.sin(TURN * centres) + np.sin(TURN * -centres)[:, None]
    surface = HapticSurface.from_heights(AMPLITUDE_M * (2 + waves), WIDTH_M)
    coefficients = spline_coefficients(surface.height_m)
    x, y = np.random.default_rng(5).uniform(-0.036, 0.036, (2, 400))
    felt = np.array([spline.slope(coefficients, 1 / PITCH_M, 1 / PITCH_M, *place) for place in zip(x, y, strict=True)])
    formula = AMPLITUDE_M * (2 + np.sin(TURN * x) + np.sin(TURN * y))
    curvature = AMPLITUDE_M * TURN**2
    np.testing.assert_allclose(felt[:, 0], formula, atol=0.002 * AMPLITUDE_M)
    bound_m = 2 * curvature * PITCH_M**2 / 8  # along x and along y
    assert 0.8 * bound_m < np.abs(surface.height_at(x, y) - felt[:, 0]).max() < 1.02 * bound_m
    normals = surface.normal_at(x, y)
    tilts = -normals[:, :2] / normals[:, 2:]
    assert np.abs(tilts - felt[:, 1:]).max() < 1.02 * curvature * PITCH_M / 2
    at_centres = surface.height_at(centres, 0 * centres + centres[30])
    law = [spline.height(coefficients, 1 / PITCH_M, 1 / PITCH_M, each, centres[30]) for each in centres]
    np.testing.assert_allclose(at_centres[1:-1], law[1:-1], atol=1e-6 * AMPLITUDE_M + 1e-9)

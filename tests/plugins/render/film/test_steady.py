"""A frame of a video would feel different from the same still surface, or kick the hand."""

import numpy as np
import pytest

from rough_surfaces import rough_surfaces
from tangible_core.compiled.touch import RISE_M
from tangible_render.film.film import HIGHEST_M, quick_coefficients
from tangible_render.film.scratch import MARGIN, RING, Scratch
from tangible_render.film.slots import STEP_N
from tangible_render.film.steady import REACH, initial_memory, steady
from tangible_render.surface.coefficients import spline_coefficients
from tangible_render.surface.jumps import jumps

STIFFNESS, DAMPING = 800.0, 0.5


@pytest.mark.parametrize(
    ("law_n", "limited"),
    [((0.3, -0.15, 1.61), False), ((0.9, -0.4, 3.0), True), ((0.7, 0.3, 1.6), True), ((-2.0, 1.0, 0.4), True)],
)
def test_force_changes_by_a_bounded_step_and_the_rise_does_its_work(law_n: tuple[float, ...], limited: bool):
    """A spring held by the hand stores |held|^2 / 2 k; the surface adds the rest of |force|^2 / 2 k by its rise."""
    memory, moving = initial_memory(STIFFNESS, DAMPING), np.full(RISE_M + 1, 0.25)
    before = np.array([0.3, -0.2, 1.6])
    assert steady(memory, moving, 0.01, -0.02, 0.003, 0.1, 0.2, -0.3, *before) == tuple(before)
    way, faster = np.array([2e-5, -1e-5, -3e-5]), np.array([0.02, 0.01, -0.03])
    place, velocity = np.array([0.01, -0.02, 0.003]) + way, np.array([0.1, 0.2, -0.3]) + faster
    found = np.array(steady(memory, moving, *place, *velocity, *law_n))
    held = before - STIFFNESS * way
    most_n = STEP_N + REACH * STIFFNESS * np.linalg.norm(way) + DAMPING * np.linalg.norm(faster)
    away = np.array(law_n) - held
    expected = held + away * min(1.0, most_n / np.linalg.norm(away))
    assert found == pytest.approx(expected, abs=1e-12)
    assert (np.linalg.norm(away) > most_n) == limited
    work_j = (found @ found - held @ held) / (2 * STIFFNESS)
    rise_m = max(work_j, 0.0) / ((found[2] + before[2]) / 2)
    assert moving[RISE_M] == pytest.approx(min(rise_m, STEP_N / STIFFNESS) if limited else 0.25, rel=1e-9)


def test_force_that_catches_up_has_a_rise_until_its_last_step():
    """A step and a half, in two ticks: 1 N, then 1.08 N, and then 1.12 N to stay."""
    memory, moving, rises_m = initial_memory(STIFFNESS, 0.0), np.zeros(RISE_M + 1), []
    forces = [1.0, 1.0 + STEP_N, *[1.0 + 1.5 * STEP_N] * 2]
    for law_z, expected in zip((1.0, *[1.0 + 1.5 * STEP_N] * 3), forces, strict=True):
        moving[RISE_M] = -1.0  # the law's own
        assert steady(memory, moving, *[0.0] * 6, 0.0, 0.0, law_z)[2] == pytest.approx(expected)
        rises_m.append(moving[RISE_M])
    assert rises_m == pytest.approx([-1.0, STEP_N / STIFFNESS, STEP_N / 2 / STIFFNESS, -1.0])


@pytest.mark.parametrize("force_n", [-1.0, 0.0])
def test_force_that_does_not_push_up_has_no_rise(force_n: float):
    memory, moving = initial_memory(STIFFNESS, 0.0), np.zeros(RISE_M + 1)
    steady(memory, moving, *[0.0] * 6, 0.0, 0.0, force_n)
    moving[RISE_M] = -1.0
    steady(memory, moving, *[0.0] * 6, 5.0, 0.0, force_n)
    assert moving[RISE_M] == 0.0


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


@pytest.mark.parametrize("shape", [(1, 1), (40, 50)])
def test_level_ground_has_level_coefficients_to_the_last_bit_and_heights_beyond_the_bound_are_cut(
    shape: tuple[int, int],
):
    found, _ = coefficients_of(np.full(shape, 0.00731))
    assert np.unique(found).size == 1
    assert found[0, 0] == pytest.approx(0.00731, rel=1e-6)
    found, _ = coefficients_of(np.full(shape, 3e38))
    assert np.isfinite(found).all()
    assert found.max() == pytest.approx(HIGHEST_M, rel=1e-6)

"""Lateral force laws, grey levels and the mask would pull the wrong way or too hard: against plain formulas."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planes import UP_M, at, tilted
from tangible_core.data import NO_FORCE, HapticState, HapticSurface, Material, Relief
from tangible_core.testing.synthetic.scenes import KnownSurface, ramp, sphere_cap, waves
from tangible_render.force_shading import ForceShading
from tangible_render.grey_level import GreyLevel
from tangible_render.lateral_gradient import LateralGradient
from tangible_render.lateral_shape import LateralShape
from tangible_render.penalty import Penalty
from tangible_render.surface.dequantise import grey_levels
from tangible_render.tangible_mask import TangibleMask

RNG = np.random.default_rng(17)
KNOWN = {"ramp": ramp(), "sphere": sphere_cap(shape=(256, 256)), "waves": waves()}


def press(renderer, known: KnownSurface, x: float, y: float, depth_m: float = 0.001) -> np.ndarray:
    return np.array(renderer.touch(known.surface).force(HapticState(known.at(x, y, depth_m))))


@pytest.fixture(params=KNOWN)
def known(request) -> KnownSurface:
    return KNOWN[request.param]


PLACES = RNG.uniform(-0.036, 0.036, (12, 2))


def test_lateral_force_at_any_depth_is_the_slope_or_the_slope_times_the_push(known: KnownSurface):
    for x, y in PLACES:
        slope = np.array(known.slope(x, y))
        for depth in (0.0005, 0.004):
            force = press(LateralGradient(force_per_slope_n=3.0), known, x, y, depth)
            assert np.allclose(force, [*-3 * slope, 0], atol=1e-3)
            force = press(LateralShape(stiffness_n_per_m=500.0), known, x, y, depth)
            assert np.allclose(force, [*(-500 * depth * slope), 0], rtol=0, atol=1e-4)


def test_penalty_is_a_damped_spring_along_z_of_its_material(known: KnownSurface):
    touch = Penalty(stiffness_n_per_m=500.0, damping_n_s_per_m=2.0).touch(known.surface)
    for x, y in PLACES:
        for speed in (-0.25, 0.0, 0.1, 100.0):
            force = touch.force(HapticState(known.at(x, y, 0.002), (3.0, -2.0, speed)))
            assert force == pytest.approx((0, 0, max(0.0, 1.0 - 2 * speed)), abs=1e-4)
    labels = np.repeat([[0, 1]], 2, axis=0).repeat(8, axis=1).astype(np.int32)
    materials = Material("soft", 100.0, 0, 0, 0), Material("hard", 900.0, 0, 0, 0)
    touch = Penalty().touch(HapticSurface.from_heights(np.full((2, 16), 0.01), 0.08, labels, materials))
    assert touch.force(HapticState((-0.02, 0, 0))).z == pytest.approx(1.0)
    assert touch.force(HapticState((0.02, 0, 0))).z == pytest.approx(9.0)


@pytest.mark.parametrize("known", [ramp(), ramp((0.5, -0.75), 0.06), ramp((0.0, 0.6), 0.06)])
def test_force_shading_on_a_plane_is_a_spring_along_the_normal(known: KnownSurface):
    normal = known.normal(0, 0)
    for x, y in RNG.uniform(-0.037, 0.037, (12, 2)):
        force = press(ForceShading(stiffness_n_per_m=700.0), known, x, y)
        assert np.allclose(force, 0.7 * normal[2] * normal, rtol=1e-3, atol=1e-4)


class TestGreyLevel:
    def test_grey_level_is_of_the_cell_under_the_tip_in_256_steps(self):
        heights = np.array([[0, 51, 102], [153, 204, 255]]) / 255 * 0.01
        touch = GreyLevel(force_at_white_n=5.0).touch(HapticSurface.from_heights(heights, 0.03))
        for row, y in enumerate((0.009, -0.001)):
            for column, x in enumerate((-0.0149, -0.0049, 0.0051)):
                assert at(touch, x, y, -1e-4) == pytest.approx((0, 0, 5.0 * (3 * row + column) / 5))
        touch = GreyLevel(force_at_white_n=3.0).touch(tilted(0, 0))
        assert at(touch, 0, 0, UP_M) == NO_FORCE
        assert at(touch, 0, 0, np.nextafter(UP_M, 0)) == (0, 0, 3.0)
        assert at(touch, 0, 0, -1.0) == (0, 0, 3.0)
        ramp = np.linspace(0, 0.01, 4001)[None, :]
        path = np.column_stack([np.linspace(-0.0399, 0.0399, 4001), np.zeros(4001), np.full(4001, -0.001)])
        felt = GreyLevel(force_at_white_n=255.0).touch(HapticSurface.from_heights(ramp)).path(path)[:, 2]
        assert np.array_equal(np.unique(felt), np.arange(256))
        for highest in (1e-45, 1e-30, 3e38):
            surface = HapticSurface.from_heights(np.array([[0, highest]]))
            assert at(GreyLevel(force_at_white_n=2.0).touch(surface), 0.01, 0, -0.01) == (0, 0, 2.0)


NOISE = np.random.default_rng(3)
WIDTH_M = 0.0625


def plain_sum(dark: np.ndarray, row: int, column: int, side: int) -> np.ndarray:
    """Sum dark (u, v) by its definition: u along the columns, v against the rows."""
    half = side // 2
    offsets = np.arange(-half, half + 1)
    window = dark[row - half : row + half + 1, column - half : column + half + 1].astype(np.int64)
    return np.array([(window * offsets).sum(), (window * -offsets[:, None]).sum()])


def centre(surface: HapticSurface, row: int, column: int) -> tuple[float, float]:
    (rows, columns), (width, length) = surface.height_m.shape, surface.extent_m
    return (column + 0.5) * width / columns - width / 2, length / 2 - (row + 0.5) * length / rows


def force_at_cell(renderer: TangibleMask, surface: HapticSurface, row: int, column: int) -> np.ndarray:
    return np.array(renderer.touch(surface).force(HapticState((*centre(surface, row, column), -0.001))))


@given(st.integers(1, 32), st.integers(0, 99), st.integers(0, 99))
def test_force_matches_the_plain_sum(half: int, row: int, column: int):
    side = 2 * half + 1
    surface = HapticSurface.from_heights(np.random.default_rng(half).uniform(0, 0.01, (100, 100)), WIDTH_M)
    force = force_at_cell(TangibleMask(mask_px=side, force_at_edge_n=2.0), surface, row, column)
    if min(row, column) < half or max(row, column) > 99 - half:
        assert tuple(force) == NO_FORCE
        return
    most = 255 * side * (side**2 - 1) / 8  # of a straight edge from black to white through the middle
    expected = 2.0 / most * plain_sum(255 - grey_levels(surface.height_m), row, column, side)
    assert np.allclose(force[:2], expected, rtol=1e-9, atol=1e-12) and force[2] == 0


def test_mask_pulls_to_the_dark_and_is_square_on_oblong_cells():
    heights = np.zeros((41, 41))
    heights[:, 21:] = 0.01
    mask = TangibleMask(mask_px=17, force_at_edge_n=3.0)
    assert force_at_cell(mask, HapticSurface.from_heights(heights), 20, 20) == pytest.approx((-3.0, 0, 0))
    # higher rows are nearer: the dark side is far, along y
    assert force_at_cell(mask, HapticSurface.from_heights(heights.T), 20, 20) == pytest.approx((0, 3.0, 0))
    x = np.linspace(0, 1, 60)[None, :] * np.ones((30, 1))
    force = (
        TangibleMask(mask_m=0.01, force_at_edge_n=1.0)
        .touch(HapticSurface(Relief(np.asarray(0.01 * x, np.float32), (0.06, 0.06))))
        .force(HapticState((0.0, 0.0, -0.001)))
    )
    assert force.x == pytest.approx(-2 / 3 * 0.01 / 0.059, rel=0.02)
    assert abs(force.y) < 1e-12

"""The tangible mask against the plain sum, at any resolution, and at its limits."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.data import NO_FORCE, HapticState, HapticSurface, Relief
from tangible_render.surface.grey_levels import grey_levels
from tangible_render.tangible_mask import TangibleMask

RNG = np.random.default_rng(3)
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


def test_edge_from_black_to_white_pulls_with_the_force_of_the_option():
    heights = np.zeros((41, 41))
    heights[:, 21:] = 0.01
    assert force_at_cell(
        TangibleMask(mask_px=17, force_at_edge_n=3.0), HapticSurface.from_heights(heights), 20, 20
    ) == (pytest.approx((-3.0, 0, 0)))
    assert force_at_cell(
        TangibleMask(mask_px=17, force_at_edge_n=3.0), HapticSurface.from_heights(heights.T), 20, 20
    ) == (
        pytest.approx((0, 3.0, 0))  # higher rows are nearer: the dark side is far, along y
    )


@pytest.mark.parametrize("slope", [(0.1, 0.0), (0.0, 0.2), (0.1, -0.05)])
def test_slope_at_half_and_double_resolution_has_the_same_force(slope: tuple[float, float]):
    def ramp(count: int) -> HapticSurface:
        c = ((np.arange(count) + 0.5) / count - 0.5) * WIDTH_M
        heights = 0.02 + slope[0] * c[None] - slope[1] * c[:, None]
        heights[0, 0] = 0.0625  # the highest point, and so the grey level of a height, is the same at each resolution
        return HapticSurface.from_heights(heights, WIDTH_M)

    renderer = TangibleMask(mask_m=0.006)
    expected = -2.0 * 2 / 3 * 0.006 * np.array(slope) / 0.0625
    for count in (64, 128, 256, 512):
        touch = renderer.touch(ramp(count))
        positions = np.column_stack([RNG.uniform(-0.01, 0.01, (400, 2)), np.full(400, -0.01)])
        mean = touch.path(positions).mean(axis=0)[:2]
        assert np.allclose(mean, expected, rtol=0.02, atol=0.02 * np.abs(expected).max())  # 256 grey levels


def test_force_below_the_surface_is_the_same_at_any_depth():
    surface = HapticSurface.from_heights(RNG.uniform(0.002, 0.01, (30, 30)), WIDTH_M)
    touch = TangibleMask().touch(surface)
    x, y = centre(surface, 12, 13)
    height = float(surface.height_m[12, 13])
    assert touch.force(HapticState((x, y, height))) == NO_FORCE
    assert (
        touch.force(HapticState((x, y, np.nextafter(height, 0)))) == touch.force(HapticState((x, y, -1.0))) != NO_FORCE
    )


def test_mask_on_oblong_cells_is_square():
    x = np.linspace(0, 1, 60)[None, :] * np.ones((30, 1))
    force = (
        TangibleMask(mask_m=0.01, force_at_edge_n=1.0)
        .touch(HapticSurface(Relief(np.asarray(0.01 * x, np.float32), (0.06, 0.06))))
        .force(HapticState((0.0, 0.0, -0.001)))
    )
    assert force.x == pytest.approx(-2 / 3 * 0.01 / 0.059, rel=0.02)
    assert abs(force.y) < 1e-12


def test_materials_are_not_used():
    assert not TangibleMask.uses_materials

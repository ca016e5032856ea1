"""The tangible mask would pull the wrong way or too hard: against its plain sum."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.data import NO_FORCE, HapticState, HapticSurface, Relief
from tangible_render.surface.dequantise import grey_levels
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


def test_mask_on_oblong_cells_is_square():
    x = np.linspace(0, 1, 60)[None, :] * np.ones((30, 1))
    force = (
        TangibleMask(mask_m=0.01, force_at_edge_n=1.0)
        .touch(HapticSurface(Relief(np.asarray(0.01 * x, np.float32), (0.06, 0.06))))
        .force(HapticState((0.0, 0.0, -0.001)))
    )
    assert force.x == pytest.approx(-2 / 3 * 0.01 / 0.059, rel=0.02)
    assert abs(force.y) < 1e-12

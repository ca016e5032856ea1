"""If one of these fails, a surface is measured at other heights or slopes than the hand feels."""

import numpy as np
import pytest

from tangible_core import HapticSurface
from tangible_core.data import Relief

WIDTH_M, LENGTH_M, ROWS, COLUMNS = 0.08, 0.06, 30, 50


def centres() -> tuple[np.ndarray, np.ndarray]:
    x = (np.arange(COLUMNS) + 0.5) * WIDTH_M / COLUMNS - WIDTH_M / 2
    y = LENGTH_M / 2 - (np.arange(ROWS) + 0.5) * LENGTH_M / ROWS
    return x, y[:, None]


def surface_of(height) -> HapticSurface:
    x, y = centres()
    heights = np.broadcast_to(height(x, y), (ROWS, COLUMNS))
    return HapticSurface(Relief(np.ascontiguousarray(heights, np.float32), (WIDTH_M, LENGTH_M)))


def points(count: int = 500) -> tuple[np.ndarray, np.ndarray]:
    """Points within the outermost centres."""
    rng = np.random.default_rng(3)
    return rng.uniform(-0.039, 0.039, (2, count // 2)), rng.uniform(-0.028, 0.028, (2, count // 2))


def test_height_beyond_the_extent_is_unknown_and_inside_that_of_the_formula():
    surface, (x, y) = surface_of(lambda x, y: 0.01 + 0.1 * x - 0.05 * y + 2 * x * y), points()
    np.testing.assert_allclose(surface.height_at(x, y), 0.01 + 0.1 * x - 0.05 * y + 2 * x * y, atol=2e-9)
    upright = np.stack([-(0.1 + 2 * y), 0.05 - 2 * x, np.ones_like(x)], axis=-1)
    upright /= np.linalg.norm(upright, axis=-1, keepdims=True)
    assert surface.normal_at(x, y).shape == (*x.shape, 3)
    np.testing.assert_allclose(surface.normal_at(x, y), upright, atol=2e-6)
    surface = surface_of(lambda x, y: 0.004 + 0.05 * x + 0 * y)
    x, _ = centres()
    assert surface.height_at(WIDTH_M / 2, LENGTH_M / 2) == pytest.approx(0.004 + 0.05 * x[-1], abs=1e-9)
    assert surface.normal_at(0.0, 0).shape == (3,)
    for outside in ((WIDTH_M / 2 + 1e-6, 0.0), (0.0, -LENGTH_M), (np.nan, 0.0), (0.0, np.inf)):
        assert np.isnan(surface.height_at(*outside))
        assert np.isnan(surface.normal_at(*outside)).all()


@pytest.mark.parametrize(("rows", "columns"), [(1, 1), (1, 4), (5, 1), (ROWS, COLUMNS)])
def test_one_point_has_the_bits_of_many(rows: int, columns: int):
    """A law that asks tick by tick feels what a whole path is judged by."""
    rng = np.random.default_rng(5)
    surface = HapticSurface.from_heights(rng.random((rows, columns)) * 0.01, WIDTH_M)
    x, y = rng.uniform(-0.6, 0.6, (2, 400)) * np.array(surface.extent_m)[:, None]
    x[:5], y[5:10] = (WIDTH_M / 2, -WIDTH_M / 2, 0, np.inf, np.nan), surface.extent_m[1] / 2
    pairs = [*zip(x.tolist(), y.tolist(), strict=True)]
    np.testing.assert_array_equal([surface.height_at(*point) for point in pairs], surface.height_at(x, y))
    np.testing.assert_array_equal([surface.normal_at(*point) for point in pairs], surface.normal_at(x, y))

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_depth.dense.integration import gradient, integrate


@pytest.mark.parametrize("shape", [(61, 83), (64, 64), (1, 9), (9, 1), (1, 1), (2, 3)])
def test_bump_is_restored_from_its_slopes(shape):
    rows, columns = np.indices(shape, np.float64)
    bump = np.exp(-((rows - 0.4 * shape[0]) ** 2 + (columns - 0.5 * shape[1]) ** 2) / 200)
    assert integrate(*gradient(bump)) == pytest.approx(bump - bump.mean(), abs=1e-12)


@given(st.integers(0, 2**32 - 1), st.integers(1, 12), st.integers(1, 12))
def test_any_surface_is_restored(seed, rows, columns):
    surface = np.random.default_rng(seed).normal(size=(rows, columns))
    assert integrate(*gradient(surface)) == pytest.approx(surface - surface.mean(), abs=1e-9)


def test_inconsistent_slopes_are_fitted_by_least_squares():
    random = np.random.default_rng(0)
    x, y = random.normal(size=(2, 12, 15))
    x[:, -1], y[-1] = 0, 0

    def cost(surface):
        along_x, along_y = gradient(surface)
        return ((along_x - x) ** 2).sum() + ((along_y - y) ** 2).sum()

    best = integrate(x, y)
    beyond = np.full(15, 7.0)
    assert np.array_equal(best, integrate(np.hstack([x[:, :-1], beyond[:12, None]]), np.vstack([y[:-1], beyond])))
    assert all(cost(best) < cost(best + 1e-3 * random.normal(size=best.shape)) for _ in range(20))


def test_single_precision_stays_single():
    surface = np.random.default_rng(0).random((20, 30)).astype(np.float32)
    back = integrate(*gradient(surface))
    assert back.dtype == np.float32
    assert back == pytest.approx(surface - surface.mean(), abs=1e-5)

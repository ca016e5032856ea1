"""The surface's coefficients would differ from SciPy's, and a cached one from one made anew."""

import numpy as np
import pytest
from scipy.ndimage import spline_filter1d

from tangible_render.surface.coefficients import spline_filter


@pytest.mark.parametrize("shape", [(3, 5), (4, 1), (64, 90), (700, 30)])
def test_spline_filter_gives_the_same_bits_as_scipy(shape: tuple[int, int]):
    draw = np.random.default_rng(3)
    values = draw.normal(size=shape) * 10.0 ** draw.integers(-6, 3, shape)
    filtered = values.copy()
    spline_filter(filtered)
    assert (filtered == spline_filter1d(values, order=3, axis=0, mode="mirror")).all()

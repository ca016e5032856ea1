"""Forces that pass between a force law and a device."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.data import NO_FORCE, Force, limited


@given(st.tuples(*[st.floats()] * 3), st.floats(1e-3, 1e3))
def test_limited_force_is_finite_within_the_limit_and_keeps_its_direction(parts, most_n: float):
    force = limited(Force(*parts), most_n)
    if not all(map(math.isfinite, parts)):
        assert force == NO_FORCE
    elif math.hypot(*parts) <= most_n:
        assert force == parts
    else:
        assert math.hypot(*force) == pytest.approx(most_n)
        greatest = max(map(abs, parts))
        unit = np.array(parts) / greatest
        assert np.allclose(np.array(force) / most_n, unit / np.linalg.norm(unit), atol=1e-12)


def test_force_one_percent_over_the_limit_is_scaled_down():
    assert limited(Force(0.0, 3.0, 4.0), 5.0) == (0.0, 3.0, 4.0)
    assert limited(Force(0.0, 3.03, 4.04), 5.0) == pytest.approx((0.0, 3.0, 4.0))

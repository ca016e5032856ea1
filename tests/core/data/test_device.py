"""If one of these fails, a device may get more force than it stands, or is taken with limits that no device has."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.data import NO_FORCE, DeviceSpec, Force, limited
from tangible_core.errors import ConfigError

SPEC = DeviceSpec(8.0, 3000.0, 20.0, (0.1, 0.1, 0.1), 1e-5)


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


@pytest.mark.parametrize("wrong", [math.inf, -1.0, math.nan, 0.0])
@pytest.mark.parametrize("name", ["max_force_n", "max_stiffness_n_per_m", "resolution_m", "damping_n_s_per_m"])
def test_spec_with_a_number_that_no_device_has_is_refused_by_name(name: str, wrong: float):
    if name == "damping_n_s_per_m" and wrong == 0:
        assert replace(SPEC, damping_n_s_per_m=0.0).damping_n_s_per_m == 0
        return
    with pytest.raises(ConfigError, match=rf"^the device's {name}: is {wrong}; it must be positive and finite$"):
        replace(SPEC, **{name: wrong})


@pytest.mark.parametrize("wrong", [(0.1, -0.1, 0.1), (0.1, 0.1, math.inf), (math.nan, 0.1, 0.1)])
def test_spec_with_a_workspace_without_size_is_refused(wrong: tuple[float, float, float]):
    with pytest.raises(ConfigError, match="the device's workspace_m: is"):
        replace(SPEC, workspace_m=wrong)

"""The limits of a force hold for any input of the guard, or a broken law or driver reaches the hand."""

import math

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from tangible_core.data import DeviceSpec, TickFlag
from tangible_core.servo.guard.guard import couple, guard, wait
from tangible_core.servo.guard.safety import Safety

SPEC = DeviceSpec(8.0, 3000.0, 1.5, (0.08, 0.08, 0.08), 3e-5)
NAN = math.nan

HOSTILE = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True),
    st.sampled_from([0.0, -0.0, 5e-324, -5e-324, 1e308, -1e308, 1e-3, NAN, math.inf]),
    st.floats(-0.1, 0.1),
    st.floats(-20, 20),
)
PERIODS = st.one_of(st.sampled_from([0.001, 0.0, -1.0, 1e-9, 0.5, 1e308, NAN]), st.floats(1e-4, 5e-3))
OPTIONS = st.builds(
    Safety,
    ramp_s=st.sampled_from([0, 0.01]),
    passivity=st.sampled_from(["off", "coupled", "strict"]),
    coupling=st.sampled_from([None, "auto"]),
    delay_ticks=st.integers(0, 8),
    max_step_n=st.sampled_from([0.01, 0.5, 10]),
)


@given(
    safety=OPTIONS,
    stiffness=st.sampled_from([0.0, 800.0, 1e5]),
    states=st.lists(st.tuples(PERIODS, *[HOSTILE] * 9), min_size=1, max_size=40),
    waits=st.integers(0, 3),
)
@example(
    safety=Safety(coupling="auto", ramp_s=0),
    stiffness=0.0,
    states=[(0.001, *[0.0] * 6, 1.0, 0.0, 0.0), (0.001, 0.0, 0.0, 0.0, 1e308, -1e308, 0.0, 1e308, -1e308, 0.0)] * 3,
    waits=0,
)
def test_force_of_any_input_keeps_the_limits(
    safety: Safety, stiffness: float, states: list[tuple[float, ...]], waits: int
):
    settings, memory = safety.arrays(SPEC, stiffness)
    last = np.zeros(3)
    for period_s, *rest in states:
        for _ in range(waits):
            last = _kept(last, wait(settings, memory, period_s / 4), safety.max_step_n)
        tool = couple(settings, memory, period_s, *rest[:6])
        law = rest[6:] if np.isfinite(tool).all() else [0.0] * 3
        last = _kept(last, guard(settings, memory, period_s, *rest[:6], *law), safety.max_step_n)


def _kept(last: np.ndarray, left: tuple[float, float, float, int], step_n: float) -> np.ndarray:
    """Return the force, after checking it against every limit."""
    force, flags = np.array(left[:3]), TickFlag(left[3])
    assert np.isfinite(force).all()
    assert np.linalg.norm(force) <= SPEC.max_force_n * (1 + 1e-12)
    if flags & (TickFlag.NOT_FINITE | TickFlag.STALE):
        assert not force.any()
    else:
        assert np.linalg.norm(force - last) <= step_n * (1 + 1e-12)
    return force

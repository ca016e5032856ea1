"""The simulated Falcon would not feel as the real driver makes it, or leave its faults out."""

from itertools import pairwise

import numpy as np
import pytest

from tangible_core import HapticSurface, load_method
from tangible_core.errors import DeviceError
from tangible_core.session import run_simulated
from tangible_devices.falcon.falcon_simulated import FalconSimulated
from tangible_devices.falcon.simulator.body import CENTRE_M, HOMED, REACH_M, Body

FLAT = HapticSurface.from_heights(np.full((8, 8), 0.002))


def test_simulated_falcon_feels_a_surface():
    recording = run_simulated(load_method("render", "penalty")().touch(FLAT), FalconSimulated(path="press"), 2.0)
    assert not recording.stopped
    assert 1.0 < recording.force_n[:, 2].max() < 6.0
    assert recording.position_m[:, 2].min() > -0.004, "the surface holds the hand up, whose path goes to -0.005"


def test_simulated_falcon_injects_faults():
    device = FalconSimulated.model_validate({"faults": [{"at": "read", "error": "unplugged", "after": 3000}]})
    recording = run_simulated(load_method("render", "penalty")().touch(FLAT), device, 10.0)
    assert "was unplugged" in recording.stopped
    with pytest.raises(DeviceError, match="TAG"):
        FalconSimulated.model_validate({"faults": [{"at": "claim", "error": "access-denied"}]}).open()


def test_simulated_falcon_in_real_time_follows_the_clock():
    with FalconSimulated(real_time=True).open() as link:
        states = [link.read() for _ in range(20)]
    assert all(after.time_s > before.time_s for before, after in pairwise(states))


class Holding:
    """A hand that holds the grip out or in."""

    buttons, out = 0, False

    def wants(self, tip: np.ndarray, seeking: bool, homed: bool) -> np.ndarray:
        return np.array([0.0, 0.0, CENTRE_M + (REACH_M if self.out else -REACH_M)])


def test_arms_are_homed_by_going_out_and_in_where_the_host_asks_for_it():
    hand = Holding()
    body = Body(hand, np.array([0.2, 1.0, 0.1, 1000.0, 20.0]))
    steps = [(0, True, 0), (0, False, 0), (1, False, 0), (1, True, 0), (1, False, sum(HOMED)), (0, False, 0)]
    for number, (info, hand.out, homed) in enumerate([*steps, *steps[3:5]]):
        body.obey((0, 0, 0), info, number)
        body.move_until(number + 1)
        assert body.report()[1] == homed, number
    body.let_go()
    assert body.report()[1] == 0

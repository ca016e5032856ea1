"""The simulated Falcon: deterministic, under the real driver, with faults on demand."""

import re
import textwrap
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from tangible_core import HapticSurface, load_method
from tangible_core.errors import DeviceError
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.plugins.registry import default_registry
from tangible_core.session import run_simulated
from tangible_devices.falcon.falcon_simulated import FalconSimulated
from tangible_devices.falcon.simulator.body import HOMED, PERIOD_S, STEPS, Body
from tangible_devices.falcon.simulator.plant import CENTRE_M, REACH_M, move
from tangible_devices.falcon.usb.errors import UDEV_FILE, UDEV_RULE

FLAT = HapticSurface.from_heights(np.full((8, 8), 0.002))


def test_simulated_falcon_feels_a_surface():
    recording = run_simulated(load_method("render", "penalty")().touch(FLAT), FalconSimulated(path="press"), 2.0)
    assert not recording.stopped
    assert 1.0 < recording.force_n[:, 2].max() < 6.0
    assert recording.position_m[:, 2].min() > -0.004, "the surface holds the hand up, whose path goes to -0.005"


def test_simulated_falcon_is_deterministic():
    touch = load_method("render", "penalty")()
    first, second = (run_simulated(touch.touch(FLAT), FalconSimulated(), 0.3) for _ in range(2))
    assert (first.position_m == second.position_m).all()


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


def test_simulated_falcon_refuses_invalid_firmware_file(tmp_path):
    path = tmp_path / "firmware.bin"
    path.write_bytes(b"hello!")
    with pytest.raises(DeviceError, match="is not a Falcon firmware"):
        FalconSimulated.model_validate({"driver": {"firmware": str(path)}}).open()


def test_page_shows_valid_configuration_and_udev_rule(tmp_path: Path):
    page = Path(__file__).parents[4].joinpath("docs/falcon.md").read_text(encoding="utf-8")
    assert UDEV_RULE in page and UDEV_FILE in page
    blocks = [textwrap.dedent(each) for each in re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)]
    assert len(blocks) == 2
    for text in blocks:
        parse_config(f"scene: builtin/brick\n{text}", tmp_path / "p.yaml", default_registry())


@pytest.mark.parametrize("way", [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1), (2, -1, 1)])
def test_tip_ends_where_the_arms_do_whichever_way_it_is_pulled(way: tuple[int, int, int]):
    """A hand that pulls to a place a metre away, from the centre on, and no motor."""
    centre = np.array([0.0, 0.0, CENTRE_M])
    tip, target = np.array([*centre, 0.0, 0.0, 0.0]), centre + np.array(way) / np.linalg.norm(way)
    for _ in range(2000):
        move(tip, np.zeros(3), target, np.array([0.2, 1.0, 0.1, 100.0, 2.0]), STEPS, PERIOD_S)
    assert tip[:3] == pytest.approx(centre + REACH_M * (target - centre), abs=1e-4)
    assert np.linalg.norm(tip[3:]) < 1e-3


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

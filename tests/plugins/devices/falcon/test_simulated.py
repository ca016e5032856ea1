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

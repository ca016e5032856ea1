"""The tracking error of hands that were held, and of hands that were not."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from command_line import tangible
from tangible_core.data import TICK_COLUMNS, HapticSurface
from tangible_core.mapping import WorkspaceMapping, intended_path, map_device, over
from tangible_core.plugins.interfaces import ForceRenderer, HapticDevice
from tangible_core.session import EVERY, Recording, TickSampler, TrackingError, run_simulated, tracking_error
from tangible_devices.mock import Mock
from tangible_render.penalty import Penalty
from tangible_render.proxy import Proxy

PROXY = Proxy()
ROWS, COLUMNS = np.indices((64, 64))
HOLES = np.where((ROWS - 32) ** 2 + (COLUMNS - 32) ** 2 < 100, 0.0, 0.01)
WALL = np.where(abs(COLUMNS - 40) < 3, 0.015, 0.003)
FLAT = np.full((64, 64), 0.01)


def felt(heights: np.ndarray, device: HapticDevice, render: ForceRenderer = PROXY) -> tuple[Recording, TrackingError]:
    surface = HapticSurface.from_heights(heights)
    device = over(device, surface.extent_m)
    felt = run_simulated(render.touch(surface), device, 3.0)
    seen = Recording(felt.rows[::EVERY])
    return felt, tracking_error(seen, intended_path(device, np.arange(len(seen.rows)) * EVERY), surface)


@pytest.mark.parametrize(
    ("heights", "device", "render", "says"),
    [
        (HOLES, Mock(lines=3), PROXY, "stuck in a pit 10 mm deep"),
        (WALL, Mock(lines=2), PROXY, "stuck behind a wall 12 mm high at x 7 mm, y 7 mm"),
        (FLAT[:16], Mock(size_m=(0.06, 0.04), lines=2), PROXY, "leaves the surface, which is 80 x 20 mm"),
        (FLAT, Mock(lines=2), Proxy(static_friction=9, dynamic_friction=9), "a level force of"),
        (FLAT, Mock(lines=2, speed_m_per_s=5), PROXY, "too slow for its path"),
    ],
    ids=["pit", "wall", "side", "friction", "slow"],
)
def test_tracking_error_names_the_cause(heights: np.ndarray, device: Mock, render: Proxy, says: str):
    _, followed = felt(heights, device, render)
    assert followed.off_share > 0.05 and followed.farthest_m > 0.0025
    assert followed.says.startswith(
        f"The hand did not follow its path: for {100 * followed.off_share:.0f} % of the time"
    )
    assert says in followed.says and followed.says.count("Likely cause: ") == 1


@pytest.mark.parametrize(
    "heights", [FLAT, FLAT[:16], FLAT[:, :12], HOLES * 0.05], ids=["square", "wide", "tall", "rough"]
)
def test_tracking_error_of_following_hand_is_silent(heights: np.ndarray):
    """Late by 2 mm, as hands are; and of no path of its own does a mock leave the surface, whatever its shape."""
    recording, hand = felt(heights, Mock())
    width, length = 0.08, 0.08 * heights.shape[0] / heights.shape[1]
    assert (np.abs(recording.position_m[:, :2]) < np.array([width, length]) / 2).all()
    assert hand.says == "" and hand.off_share == hand.beside_share == 0
    assert recording.figures()["contact_share"] > 0.8


def test_tracking_error_of_rigid_hand_reports_the_side():
    device = Mock(hand=None, size_m=(0.06, 0.04), lines=2)
    _, held = felt(FLAT[:16], device)
    assert held.says.startswith(
        "The hand came in by the side of the surface, under its rim, and was held off there for "
    )
    assert held.off_share == 0 and held.beside_share > 0.1
    _, through = felt(FLAT[:16], device, Penalty())
    assert through.says == "" and through.beside_share == 0  # this law has no side


@pytest.mark.parametrize(
    "mapping",
    [
        WorkspaceMapping(),
        WorkspaceMapping(scale=0.5, rotation_deg=90, offset_m=(0.008, 0.001, 0.01)),
        WorkspaceMapping(region_m=(0.01, -0.005, 0.04, 0.02), rotation_deg=30),
    ],
    ids=["none", "quarter", "region"],
)
def test_path_through_any_mapping_stays_within_the_surface(mapping: WorkspaceMapping):
    extent_m = (0.08, 0.05)
    device = over(map_device(Mock(hand=None, tremor_m=1e-4), mapping), extent_m)
    link = device.open()
    found = np.array([link.read().position_m for _ in range(6000)])
    path_m = intended_path(device, np.arange(6000))
    assert path_m is not None and np.abs(path_m - found).max() < 1e-12
    assert (np.abs(found[:, :2]) <= np.array(extent_m) / 2).all()
    assert np.ptp(found[:, :2], axis=0).min() > 0.012


def test_configured_path_size_stays():
    mock = Mock(size_m=(0.06, 0.04))
    assert over(mock, (0.01, 0.01)) is mock
    assert over(Mock(), (0.08, 0.08)) == mock


def test_tick_sampler_takes_every_tenth_tick():
    rows, looks = np.arange(1000.0)[:, None] * np.ones(len(TICK_COLUMNS)), TickSampler()
    for part in np.split(rows, [3, 4, 17, 120, 121, 500]):
        looks.keep(part)
    assert np.array_equal(looks.recording().rows, rows[::EVERY])


def test_run_prints_and_stores_the_tracking_error(tmp_path: Path):
    cv2.imwrite(str(tmp_path / "hole.png"), np.asarray(HOLES * 25500, np.uint8))
    (tmp_path / "hole.yaml").write_text(
        "scene: {height: hole.png, relief_m: 0.01}\nwant: touch\nrender: {use: proxy}\ndevice: {use: mock, lines: 3}\n"
    )
    done = tangible("run", "hole.yaml", "--seconds", "3", "--no-cache", cwd=tmp_path)
    assert "Likely cause: it was stuck in a pit" in " ".join(done.stdout.split())
    kept = json.loads((tmp_path / "out/hole/outcomes.json").read_text())["figures"]["hand"]
    assert kept["off_share"] > 0.05 and kept["says"].startswith("The hand did not follow its path")

"""The tracking error: a hand that was held where nobody sees why, or a warning of a hand that followed."""

import json
from importlib import import_module
from pathlib import Path

import cv2
import numpy as np
import pytest

from command_line import tangible
from tangible_core.data import TICK_COLUMNS, HapticSurface
from tangible_core.mapping import intended_path, over
from tangible_core.plugins.interfaces import ForceRenderer, HapticDevice
from tangible_core.session import EVERY, Recording, TickSampler, TrackingError, run_simulated, tracking_error
from tangible_devices.mock import Mock
from tangible_render.penalty import Penalty
from tangible_render.proxy import Proxy

PROXY = Proxy()
ROWS, COLUMNS = np.indices((64, 64))
HOLES = np.where((ROWS - 32) ** 2 + (COLUMNS - 32) ** 2 < 100, 0.0, 0.01)
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
        (FLAT[:16], Mock(size_m=(0.06, 0.04), lines=2), PROXY, "leaves the surface, which is 80 x 20 mm"),
        (FLAT, Mock(lines=2), Proxy(static_friction=9, dynamic_friction=9), "a level force of"),
    ],
    ids=["pit", "side", "friction"],
)
def test_tracking_error_names_the_cause(heights: np.ndarray, device: Mock, render: Proxy, says: str):
    _, followed = felt(heights, device, render)
    assert followed.off_share > 0.05 and followed.farthest_m > 0.0025
    assert followed.says.startswith(
        f"The hand did not follow its path: for {100 * followed.off_share:.0f} % of the time"
    )
    assert says in followed.says and followed.says.count("Likely cause: ") == 1


def test_tracking_error_of_rigid_hand_reports_the_side():
    device = Mock(hand=None, size_m=(0.06, 0.04), lines=2)
    _, held = felt(FLAT[:16], device)
    assert held.says.startswith(
        "The hand came in by the side of the surface, under its rim, and was held off there for "
    )
    assert held.off_share == 0 and held.beside_share > 0.1
    _, through = felt(FLAT[:16], device, Penalty())
    assert through.says == "" and through.beside_share == 0  # this law has no side
    _, hand = felt(FLAT[:, :12], Mock())
    assert hand.says == "" and hand.off_share == hand.beside_share == 0  # late by 2 mm, as hands are


def test_tick_sampler_takes_every_tenth_tick(monkeypatch: pytest.MonkeyPatch):
    rows, looks = np.arange(1000.0)[:, None] * np.ones(len(TICK_COLUMNS)), TickSampler()
    for part in np.split(rows, [3, 4, 17, 120, 121, 500]):
        looks.keep(part)
    assert np.array_equal(looks.recording().rows, rows[::EVERY])
    monkeypatch.setattr(import_module("tangible_core.session.tracking_error"), "MAX_LOOKS", 50)
    looks = TickSampler()
    for part in np.split(rows, 10):
        looks.keep(part)
    assert np.array_equal(looks.recording().rows, rows[: 50 * EVERY : EVERY])


def seen(at_m: np.ndarray, force_n: np.ndarray) -> Recording:
    """A recording of every tenth tick, with these places and forces."""
    rows = np.zeros((len(at_m), len(TICK_COLUMNS)))
    rows[:, 0] = 0.001 * EVERY * np.arange(len(at_m))
    rows[:, 2:5], rows[:, 8:11], rows[:, 11:14] = at_m, np.nan, force_n
    return Recording(rows)


@pytest.mark.parametrize(("heights", "most_m"), [(FLAT, 0.01), (FLAT[:16], 0.0025), (FLAT[:, :16], 0.01)])
@pytest.mark.parametrize(("times", "told"), [(5, False), (6, True)])
def test_tracking_error_counts_ticks_off_the_path_by_more_than_the_surface_allows(
    heights: np.ndarray, most_m: float, times: int, told: bool
):
    at_m, wanted_m = np.zeros((100, 3)), np.zeros((100, 3))
    at_m[:, 2] = 0.02
    at_m[10:30, 0] = 0.9 * most_m
    at_m[50 : 50 + times, 0] = -1.1 * most_m
    found = tracking_error(seen(at_m, np.zeros((100, 3))), wanted_m, HapticSurface.from_heights(heights))
    assert (found.off_share, found.farthest_m) == pytest.approx((times / 100, 1.1 * most_m))
    assert bool(found.says) == told
    if told:
        assert f"for 6 % of the time it was more than {1000 * most_m:.2g} mm off, {1100 * most_m:.0f} mm at most" in (
            found.says
        )


@pytest.mark.parametrize(("times", "told"), [(5, False), (6, True)])
def test_tracking_error_counts_contacts_that_began_beside_the_surface(times: int, told: bool):
    at_m, force_n = np.zeros((100, 3)), np.zeros((100, 3))
    at_m[:60, 0] = 0.045  # beside the surface, which ends at 40 mm
    force_n[20 : 20 + times] = 0.2, 0.1, -0.1
    force_n[30:40] = 0.0, 0.1, 0.3  # from below
    force_n[55:60] = force_n[61:70] = 0.4, 0.0, 0.0
    at_m[54:60, 0] = 0.039
    at_m[61:70, 0] = 0.041  # it left over the rim
    at_m[60] = 0.0, 0.0, 0.02
    found = tracking_error(seen(at_m, force_n), None, HapticSurface.from_heights(FLAT))
    assert found.beside_share == times / 100
    assert bool(found.says) == told
    if told:
        assert "under its rim, and was held off there for 6 % of the time" in found.says


@pytest.mark.parametrize(
    ("goal_m", "held_n", "says"),
    [
        ((0.006, 0.03), 0.6, "stuck behind a wall 12 mm high at x 6 mm, y 4 mm"),
        ((0.006, 0.03), 0.4, "too slow for its path"),
        ((0.006, -0.03), 0.6, "a level force of 0.6 N held it"),
    ],
)
def test_tracking_error_finds_the_wall_on_the_way_of_a_hand_that_is_held(
    goal_m: tuple[float, float], held_n: float, says: str
):
    heights = np.where((ROWS >= 20) & (ROWS < 24), 0.015, 0.003)  # a wall from 10 to 15 mm behind the middle
    at_m = np.tile([0.006, 0.004, 0.003], (100, 1))
    wanted_m = np.tile([*goal_m, 0.003], (100, 1))
    force_n = np.tile([0.0, held_n, 0.5], (100, 1))
    found = tracking_error(seen(at_m, force_n), wanted_m, HapticSurface.from_heights(heights))
    assert found.off_share == 1
    assert says in found.says


def test_run_prints_and_stores_the_tracking_error(tmp_path: Path):
    cv2.imwrite(str(tmp_path / "hole.png"), np.asarray(HOLES * 25500, np.uint8))
    (tmp_path / "hole.yaml").write_text(
        "scene: {height: hole.png, relief_m: 0.01}\nwant: touch\nrender: {use: proxy}\ndevice: {use: mock, lines: 3}\n"
    )
    done = tangible("run", "hole.yaml", "--seconds", "3", "--no-cache", cwd=tmp_path)
    assert "Likely cause: it was stuck in a pit" in " ".join(done.stdout.split())
    kept = json.loads((tmp_path / "out/hole/outcomes.json").read_text())["figures"]["hand"]
    assert kept["off_share"] > 0.05 and kept["says"].startswith("The hand did not follow its path")

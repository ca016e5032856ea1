"""Beacons in sessions: a person is pulled to another part, not released, or the pull is recorded as touch."""

import pickle
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Event
from typing import Any

import numpy as np
import pytest

from beacon_ground import NAMES, SURFACE
from faulty_touch import FaultyTouch
from loop_devices import Failing
from tangible_core.data import HapticSurface, TickFlag, beacon_part
from tangible_core.data.ticks import BEACON_SHIFT
from tangible_core.errors import ConfigError, DeviceError, GeometryError
from tangible_core.plugins.registry import load_method
from tangible_core.servo import Beacon, Safety, Servo, beacon_to, null_touch
from tangible_core.servo.beacon import BeaconState
from tangible_core.session import Recording, Slot, beacons_felt, parts_felt, run_kiosk, run_simulated
from tangible_devices import Mock
from waiting import until


class TestPartNames:
    def test_part_number_accepts_name_number_and_number_as_text(self):
        assert [beacon_to(SURFACE, each).part for each in ("ground", " arc", 4, "5")] == [0, 4, 4, 4]
        assert pickle.loads(pickle.dumps(beacon_to(SURFACE, 4))).part == 4

    @pytest.mark.parametrize("part", ["arch", "", 5, "9", -1, "0"])
    def test_part_number_of_missing_part_lists_the_parts(self, part: str | int):
        with pytest.raises(ConfigError, match="the parts are 1: 'ground', 2: 'disc'"):
            beacon_to(SURFACE, part)

    def test_part_number_of_ambiguous_name_or_surface_without_parts_is_refused(self):
        twice = HapticSurface(SURFACE.relief, SURFACE.labels, None, ("a", "b", "a", "", ""))
        with pytest.raises(ConfigError, match=r"2 parts are called .*: 1, 3"):
            beacon_to(twice, "a")
        with pytest.raises(ConfigError, match="has no parts"):
            beacon_to(HapticSurface(SURFACE.relief), 0)
        with pytest.raises(GeometryError, match="part 6 is too small"):
            beacon_to(HapticSurface(SURFACE.relief, SURFACE.labels, None, (*NAMES, "gone")), 5)


IN_TIME_S = 60.0
AT_ONCE = Safety(ramp_s=0, stale_s=1.0, passivity="off")  # a late tick takes no force away


@pytest.fixture
def pointer() -> Iterator[tuple[Any, Callable[..., Any]]]:
    """A device that tests move and press, and the function that moves it once it is open."""
    from tangible_devices.pointer import PointerClient

    channel, clients = f"beacon-{time.monotonic_ns()}", []

    def client() -> PointerClient:
        clients.append(PointerClient(channel, IN_TIME_S))
        return clients[-1]

    options: dict[str, Any] = {"channel": channel, "stale_after_s": 10}
    yield load_method("device", "pointer")(**options), client
    for each in clients:
        each.close()


def lateral(servo: Servo) -> float:
    row = servo.ring.latest()
    return 0.0 if row is None else float(np.hypot(row[11], row[12]))


@pytest.mark.usefixtures("patient")
@pytest.mark.parametrize("law", ["proxy", pytest.param(None, marks=pytest.mark.whole)], ids=["compiled", "plain"])
def test_beacon_in_loop_process_is_switched_on_and_released_by_a_button(law: str | None, pointer: Any):
    device, client = pointer
    touch = load_method("render", law)().touch(SURFACE) if law else FaultyTouch()
    beacon = beacon_to(SURFACE, 1)
    with Servo(touch, device, AT_ONCE) as servo:
        hand = client()
        hand.send((-0.03, -0.02, 0.02))
        until(lambda: (row := servo.ring.latest()) is not None and abs(row[2] + 0.03) < 1e-6)
        assert servo.beacon == BeaconState(None) and lateral(servo) == 0
        servo.pull_to(beacon)
        assert servo.beacon == BeaconState(1)
        until(lambda: lateral(servo) > 0.7)
        until(lambda: servo.report().flagged["BEACON"] > 100)
        assert servo.report().beacon == 1
        servo.pull_to(beacon_to(SURFACE, 4))
        until(lambda: servo.report().beacon == 4)
        servo.pull_to(None)
        until(lambda: lateral(servo) == 0 and servo.report().beacon is None)
        assert servo.beacon == BeaconState(None)
        servo.pull_to(beacon)
        until(lambda: lateral(servo) > 0.5)
        hand.send((-0.03, -0.02, 0.02), 2)
        until(lambda: lateral(servo) == 0)
        assert servo.beacon == BeaconState(None, "button")
        rows, _ = servo.ring.since(0)
        pressed = int(np.flatnonzero(rows[:, 15])[0])
        flags = rows[:, 14].astype(int)
        assert beacon_part(int(flags[pressed - 1])) == 1 and beacon_part(int(flags[pressed])) is None
        assert np.hypot(*rows[pressed + 1, 11:13]) <= 0.31, "at most half a newton less a tick: the slew of the guard"
        servo.pull_to(beacon)
        until(lambda: lateral(servo) > 0.5)  # asked for again, with the button held
        servo.swap(touch)
        assert servo.beacon == BeaconState(None, "scene")
    assert servo.beacon == BeaconState(None)
    with pytest.raises(DeviceError):
        Servo(touch, device).pull_to(beacon)


@pytest.mark.usefixtures("patient")
@pytest.mark.usefixtures("loop_in_thread")
def test_beacon_of_each_kiosk_scene_pulls_until_a_button_is_pressed():
    turns = [Slot(null_touch(), AT_ONCE, SURFACE, beacon_to(SURFACE, part)) for part in (1, 4)]
    rows: list[np.ndarray] = []
    stop = Event()

    def keep(felt: np.ndarray) -> None:
        rows.append(felt)
        if 4 in Recording(felt).beacon:
            stop.set()

    last = run_kiosk(turns, Failing(fault="none"), IN_TIME_S, 0.4, keep=keep, stop=stop)
    felt = Recording(np.concatenate(rows)).beacon
    pulled, way = felt[felt >= 0], np.flatnonzero(np.diff(felt))
    assert (pulled[0], pulled[-1], last.flagged["BEACON"]) == (1, 4, pulled.size)
    assert len(way) <= 3, "to nothing at most once between the two, and before the first"


class TestSessionsAndRecordings:
    def record(self, beacon: Beacon | None) -> Recording:
        touch = load_method("render", "penalty")().touch(SURFACE)
        return run_simulated(touch, Mock(path="press"), 1.5, None, Safety(ramp_s=0), beacon=beacon)

    def test_beacon_ticks_are_recorded_and_left_out_of_replays(self, tmp_path: Path):
        felt, alone = self.record(beacon_to(SURFACE, 4)), self.record(None)
        for suffix in (".nc", ".npz", ".csv"):
            felt.save(tmp_path / f"a{suffix}")
            kept = Recording.load(tmp_path / f"a{suffix}")
            assert (kept.beacon == 4).all()
            assert beacons_felt(kept, SURFACE) == ((4, "arc", 1.0),)
        assert (alone.beacon == -1).all() and beacons_felt(alone, SURFACE) == ()
        from tangible_core.session import compare_replay, replay

        felt = self.record(beacon_to(SURFACE, 4))
        again = replay(load_method("render", "penalty")().touch(SURFACE), felt)
        assert compare_replay(felt, again)["compared"] == 0
        in_air = felt.rows.copy()
        in_air[:, 14] = TickFlag.BEACON | 4 << BEACON_SHIFT
        assert parts_felt(Recording(in_air), SURFACE) == ()
        in_air[:, 14] = TickFlag.BEACON | 4 << BEACON_SHIFT | TickFlag.TOUCHING
        assert parts_felt(Recording(in_air), SURFACE)

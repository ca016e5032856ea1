"""A beacon: a gentle pull to a part, conservative, at most 1 N, released by any button, and without effect when off."""

import math
import pickle
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Event
from typing import Any, cast

import numpy as np
import pytest

from faulty_touch import FaultyTouch
from loop_devices import SPEC, Circling, Failing
from tangible_core.data import Force, HapticState, HapticSurface, Relief, ServoReport, TickFlag, beacon_part
from tangible_core.errors import ConfigError, DeviceError, GeometryError
from tangible_core.plugins.interfaces import PlainTouch
from tangible_core.plugins.registry import load_method
from tangible_core.servo import Beacon, Safety, Servo, beacon_kernels, beacon_to, null_touch
from tangible_core.servo.beacon import (
    ASKED,
    LET_GO,
    MOST_N,
    PULL_N,
    RAMP_S,
    SEEN,
    SOFT_M,
    BeaconMemory,
    BeaconState,
    beacon_flags,
)
from tangible_core.servo.guard import layout
from tangible_core.servo.ring import Ring
from tangible_core.servo.ticks.python_tick import GuardedForce, guard_touch
from tangible_core.session import (
    Recording,
    Slot,
    beacons_felt,
    parts_felt,
    run_in_real_time,
    run_kiosk,
    run_simulated,
)
from tangible_devices import Mock
from waiting import until

WIDTH_M, LENGTH_M = 0.08, 0.06
NAMES = ("ground", "disc", "", "disc ", "arc")
T = 0.001
kernels = cast(Any, beacon_kernels)


def in_parts() -> HapticSurface:
    """Return a level surface of 80 x 60 mm: a disc of 5 mm, a bar one cell wide, a single cell, and an arc."""
    rows, columns = 120, 160
    y, x = np.mgrid[:rows, :columns]
    x_m, y_m = ((x + 0.5) / columns - 0.5) * WIDTH_M, (0.5 - (y + 0.5) / rows) * LENGTH_M
    labels = np.zeros((rows, columns), np.int32)
    labels[np.hypot(x_m - 0.02, y_m - 0.01) < 0.005] = 1
    labels[100, 30:70] = 2
    labels[10, 10] = 3
    labels[(abs(np.hypot(x_m, y_m) - 0.025) < 0.001) & (x_m < 0.01)] = 4
    relief = Relief(np.full(labels.shape, 0.002, np.float32), (WIDTH_M, LENGTH_M))
    return HapticSurface(relief, labels, None, NAMES)


SURFACE = in_parts()
PARTS = [1, 2, 3, 4]


def potential(memory: BeaconMemory, places_m: np.ndarray) -> np.ndarray:
    return np.array([kernels.potential(*memory.arrays, x, y) for x, y in places_m.tolist()])


def pulls(memory: BeaconMemory, states: np.ndarray, buttons: int = 0, ticks: int = 1) -> np.ndarray:
    """Return the pull in a guard's memory at states x, y, vx, vy, after a number of ticks at each."""
    kept = np.zeros(layout.MEMORY)
    found = []
    for x, y, vx, vy in states.tolist():
        for _ in range(ticks):
            kernels.pull(*memory.arrays, kept, T, x, y, vx, vy, buttons)
        found.append(kept[layout.PULL : layout.PULL + 2].copy())
    return np.array(found)


def faded_in(part: int) -> BeaconMemory:
    memory = BeaconMemory.of(beacon_to(SURFACE, part))
    pulls(memory, np.zeros((1, 4)), ticks=round(RAMP_S / T) + 2)
    return memory


class TestPull:
    @pytest.mark.parametrize("part", PARTS)
    def test_pull_is_the_gradient_of_the_potential_and_within_its_bound(self, part: int):
        """At rest and at 3 m/s, over the picture and far outside."""
        random = np.random.default_rng(part)
        places = random.uniform(-0.1, 0.1, (1500, 2))
        still_n = pulls(faded_in(part), np.hstack([places, 0 * places]))
        slopes = potential(faded_in(part), places)[:, 1:]
        assert np.allclose(still_n, -slopes, atol=1e-12)
        assert np.hypot(*still_n.T).max() <= 1.01 * PULL_N
        fast_n = pulls(faded_in(part), np.hstack([places, random.uniform(-3, 3, places.shape)]))
        assert np.hypot(*fast_n.T).max() <= MOST_N

    @pytest.mark.parametrize("part", PARTS)
    def test_pull_within_the_part_is_zero(self, part: int):
        """Anywhere in its cells, to the bit, however fast; a part of one cell included."""
        assert SURFACE.labels is not None
        random, (across_m, along_m) = np.random.default_rng(0), SURFACE.relief.pitch_m
        cells = np.argwhere(SURFACE.labels == part)[random.integers(0, np.count_nonzero(SURFACE.labels == part), 400)]
        row, column = (cells + random.uniform(0, 1, cells.shape)).T
        places = np.column_stack([column * across_m - WIDTH_M / 2, LENGTH_M / 2 - row * along_m])
        assert not pulls(faded_in(part), np.hstack([places, random.uniform(-1, 1, places.shape)])).any()

    def test_pull_next_to_a_disc_follows_the_formula(self):
        """Towards its middle, F D / sqrt(D^2 + s^2), but for the cells that a disc is made of."""
        turn = np.linspace(0, 2 * np.pi, 40)
        way = np.column_stack([np.cos(turn), np.sin(turn)])
        for far_m in (0.002, 0.005, 0.02):
            places = np.array([0.02, 0.01]) + (0.005 + far_m) * way
            found = pulls(faded_in(1), np.hstack([places, 0 * places]))
            inwards = -(found * way).sum(axis=1)
            aside = np.abs(found[:, 0] * way[:, 1] - found[:, 1] * way[:, 0])
            expected = [PULL_N * d / math.hypot(d, SOFT_M) for d in (far_m - 0.0011, far_m + 0.0003)]
            assert expected[0] <= inwards.min() and inwards.max() <= expected[1]
            assert aside.max() < 0.08 * PULL_N

    @pytest.mark.parametrize(("part", "wide_m", "share"), [*((part, 0.06, 1e-6) for part in PARTS), (4, 0.09, 2e-4)])
    def test_pull_along_closed_path_does_no_work(self, part: int, wide_m: float, share: float):
        """Line integrals of F.dx by Gauss's rule over each stretch, across ridges and the grid's end."""
        memory, random = faded_in(part), np.random.default_rng(part)
        nodes, weights = np.polynomial.legendre.leggauss(4)
        for _ in range(6):
            corners = random.uniform(-wide_m, wide_m, (5, 2))
            work = most = 0.0
            for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
                steps = np.linspace(0, 1, 1201)
                along = (steps[:-1, None] + (nodes + 1) / 2 * steps[1]).ravel()
                slopes = potential(memory, start + along[:, None] * (end - start))[:, 1:]
                done = -(slopes @ (end - start)) * np.tile(weights / 2 * steps[1], 1200)
                work, most = work + done.sum(), most + np.abs(done).sum()
            assert abs(work) < share * most

    def test_pull_is_lateral_and_independent_of_the_cell_size(self):
        assert SURFACE.labels is not None
        fine = np.kron(SURFACE.labels, np.ones((2, 2), np.int32))
        twice = HapticSurface(Relief(np.full(fine.shape, 0.002, np.float32), (WIDTH_M, LENGTH_M)), fine, None, NAMES)
        places = np.random.default_rng(3).uniform(-0.04, 0.04, (400, 2))
        for part in PARTS:
            coarse = potential(BeaconMemory.of(beacon_to(SURFACE, part)), places)[:, 0]
            finer = potential(BeaconMemory.of(beacon_to(twice, part)), places)[:, 0]
            assert np.abs(finer - coarse).max() < PULL_N * 0.0008

    def test_beacon_on_huge_surface_uses_coarser_cells_and_misses_no_part(self):
        labels = np.zeros((3000, 2000), np.int32)
        labels[1500, 1700] = 1
        surface = HapticSurface(Relief(np.zeros(labels.shape, np.float32), (0.2, 0.3)), labels, None, ("a", "b"))
        beacon = beacon_to(surface, "b")
        assert beacon.potential_j.size <= 1 << 20
        at = np.array([[(1700.5 / 2000 - 0.5) * 0.2, (0.5 - 1500.5 / 3000) * 0.3]])
        assert not potential(BeaconMemory.of(beacon), at).any()
        assert potential(BeaconMemory.of(beacon), at + 0.01)[0, 0] > 0


class TestFadingAndRelease:
    def test_pull_fades_in_over_half_a_second_without_jumps(self):
        memory = BeaconMemory.of(beacon_to(SURFACE, 1))
        found = pulls(memory, np.tile([-0.03, -0.02, 0.0, 0.0], (700, 1)))
        size = np.hypot(*found.T)
        assert size[0] == 0 and np.diff(size).max() <= 1.01 * PULL_N * T / RAMP_S
        assert size[250] == pytest.approx(size[-1] / 2, rel=0.01) and size[499] < size[501] == size[-1] > 0.7 * PULL_N

    @pytest.mark.parametrize("button", [1, 2, 128, 1 << 30])
    def test_beacon_is_released_by_any_pressed_button_for_good(self, button: int):
        memory = faded_in(1)
        at = np.array([[-0.03, -0.02, 0.0, 0.0]])
        assert pulls(memory, at).any() and memory.state == BeaconState(1)
        assert not pulls(memory, at, button).any()
        assert memory.state == BeaconState(None, "button")
        assert not pulls(memory, at, 0, ticks=2000).any(), "it stays released"
        memory.put(beacon_to(SURFACE, 1))
        assert not pulls(memory, at, button).any(), "and pressed again, before the pull began"
        memory.put(beacon_to(SURFACE, 1))
        assert pulls(memory, at, button, ticks=3).any(), "a button that is held is not pressed"

    def test_beacon_is_released_by_the_named_buttons_alone(self):
        """The bits above belong to the page, and change with every message."""
        memory = BeaconMemory.ready()
        memory.field = np.zeros(1 << 20, np.float32)
        memory.put(beacon_to(SURFACE, 1), 0xFF)
        at = np.array([[-0.03, -0.02, 0.0, 0.0]])
        for tag in range(1, 40):
            pulls(memory, at, tag << 8)
        assert memory.state.part == 1 and pulls(memory, at, 40 << 8).any()
        pulls(memory, at, (41 << 8) | 4)
        assert memory.state == BeaconState(None, "button")

    def test_pull_at_state_not_finite_is_zero(self):
        memory = faded_in(1)
        for bad in (math.nan, math.inf, -math.inf, 1e300):
            for axis in range(4):
                state = np.zeros((1, 4))
                state[0, axis] = bad
                found = pulls(memory, state)
                assert np.isfinite(found).all() and np.hypot(*found.T).max() <= MOST_N
                assert abs(bad) < math.inf or not found.any()
        assert pulls(memory, np.array([[-0.03, 0.0, 0.0, 0.0]])).any()

    def test_grid_larger_than_the_memory_is_not_read(self):
        memory = faded_in(1)
        for rows, columns in ((1 << 40, 1 << 40), (-5, 9), (0, 0), (2, 9), (1 << 62, 4)):
            memory.words[[2, 3]] = rows, columns
            assert not pulls(memory, np.array([[0.0, 0.0, 0.1, 0.1]])).any()


class Wall(PlainTouch):
    """A law in plain Python: 500 N/m below 2 mm."""

    stiffness_n_per_m = 500.0

    def force(self, state: HapticState) -> Force:
        return Force(0.0, 0.0, 500.0 * max(0.002 - state.position_m[2], 0.0))


def loop_of(beacon: Beacon | None, limits: Safety) -> tuple[GuardedForce, np.ndarray, BeaconMemory]:
    settings, memory = limits.arrays(SPEC, 500.0)
    asked = BeaconMemory.of(beacon)
    return guard_touch(Wall(), settings, memory, asked.arrays), memory, asked


def drift(allowed: GuardedForce, seconds: float, at: np.ndarray, mass_kg: float = 0.3, b: float = 0.0) -> np.ndarray:
    """Return a row a tick of a hand that only the force moves: position, velocity, force, flags; exactly integrated."""
    place, speed, rows = np.array(at, float), np.zeros(3), []
    for _ in range(round(seconds / T)):
        force, flags = allowed(HapticState((place[0], place[1], place[2]), (speed[0], speed[1], speed[2])), T)
        rows.append([*place, *speed, *force, flags])
        acting = np.array(force) - b * speed
        place, speed = place + speed * T + acting / mass_kg * T * T / 2, speed + acting / mass_kg * T
    return np.array(rows)


class TestBeaconInGuard:
    @pytest.mark.parametrize("mass_kg", [0.1, 0.5])
    @pytest.mark.parametrize(("damping", "gains_j", "over"), [(0.05, 1e-12, 1), (0.0, 1e-7, 100)])
    def test_pulled_hand_swings_less_and_less(self, mass_kg: float, damping: float, gains_j: float, over: int):
        """At 1 kHz in free air, once it has faded in: no tick adds energy with a thirtieth of a Falcon's damping, and
        with none at all no tenth of a second."""
        allowed, _, asked = loop_of(beacon_to(SURFACE, 1), Safety(passivity="off", ramp_s=0))
        rows = drift(allowed, 8.0, np.array([-0.03, -0.02, 0.01]), mass_kg, damping)
        kinetic = 0.5 * mass_kg * (rows[:, 3:5] ** 2).sum(axis=1)
        energy = (kinetic + potential(asked, rows[:, :2])[:, 0])[520::over]
        assert np.diff(energy).max() < gains_j
        assert energy[-1] < 0.1 * energy[0]
        assert np.hypot(rows[:, 6], rows[:, 7]).max() <= MOST_N and not rows[:, 8].any(), "neither lifted nor pressed"

    def test_pull_is_not_counted_as_debt_by_the_guard(self):
        """A pulled hand is not damped and owes nothing at the end; a law that gives energy is damped as ever."""
        allowed, memory, _ = loop_of(beacon_to(SURFACE, 1), Safety(ramp_s=0))
        rows = drift(allowed, 4.0, np.array([-0.03, -0.02, 0.01]), b=2.0)
        assert not (rows[:, 9].astype(int) & TickFlag.DAMPED).any()
        assert np.hypot(rows[-1, 0] - 0.02, rows[-1, 1] - 0.01) < 0.007
        assert abs(memory[layout.ENERGY_J]) < 2e-3

    def test_pull_on_a_wall_leaves_the_force_along_z(self):
        """The pull is lateral, and TOUCHING is about the wall alone, also in the air."""
        states = [(-0.03, -0.02, 0.004 - 0.003 * math.sin(0.01 * i)) for i in range(900)]
        (with_it, *_), (without, *_) = (loop_of(b, Safety(ramp_s=0)) for b in (beacon_to(SURFACE, 1), None))
        found = [(with_it(HapticState(s), T), without(HapticState(s), T)) for s in states]
        for (force, flags), (alone, own) in found:
            assert force.z == pytest.approx(alone.z, abs=1e-9)
            assert bool(flags & TickFlag.TOUCHING) == bool(own & TickFlag.TOUCHING)
            assert beacon_part(flags) == 1 and beacon_part(own) is None

    @pytest.mark.parametrize("law", ["proxy", None], ids=["compiled", "plain"])
    def test_beacon_that_is_off_leaves_forces_to_the_bit(self, law: str | None):
        random = np.random.default_rng(4)
        path = np.cumsum(random.normal(0, 2e-4, (1500, 3)), axis=0) + np.array([0, 0, 0.002])

        def forces(with_one: bool) -> np.ndarray:
            touch = load_method("render", law)().touch(SURFACE) if law else Wall()
            settings, memory = Safety().arrays(SPEC, 800.0)
            pull = BeaconMemory.ready().arrays if with_one else None
            allowed = guard_touch(touch, settings, memory, pull)
            return np.array([[*force, flags] for force, flags in (allowed(HapticState(tuple(p)), T) for p in path)])

        assert forces(True).tobytes() == forces(False).tobytes()

    def test_broken_state_with_beacon_gives_zero_force(self):
        allowed, *_ = loop_of(beacon_to(SURFACE, 1), Safety(ramp_s=0))
        drift(allowed, 1.0, np.array([-0.03, -0.02, 0.01]))
        force, flags = allowed(HapticState((math.nan, 0.0, 0.01)), T)
        assert force == (0, 0, 0) and flags & TickFlag.NOT_FINITE
        force, flags = allowed(HapticState((-0.03, 0.0, 0.01)), 1.0)
        assert force == (0, 0, 0) and flags & TickFlag.STALE

    def test_beacon_stiffness_is_added_to_the_law_stiffness(self):
        settings, memory = Safety(**{"ramp_s": 0, "passivity": "off"}).arrays(SPEC, 2300.0)
        asked = BeaconMemory.of(beacon_to(SURFACE, 1))
        allowed = guard_touch(Wall(), settings, memory, asked.arrays)
        for _ in range(900):
            allowed(HapticState((-0.03, -0.02, 0.01)), T)
        assert memory[layout.GAIN] == pytest.approx(2400 / 2460, abs=0.002)


class TestPartNames:
    def test_part_number_accepts_name_number_and_number_as_text(self):
        assert [beacon_to(SURFACE, each).part for each in ("ground", " arc", 4, "4")] == [0, 4, 4, 4]
        assert pickle.loads(pickle.dumps(beacon_to(SURFACE, 4))).part == 4

    @pytest.mark.parametrize(
        ("part", "said"),
        [
            ("arch", "no part is called 'arch' (did you mean 'arc'?); the parts are 0: 'ground'"),
            ("", "no part is called ''; the parts are 0: 'ground', 1: 'disc'"),
            (5, "there is no part 5; the parts are 0: 'ground'"),
            ("9", "there is no part 9"),
            (-1, "there is no part -1"),
        ],
    )
    def test_part_number_of_missing_part_lists_the_parts(self, part: str | int, said: str):
        with pytest.raises(ConfigError) as error:
            beacon_to(SURFACE, part)
        assert said in str(error.value) and "\n" not in str(error.value)

    def test_part_number_of_ambiguous_name_or_surface_without_parts_is_refused(self):
        twice = HapticSurface(SURFACE.relief, SURFACE.labels, None, ("a", "b", "a", "", ""))
        with pytest.raises(ConfigError, match=r"2 parts are called .*: 0, 2"):
            beacon_to(twice, "a")
        with pytest.raises(ConfigError, match="has no parts"):
            beacon_to(HapticSurface(SURFACE.relief), 0)
        with pytest.raises(GeometryError, match="part 5 is too small"):
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


@pytest.mark.slow
@pytest.mark.usefixtures("patient")
@pytest.mark.parametrize("law", ["proxy", None], ids=["compiled", "plain"])
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
        until(lambda: lateral(servo) == 0)
        assert servo.beacon == BeaconState(None) and servo.report().beacon is None
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


@pytest.mark.slow
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
    stop = Event()

    def heard(report: ServoReport) -> None:
        if report.beacon == 1:
            stop.set()

    one = run_in_real_time(null_touch(), Circling(), IN_TIME_S, AT_ONCE, heard, beacon=turns[0].beacon, stop=stop)
    assert one.beacon == 1


class TestSessionsAndRecordings:
    def record(self, beacon: Beacon | None) -> Recording:
        touch = load_method("render", "penalty")().touch(SURFACE)
        return run_simulated(touch, Mock(path="press"), 1.5, None, Safety(ramp_s=0), beacon=beacon)

    def test_recording_has_the_ticks_and_the_part_of_a_beacon(self, tmp_path: Path):
        felt, alone = self.record(beacon_to(SURFACE, 4)), self.record(None)
        for suffix in (".nc", ".npz", ".csv"):
            felt.save(tmp_path / f"a{suffix}")
            kept = Recording.load(tmp_path / f"a{suffix}")
            assert (kept.beacon == 4).all()
            assert beacons_felt(kept, SURFACE) == ((4, "arc", 1.0),)
        assert (alone.beacon == -1).all() and beacons_felt(alone, SURFACE) == ()

    def test_beacon_ticks_are_left_out_of_replays_and_of_touched_parts(self):
        from tangible_core.session import compare_replay, replay

        felt = self.record(beacon_to(SURFACE, 4))
        again = replay(load_method("render", "penalty")().touch(SURFACE), felt)
        assert compare_replay(felt, again)["compared"] == 0
        in_air = felt.rows.copy()
        in_air[:, 14] = beacon_flags(4)
        assert parts_felt(Recording(in_air), SURFACE) == ()
        in_air[:, 14] = beacon_flags(4) | TickFlag.TOUCHING
        assert parts_felt(Recording(in_air), SURFACE)

    def test_beacon_without_memory_is_one_error(self, monkeypatch: pytest.MonkeyPatch):
        def full(*_: object) -> None:
            raise OSError(28, "No space left on device")

        ring = Ring.create(64)
        try:
            ring.allocate_beacon()
            monkeypatch.setattr("os.posix_fallocate", full, raising=False)
            with pytest.raises(DeviceError, match="no room for a beacon: No space left"):
                ring.allocate_beacon()
        finally:
            ring.remove()

    def test_beacon_ends_with_swapped_scene(self):
        memory = faded_in(1)
        memory.leave()
        assert memory.state == BeaconState(None, "scene")
        assert not pulls(memory, np.array([[-0.03, 0.0, 0.0, 0.0]])).any()
        fresh = BeaconMemory.ready()
        fresh.leave()
        assert (
            fresh.state == BeaconState(None) and [int(fresh.words[each]) for each in (ASKED, SEEN, LET_GO)] == [0] * 3
        )

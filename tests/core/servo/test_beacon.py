"""A beacon: a pull that is not gentle, gains energy, or goes on when a button is pressed, drags a hand about."""

import math

import numpy as np
import pytest

from beacon_ground import LENGTH_M, PARTS, SURFACE, WIDTH_M, T, faded_in, kernels, pulls
from loop_devices import SPEC
from tangible_core.data import Force, HapticState, HapticSurface, Relief, TickFlag, beacon_part, digest_of
from tangible_core.plugins.interfaces import PlainTouch
from tangible_core.plugins.registry import load_method
from tangible_core.servo import Beacon, Safety, beacon_to
from tangible_core.servo.beacon import BRAKED_FROM, MAX_N, PULL_N, RAMP_S, SOFT_M, BeaconMemory, BeaconState
from tangible_core.servo.guard import layout
from tangible_core.servo.ticks.loop import GuardedForce, guard_touch


def potential(memory: BeaconMemory, places_m: np.ndarray) -> np.ndarray:
    return np.array([kernels.potential(*memory.arrays, x, y) for x, y in places_m.tolist()])


class TestPull:
    @pytest.mark.parametrize("part", PARTS)
    def test_pull_is_the_bounded_gradient_of_the_potential_and_zero_within_the_part(self, part: int):
        """At rest and at 3 m/s, over the picture and far outside."""
        random = np.random.default_rng(part)
        places = random.uniform(-0.1, 0.1, (1500, 2))
        still_n = pulls(faded_in(part), np.hstack([places, 0 * places]))
        slopes = potential(faded_in(part), places)[:, 1:]
        assert np.allclose(still_n, -slopes, atol=1e-12)
        assert np.hypot(*still_n.T).max() <= 1.01 * PULL_N
        fast_n = pulls(faded_in(part), np.hstack([places, random.uniform(-3, 3, places.shape)]))
        assert np.hypot(*fast_n.T).max() <= MAX_N
        steep = np.hypot(*still_n.T)
        full = steep > BRAKED_FROM * PULL_N
        away_n = pulls(faded_in(part), np.hstack([places, -3 * still_n / np.maximum(steep, 1e-9)[:, None]]))
        assert np.hypot(*away_n[full].T) == pytest.approx(np.minimum(steep[full] + MAX_N - PULL_N, MAX_N), rel=1e-9)
        assert full.any()
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

    @pytest.mark.parametrize("button", [1, 1 << 30])
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

    def test_pull_is_zero_where_state_or_memory_is_not_valid(self):
        memory = faded_in(1)
        for bad in (math.nan, math.inf, -math.inf, 1e300):
            for axis in range(4):
                state = np.zeros((1, 4))
                state[0, axis] = bad
                found = pulls(memory, state)
                assert np.isfinite(found).all() and np.hypot(*found.T).max() <= MAX_N
                assert abs(bad) < math.inf or not found.any()
        assert pulls(memory, np.array([[-0.03, 0.0, 0.0, 0.0]])).any()
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
    def test_pull_in_the_guard_leaves_walls_and_is_no_debt(self):
        """A pulled hand is not damped and owes nothing at the end; a law that gives energy is damped as ever."""
        allowed, memory, _ = loop_of(beacon_to(SURFACE, 1), Safety(ramp_s=0))
        rows = drift(allowed, 4.0, np.array([-0.03, -0.02, 0.01]), b=2.0)
        assert not (rows[:, 9].astype(int) & TickFlag.DAMPED).any()
        assert np.hypot(rows[-1, 0] - 0.02, rows[-1, 1] - 0.01) < 0.007
        assert abs(memory[layout.ENERGY_J]) < 2e-3
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

        assert digest_of(forces(True)) == digest_of(forces(False))

    def test_beacon_stiffness_is_added_to_the_law_stiffness(self):
        settings, memory = Safety(**{"ramp_s": 0, "passivity": "off"}).arrays(SPEC, 2300.0)
        asked = BeaconMemory.of(beacon_to(SURFACE, 1))
        allowed = guard_touch(Wall(), settings, memory, asked.arrays)
        for _ in range(900):
            allowed(HapticState((-0.03, -0.02, 0.01)), T)
        assert memory[layout.GAIN] == pytest.approx(2400 / 2460, abs=0.002)

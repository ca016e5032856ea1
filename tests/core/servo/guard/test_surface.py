"""The energy account of a moving surface: without it a film is damped away, or lifts a hand without bound."""

from typing import Any

import numpy as np
import pytest

from moving_plane import AT_M, GOAL_M, STEP_M, MovingPlane, level
from tangible_core import load_method
from tangible_core.data import DeviceSpec, HapticState, TickFlag
from tangible_core.servo.guard import layout as at
from tangible_core.servo.guard.guard import guard, restart
from tangible_core.servo.guard.safety import SURFACE_M_PER_S, Coupling, Safety
from tangible_core.servo.ticks.loop import guard_touch
from tangible_core.session import run_simulated

SPEC = DeviceSpec(8.0, 3000.0, 1.5, (0.08, 0.08, 0.08), 3e-5)
STIFF = 800.0
STRICT = Safety(passivity="strict", ramp_s=0, max_step_n=10)


class Felt:
    """A plane under a hand on a given path, tick by tick."""

    def __init__(self, safety: Safety = STRICT, stiffness_n_per_m: float = STIFF) -> None:
        self.film = MovingPlane(0.01, stiffness_n_per_m)
        self.settings, self.memory = safety.arrays(SPEC, stiffness_n_per_m)
        self._allowed = guard_touch(self.film.touch, self.settings, self.memory)
        self._at_m = self.force_n = None
        self.work_j, self.damped, self.time_s = 0.0, 0, 0.0

    def tick(self, hand_m: float, rises_m: float = 0.0) -> float:
        """Do a tick in which the plane rises, with the hand at this height."""
        plane = self.film.plane
        plane[GOAL_M], plane[STEP_M] = plane[AT_M] + rises_m, abs(rises_m)
        speed = 0.0 if self._at_m is None else (hand_m - self._at_m) / 0.001
        force, flags = self._allowed(HapticState((0.0, 0.0, hand_m), (0.0, 0.0, speed), self.time_s), 0.001)
        if self._at_m is not None:
            self.work_j += self.force_n * (hand_m - self._at_m)
        self._at_m, self.force_n = hand_m, force.z
        self.damped += bool(flags & TickFlag.DAMPED)
        self.time_s += 0.001
        return force.z

    @property
    def energy_j(self) -> float:
        return float(self.memory[at.ENERGY_J])

    @property
    def stored_j(self) -> float:
        return self.force_n**2 / 2 / STIFF


class TestSurfaceWork:
    def test_surface_work_on_hand_at_rest_is_stored_in_the_spring_and_returns(self):
        """Exactly, at any speed; half of the last way counts with the next force."""
        felt, hand_m = Felt(), 0.009
        felt.tick(hand_m)
        before_j, ways = felt.stored_j, np.random.default_rng(0).uniform(0, 1e-4, 60)
        for rise in (*ways, *-ways[::-1]):
            felt.tick(hand_m, rise)
            assert felt.energy_j + felt.force_n * rise / 2 == pytest.approx(felt.stored_j - before_j, abs=1e-15)
        felt.tick(hand_m)
        assert felt.energy_j == pytest.approx(0, abs=1e-15)
        assert not felt.damped

    @pytest.mark.parametrize("way_m", [5e-5, -5e-5])
    def test_carried_hand_takes_the_surface_work_and_is_not_damped(self, way_m: float):
        felt = Felt()
        felt.tick(0.00801)  # it presses by a hair, so that rounding owes nothing
        for i in range(101):
            assert felt.tick(0.008 + way_m * i, way_m if i else 0.0) == pytest.approx(STIFF * 0.002)
        pressed_j = 1e-5 * STIFF * 0.00199
        assert felt.work_j == pytest.approx(STIFF * 0.002 * 100 * way_m - pressed_j)
        assert felt.damped == 0
        if way_m > 0:  # of the last way, half is yet to count
            assert felt.energy_j == pytest.approx(pressed_j - STIFF * 0.002 * way_m / 2)

    def test_surface_work_is_used_up_by_a_ratchet_and_no_debt_of_a_sinking_one(self):
        """That energy is lost to the hand: neither the surface nor the loop owes it."""
        felt = Felt()
        for i in range(21):
            felt.tick(0.0101 - 1e-4 * i)
        pressed_j = felt.energy_j
        assert pressed_j > 1e-3
        for _ in range(15):
            felt.tick(0.0081, -1e-4)
        assert felt.energy_j == pressed_j
        felt, hand_m, way_m, most_j = Felt(), 0.0101, 5e-5, 0.02
        felt.settings[at.SURFACE_W], felt.settings[at.MAX_SURFACE_J], felt.memory[at.MAY_GIVE_J] = 0.0, most_j, most_j
        ways = [(-1, 0)] * 42 + ([(1, 1)] * 100 + [(0, -1)] * 38 + [(-1, -1)] * 62 + [(-1, 0)] * 38) * 10
        for hand, plane in ways:
            hand_m, before = hand_m + hand * way_m, felt.damped
            felt.tick(hand_m, plane * way_m)
            if hand > 0 and felt.damped > before:
                break
        assert 0.95 * most_j < felt.work_j < 1.05 * most_j

    def test_allowed_surface_work_recovers_with_time_and_ends_in_free_air(self):
        felt = Felt()
        felt.tick(0.009)
        felt.memory[at.MAY_GIVE_J] = 0.0
        for _ in range(100):
            felt.tick(0.009)
        assert felt.memory[at.MAY_GIVE_J] == pytest.approx(0.1 * SPEC.max_force_n * SURFACE_M_PER_S)
        felt = Felt()
        felt.tick(0.009)
        for _ in range(20):
            felt.tick(0.009, 5e-5)
        assert felt.memory[at.GIVEN_J] > 0 and felt.energy_j > 0
        felt.tick(0.02)
        felt.tick(0.02)
        assert felt.memory[at.GIVEN_J] == felt.energy_j == 0

    @pytest.mark.parametrize("rise", [np.nan, np.inf, -np.inf, 1.0, -1e300])
    def test_rise_not_finite_or_too_fast_is_not_work(self, rise: float):
        arrays = STRICT.arrays(SPEC, STIFF)
        for _ in range(3):
            arrays[1][at.RISE_M] = rise
            assert guard(*arrays, 0.001, *[0.0] * 6, 0.0, 0.0, 1.0)[2] == 1.0
        assert arrays[1][at.ENERGY_J] == 0
        assert np.isfinite(arrays[1]).sum() == at.MEMORY - (not np.isfinite(rise)) - 1  # of the tool there is none

    def test_surface_work_is_none_at_rest_or_of_a_swapped_scene(self):
        felt = Felt()
        for _ in range(20):
            felt.tick(0.009, 5e-5)
        restart(felt.memory)
        assert felt.memory[[at.GIVEN_J, at.SURFACE_FORCE_N, at.LAST_RISE_M]].tolist() == [0, 0, 0]
        random = np.random.default_rng(0)
        steps = np.cumsum(random.normal(0, 2e-5, (500, 3)), axis=0)
        given: list[list[tuple[float, ...]]] = []
        for may_j in (0.0, 1e9):
            settings, memory = Safety(ramp_s=0.1).arrays(SPEC, STIFF)
            memory[at.MAY_GIVE_J] = settings[at.SURFACE_W] = settings[at.MAX_SURFACE_J] = may_j
            speeds = np.diff(steps, axis=0, prepend=steps[:1]) / 0.001
            pushed = [(-v[0], 0.0, max(0.0, -STIFF * x[2])) for x, v in zip(steps, speeds, strict=True)]
            given.append(
                [guard(settings, memory, 0.001, *x, *v, *f) for x, v, f in zip(steps, speeds, pushed, strict=True)]
            )
        assert given[0] == given[1]


FREE: dict[str, Any] = {"passivity": "strict", "ramp_s": 0, "max_step_n": 10}
HARD = {"stiffness_n_per_m": 20_000.0, "damping_n_s_per_m": 0.5}


class TestCoupling:
    @pytest.mark.parametrize(
        ("hand_m", "stiffness_n_per_m", "more"),
        [(0.007, STIFF, {"max_force_n": 0.5}), (0.0099, 20_000.0, {"coupling": Coupling(**HARD)})],
    )
    def test_surface_work_of_limited_force_counts_the_sent_part(self, hand_m: float, stiffness_n_per_m: float, more):
        felt = Felt(Safety(**{**FREE, "coupling": "auto", **more}), stiffness_n_per_m)
        for _ in range(500):
            felt.tick(hand_m)
        wanted_n = stiffness_n_per_m * (0.01 - hand_m)
        assert 0.1 < felt.force_n < 0.3 * wanted_n
        assert felt.memory[at.SURFACE_FORCE_N] == pytest.approx(felt.force_n, rel=0.01)


def damped_share(
    film: MovingPlane, rate_hz: float, coupling, seconds: float, from_s: float, hand_n_s_per_m: float = 6.0
) -> float:
    """Return the share of damped ticks of a circling hand on a plane that moves up and down by 3 mm at this rate."""
    hand = {"damping_n_s_per_m": hand_n_s_per_m}
    path = {"path": "circle", "size_m": (0.02, 0.02), "z_m": 0.006, "speed_m_per_s": 0.02}
    mock = load_method("device", "mock").model_validate({"hand": hand, **path})
    due = 0

    def frames(time_s: float) -> None:
        nonlocal due
        if time_s >= due / 30:
            film.show(level(0.012 + 0.003 * np.sin(2 * np.pi * rate_hz * due / 30)), due)
            due += 1

    felt = run_simulated(film, mock, seconds, limits=Safety(coupling=coupling), frames=frames)
    assert felt.frame[-1] == due - 1
    return float(np.mean(felt.flags[round(1000 * from_s) :] & TickFlag.DAMPED > 0))


class TestMovedHand:
    @pytest.mark.parametrize(("rate_hz", "coupling"), [(0.5, "auto"), (2.0, None)])
    def test_hand_moved_by_surface_is_not_damped(self, rate_hz: float, coupling):
        assert damped_share(MovingPlane(0.012, STIFF), rate_hz, coupling, 5.0, 1.5) < 0.01

    def test_hand_shaken_by_surface_is_damped(self):
        """At 8 Hz a firm hand is given more than the surface may give for long."""
        assert damped_share(MovingPlane(0.012, STIFF), 8.0, None, 6.0, 5.0, hand_n_s_per_m=20.0) > 0.5

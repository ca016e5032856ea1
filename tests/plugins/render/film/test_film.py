"""A video's moving surface would jump under the hand, or never arrive: shared slots, its speed, its forces."""

import numpy as np
import pytest

from benchmarks.video_stress import stress
from tangible_core.compiled.touch import FRAME, RISE_M, CompiledTouch
from tangible_core.data import HapticState, HapticSurface, Material, Relief
from tangible_core.errors import ConfigError, GeometryError
from tangible_core.plugins.interfaces import Film
from tangible_render.film import playing
from tangible_render.proxy import Proxy

ROW, COLUMN = np.indices((30, 40))
EXTENT_M = (0.08, 0.06)
TICKS = 33
STEP_N = 0.08 + 1e-9
LAWS = {
    "spring": Proxy(),
    "stiff": Proxy(stiffness_n_per_m=2500.0),
    "friction": Proxy(static_friction=0.6, dynamic_friction=0.4, damping_n_s_per_m=1.0),
}


def relief(phase: float = 0.0, high_m: float = 0.002) -> Relief:
    heights = 0.008 + high_m * np.sin(COLUMN / 5 + phase) * np.cos(ROW / 7)
    return Relief(heights.astype(np.float32), EXTENT_M)


def level(height_m: float) -> Relief:
    return Relief(np.full((30, 40), height_m, np.float32), EXTENT_M)


def start(law: Proxy = LAWS["spring"], first: Relief | None = None) -> Film:
    return law.film(HapticSurface(first or relief()))


def hold(film: Film, ticks: int, z: float = 0.006, x: float = 0.003) -> np.ndarray:
    return film.touch.path(np.tile([x, 0.002, z], (ticks, 1)))


def moving(film: Film) -> np.ndarray:
    assert isinstance(film.touch, CompiledTouch)
    return film.touch.moving


def slots_of(film: Film):
    return film._slots  # pyright: ignore[reportAttributeAccessIssue]


class TestBounds:
    """The bounds by which a tick skips reading the surface hold for all of a slot's way."""

    def test_surface_that_moves_pushes_at_its_height_with_its_texture(self):
        for first_m, then_m, hand_m in ((0.008, 0.005, 0.0065), (0.005, 0.008, 0.0045)):
            film = start(first=level(first_m))
            film.show(level(then_m), 1)
            there_m = first_m + (then_m - first_m) * np.arange(1, TICKS + 1) / TICKS
            assert hold(film, TICKS, z=hand_m)[:, 2] == pytest.approx(800 * np.maximum(there_m - hand_m, 0), abs=1e-3)
        ice = Material("ice", 800.0, 0.0, 0.0, 0.0, roughness_m=3e-4, grain_m=1e-3)
        labels = np.zeros(level(0.008).height_m.shape, np.int32)
        path = np.column_stack([np.linspace(0, 0.003, 300), np.full(300, 0.002), np.full(300, 0.0075)])
        film = Proxy().film(HapticSurface(level(0.005), labels, (ice,)))
        film.show(level(0.008), 1)
        hold(film, 2 * TICKS, z=0.02)
        still = Proxy().touch(HapticSurface(level(0.008), labels, (ice,))).path(path)
        assert np.ptp(still[:, 2]) > 0.05
        assert film.touch.path(path)[1:] == pytest.approx(still[1:], abs=1e-3)


class TestSlots:
    def test_latest_frame_wins_and_slots_begin_where_the_last_ended(self):
        film, random = start(), np.random.default_rng(0)
        for frame in range(40):
            before, _ = playing.slots(slots_of(film).shared)
            ends = slots_of(film).pairs[before, ..., 1].copy()
            film.show(relief(random.uniform(0, 7)), frame)
            _, after = playing.slots(slots_of(film).shared)
            assert after != before
            assert np.array_equal(slots_of(film).pairs[after, ..., 0], ends)
            assert np.array_equal(slots_of(film).pairs[before, ..., 1], ends)
            hold(film, int(random.integers(1, 60)))
        film = start()
        for frame in range(1, 6):
            film.show(relief(frame), frame)
        assert film.dropped == 4
        hold(film, 2)
        assert moving(film)[FRAME] == 5
        film.show(relief(7), 7)
        film.show(relief(7), 7)  # the same once more is none that was dropped
        assert film.dropped == 4
        shared = np.array([playing.state(0, 1), 5], np.int64)
        assert not playing.publish(shared, 1, 1, 2)
        assert playing.slots(shared) == (0, 1)
        assert playing.publish(shared, 0, 1, 2)
        assert playing.slots(shared) == (0, 2)

    def test_host_losing_the_race_fills_the_slot_again(self, monkeypatch):
        film, lost = start(), []
        hold(film, 1)
        film.show(relief(1), 1)
        hold(film, 1)
        film.show(relief(2), 2)
        first = playing.publish

        def late(shared, *slots):
            if not lost:
                lost.append(hold(film, 2 * TICKS))  # the loop goes on to frame 2 meanwhile
            return first(shared, *slots)

        monkeypatch.setattr("tangible_render.film.slots.publish", late)
        film.show(relief(3), 3)
        hold(film, 2 * TICKS)
        assert moving(film)[FRAME] == 3
        steps = np.linalg.norm(np.diff(np.vstack([lost[0], hold(film, 1)]), axis=0), axis=1)
        assert lost and steps.max() < 2.0


class TestSpeed:
    @pytest.mark.parametrize(("law", "most_m"), [("spring", 1e-4), ("stiff", 0.08 / 2500)])
    def test_places_move_within_their_speed_and_the_rest_in_time(self, law: str, most_m: float):
        heights = relief(0.3).height_m.copy()
        heights[:, 30:] = 0.02
        film = start(LAWS[law])
        film.show(Relief(heights, EXTENT_M), 1)
        assert not film.arrived
        rises = []
        for _ in range(TICKS):
            hold(film, 1, x=-0.03)
            rises.append(moving(film)[RISE_M])
        still = Proxy(stiffness_n_per_m=LAWS[law].stiffness_n_per_m).touch(HapticSurface(Relief(heights, EXTENT_M)))
        at = np.tile([-0.03, 0.002, 0.006], (50, 1))
        if law == "spring":
            assert film.touch.path(at)[-1] == pytest.approx(still.path(at)[-1], abs=5e-3)
        assert np.abs(rises).max() <= most_m * (1 + 1e-6)
        shown = 1
        while not film.arrived:
            film.show(Relief(heights, EXTENT_M), 1)
            hold(film, TICKS + 1)
            shown += 1
        assert shown == np.ceil((0.02 - relief().height_m[:, 30:].min()) / most_m / TICKS)
        assert film.touch.path(at)[-1] == pytest.approx(still.path(at)[-1], abs=5e-3)


class TestForces:
    @pytest.mark.parametrize("name", LAWS)
    def test_force_of_a_lost_hold_falls_step_by_step(self, name: str):
        ridge = 0.002 + 0.014 * np.exp(-(((COLUMN - 20.4) / 2) ** 2))
        film = start(LAWS[name], Relief(ridge.astype(np.float32), EXTENT_M))
        slide = np.linspace(-0.012, 0.0021, 1500)
        force = film.touch.path(np.column_stack([slide, 0 * slide, np.full(1500, 0.004)]))[-1:]
        force = np.vstack([force, film.touch.path(np.tile([slide[-1], 0, 0.004], (300, 1)))])[-1:]
        assert np.linalg.norm(force) > 2.0
        for frame in range(1, 16):
            film.show(level(0.002), frame)
            force = np.vstack([force, film.touch.path(np.tile([slide[-1], 0, 0.004], (TICKS, 1)))])
        assert film.arrived
        assert np.linalg.norm(np.diff(force, axis=0), axis=1).max() <= STEP_N
        assert not force[-1].any()

    def test_films_gain_no_energy_and_rise_without_contact_is_zero(self):
        film = start()
        film.show(level(0.012), 1)
        hold(film, 3, z=0.03)
        assert moving(film)[RISE_M] == 0.0
        film.touch.force(HapticState((np.nan, 0.0, 0.0)))
        assert moving(film)[RISE_M] == 0.0
        hold(film, 1)
        assert moving(film)[RISE_M] > 0.0
        worst = stress(100_000)
        assert worst.ticks == 100_000 and worst.touched > 25_000 and worst.moved_j > 1
        assert worst.not_finite == 0
        assert worst.step_n <= STEP_N
        assert worst.gained_j <= 1e-3 and worst.guarded_j <= 0


class TestRefusals:
    def test_frame_of_another_size_is_refused(self):
        for shape, extent_m in (((10, 20), EXTENT_M), ((30, 40), (0.081, 0.06))):
            with pytest.raises(GeometryError):
                start().show(Relief(np.zeros(shape, np.float32), extent_m), 1)

    @pytest.mark.parametrize("bad", [0.0, np.nan, np.inf])
    def test_time_not_positive_is_refused(self, bad: float):
        for option in ("period_s", "frame_s"):
            with pytest.raises(ConfigError, match=option):
                Proxy().film(HapticSurface(relief()), **{option: bad})

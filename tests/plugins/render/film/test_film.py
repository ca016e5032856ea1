"""A film of the proxy: slots that two sides share, the speed of a surface, and what is felt meanwhile."""

import threading
from itertools import pairwise

import numpy as np
import pytest

from benchmarks.video_stress import stress
from tangible_core.compiled.touch import FRAME, RISE_M, CompiledTouch
from tangible_core.data import HapticState, HapticSurface, Relief
from tangible_core.errors import ConfigError, GeometryError
from tangible_core.materials.assignment import library
from tangible_core.plugins.interfaces import Film, Filming
from tangible_core.servo import parcel
from tangible_render.engraved import Engraved
from tangible_render.film import playing
from tangible_render.film.slots import SLOTS
from tangible_render.proxy import Proxy
from tangible_render.with_materials import WithMaterials

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


def begun(law: Proxy = LAWS["spring"], first: Relief | None = None) -> Film:
    return law.film(HapticSurface(first or relief()))


def hold(film: Film, ticks: int, z: float = 0.006, x: float = 0.003) -> np.ndarray:
    return film.touch.path(np.tile([x, 0.002, z], (ticks, 1)))


def moving(film: Film) -> np.ndarray:
    assert isinstance(film.touch, CompiledTouch)
    return film.touch.moving


def slots_of(film: Film):
    return film._slots  # pyright: ignore[reportAttributeAccessIssue]


class TestBounds:
    """What lets a tick be decided without reading the surface holds for all of a slot's way."""

    def test_a_surface_that_sinks_is_felt_until_it_is_below_the_hand(self):
        film = begun(first=level(0.008))
        film.show(level(0.005), 1)
        up_n = hold(film, TICKS, z=0.0065)[:, 2]
        there_m = 0.008 - 0.003 * np.arange(1, TICKS + 1) / TICKS
        assert up_n == pytest.approx(800 * np.maximum(there_m - 0.0065, 0), abs=1e-3)

    def test_what_was_level_and_rises_is_where_it_is(self):
        film = begun(first=level(0.005))
        film.show(level(0.008), 1)
        up_n = hold(film, TICKS, z=0.0045)[:, 2]
        assert up_n == pytest.approx(800 * (0.0005 + 0.003 * np.arange(1, TICKS + 1) / TICKS), abs=1e-3)


class TestSlots:
    def test_a_slot_begins_to_the_bit_with_what_the_one_before_ends_with(self):
        film, random = begun(), np.random.default_rng(0)
        for frame in range(40):
            before, _ = playing.slots(slots_of(film).shared)
            ends = slots_of(film).pairs[before, ..., 1].copy()
            film.show(relief(random.uniform(0, 7)), frame)
            _, after = playing.slots(slots_of(film).shared)
            assert after != before
            assert np.array_equal(slots_of(film).pairs[after, ..., 0], ends)
            assert np.array_equal(slots_of(film).pairs[before, ..., 1], ends)
            hold(film, int(random.integers(1, 60)))

    def test_the_latest_frame_wins_and_the_others_are_counted(self):
        film = begun()
        for frame in range(1, 6):
            film.show(relief(frame), frame)
        assert film.dropped == 4
        hold(film, 2)
        assert moving(film)[FRAME] == 5
        film.show(relief(7), 7)
        film.show(relief(7), 7)  # the same once more is none that was dropped
        assert film.dropped == 4

    def test_a_slot_that_begins_elsewhere_is_not_published(self):
        """The tick has gone on since the host looked: it would jump, or never go there."""
        shared = np.array([playing.state(0, 1), 5], np.int64)
        assert not playing.publish(shared, 1, 1, 2)
        assert playing.slots(shared) == (0, 1)
        assert playing.publish(shared, 0, 1, 2)
        assert playing.slots(shared) == (0, 2)

    def test_a_host_that_lost_the_race_builds_the_slot_anew(self, monkeypatch):
        film, lost = begun(), []
        hold(film, 1)
        film.show(relief(1), 1)
        hold(film, 1)
        film.show(relief(2), 2)
        first = playing.publish

        def late(shared, *slots):
            if not lost:
                lost.append(hold(film, 2 * TICKS))  # the loop goes on to frame 2 meanwhile
            return first(shared, *slots)

        monkeypatch.setattr(playing, "publish", late)
        film.show(relief(3), 3)
        hold(film, 2 * TICKS)
        assert moving(film)[FRAME] == 3
        steps = np.linalg.norm(np.diff(np.vstack([lost[0], hold(film, 1)]), axis=0), axis=1)
        assert lost and steps.max() < 2.0

    @pytest.mark.slow
    def test_one_that_ticks_and_one_that_shows_need_not_wait_for_each_other(self):
        """Frame after frame beside ticks without a pause: nothing jumps, and the last is reached."""
        film, reliefs, forces, done = begun(), [relief(0.2 * i) for i in range(60)], [], threading.Event()
        hold(film, 100)

        def tick() -> None:
            while not done.is_set():
                forces.append(hold(film, 3000))

        ticking = threading.Thread(target=tick)
        ticking.start()
        for frame in range(1500):
            film.show(reliefs[min(frame % 120, 119 - frame % 120) % 60], frame)
        done.set()
        ticking.join()
        forces.append(hold(film, 2 * TICKS))
        felt = np.vstack(forces)
        assert np.linalg.norm(np.diff(felt, axis=0), axis=1).max() <= STEP_N
        assert moving(film)[FRAME] == 1499
        wanted = Proxy().touch(HapticSurface(reliefs[1499 % 120 if 1499 % 120 < 60 else 119 - 1499 % 120]))
        assert felt[-1] == pytest.approx(hold_touch(wanted), abs=5e-3)

    def test_what_one_mapping_of_a_file_shows_another_one_feels(self):
        path = parcel.pack(begun())
        shown, felt = parcel.shared(path), parcel.unpack(path)
        shown.show(relief(1), 9)
        before = hold(felt, 1)
        after = hold(felt, TICKS)[-1]
        assert moving(felt)[FRAME] == 9 == moving(shown)[FRAME]
        assert np.abs(after - before).max() > 0.1
        assert felt.arrived and shown.arrived


def hold_touch(touch) -> np.ndarray:
    return touch.path(np.tile([0.003, 0.002, 0.006], (50, 1)))[-1]


class TestSpeed:
    @pytest.mark.parametrize(("law", "most_m"), [("spring", 1e-4), ("stiff", 0.08 / 2500)])
    def test_no_place_moves_faster_than_it_may_and_the_rest_is_in_time(self, law: str, most_m: float):
        """An edge jumps by the whole relief; away from it the surface has arrived with the frame."""
        heights = relief(0.3).height_m.copy()
        heights[:, 30:] = 0.02
        film = begun(LAWS[law])
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

    def test_a_shorter_period_and_a_longer_frame_move_no_faster(self):
        for period_s, frame_s in ((0.0005, 1 / 30), (0.001, 0.2), (0.01, 0.001)):
            film = Proxy().film(HapticSurface(level(0.01)), period_s, frame_s)
            film.show(level(0.02), 1)
            force = film.touch.path(np.tile([0.0, 0.0, 0.009], (300, 1)), period_s)
            assert np.abs(np.diff(force[:, 2])).max() <= min(0.1 * period_s * 800, 0.08) * (1 + 1e-5)


class TestFelt:
    @pytest.mark.parametrize("name", LAWS)
    def test_a_hold_that_is_lost_is_let_go_step_by_step(self, name: str):
        """A ridge that held the hand sinks, and the ground beside it falls away."""
        ridge = 0.002 + 0.014 * np.exp(-(((COLUMN - 20.4) / 2) ** 2))
        film = begun(LAWS[name], Relief(ridge.astype(np.float32), EXTENT_M))
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

    @pytest.mark.parametrize("material", ["sand", "rubber", "ice"])
    def test_materials_stay_where_they_are(self, material: str):
        """Once arrived, as a touch on the last relief with the labels of the first."""
        labels = np.zeros((30, 40), np.int32)
        labels[:, 20:] = 1
        materials = library()[material], library()["ice"]
        film = Proxy().film(HapticSurface(relief(), labels, materials))
        for frame in range(1, 3):
            film.show(relief(0.2 * frame), frame)
            hold(film, TICKS + 1, z=0.02)
        turn = np.linspace(0, 6, 3000)
        path = np.column_stack([0.02 * np.cos(turn), 0.02 * np.sin(turn), np.full(3000, 0.0065)])
        still = Proxy().touch(HapticSurface(relief(0.4), labels, materials)).path(path)
        found = film.touch.path(path)
        assert np.abs(still).max() > 0.5
        assert np.median(np.abs(found - still).max(axis=1)) <= 5e-3

    def test_where_nothing_is_touched_nothing_rises(self):
        film = begun()
        film.show(level(0.012), 1)
        hold(film, 3, z=0.03)
        assert moving(film)[RISE_M] == 0.0
        film.touch.force(HapticState((np.nan, 0.0, 0.0)))
        assert moving(film)[RISE_M] == 0.0
        hold(film, 1)
        assert moving(film)[RISE_M] > 0.0

    @pytest.mark.slow
    def test_random_films_under_random_hands(self):
        """Short; `python -m benchmarks video` does ten million ticks."""
        worst = stress(100_000)
        assert worst.ticks == 100_000 and worst.touched > 25_000 and worst.moved_j > 1
        assert worst.not_finite == 0
        assert worst.step_n <= STEP_N
        assert worst.gained_j <= 1e-3 and worst.guarded_j <= 0

    def test_what_it_says_that_it_rose_is_the_work_that_it_does(self):
        """Of level ground that carries a hand up and down: of its spring and of the hand, nothing is left over."""
        film, work_j, surface_j = begun(first=level(0.008)), 0.0, 0.0
        turn = np.linspace(0, 12 * np.pi, 6000)
        path = np.column_stack([0 * turn, 0 * turn, 0.0065 + 0.001 * np.sin(turn)])
        forces, rises = [], []
        for i, place in enumerate(path):
            if i % 20 == 0:  # before the last one is reached
                film.show(level(0.008 + 0.001 * np.cos(turn[i] + 0.7)), i // 20)
            forces.append(film.touch.force(HapticState(tuple(place.tolist()))).z)
            rises.append(float(moving(film)[RISE_M]))
        for i, (before, after) in enumerate(pairwise(forces), 1):
            work_j += (before + after) / 2 * (path[i, 2] - path[i - 1, 2])
            surface_j += (before + after) / 2 * rises[i]
        held_j = (forces[-1] ** 2 - forces[0] ** 2) / 2 / 800
        assert abs(surface_j) > 1e-3
        assert work_j + held_j == pytest.approx(surface_j, abs=1e-6)


class TestRefused:
    def test_a_frame_of_another_size_is_refused_in_one_line(self):
        with pytest.raises(GeometryError, match=r"a frame has 20 x 10 cells over 80 x 60 mm, the first one 40 x 30"):
            begun().show(Relief(np.zeros((10, 20), np.float32), EXTENT_M), 1)
        with pytest.raises(GeometryError, match=r"over 81 x 60 mm"):
            begun().show(Relief(np.zeros((30, 40), np.float32), (0.081, 0.06)), 1)

    @pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
    def test_a_time_that_is_none_is_refused(self, bad: float):
        with pytest.raises(ConfigError, match=r"period_s: is .* must be positive"):
            Proxy().film(HapticSurface(relief()), period_s=bad)
        with pytest.raises(ConfigError, match=r"frame_s: is .* must be positive"):
            Proxy().film(HapticSurface(relief()), frame_s=bad)

    def test_laws_around_a_law_say_why_they_do_not_film(self):
        for law in (Engraved(), WithMaterials()):
            assert not isinstance(law, Filming)
            assert type(law).why_still
        assert isinstance(Proxy(), Filming) and not Proxy.why_still


def test_three_slots_are_enough():
    """One is played, one may be published, one is free."""
    film = begun()
    assert SLOTS == 3 == len(slots_of(film).pairs)

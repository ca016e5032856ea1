"""The players of a film and its frames as reliefs: a surface stands still, runs late, or moves unasked."""

import threading
import time
from collections import defaultdict
from contextlib import suppress

import numpy as np
import pytest

from films import GivenFrames, NearnessOfGrey, Seen, greys
from tangible_core.data import NO_FORCE, DisparityMap, HapticState, ServoReport
from tangible_core.errors import BrokenMethod, GeometryError, PictureError, Stopped
from tangible_core.relief import ReliefScale
from tangible_core.relief.shaping import STRAIGHT
from tangible_core.scene.geometry import ValueRange
from tangible_core.session.film import ByClock, FrameMaker, Player, Reliefs, Steady
from tangible_core.session.film.player import STOPPING_S
from tangible_core.session.film.reliefs import ADAPTS_S, GATE_PX, MAX_DOUBTS, MAX_MISSING, Scale
from waiting import until

BOX = np.full((8, 12), 20.0)
BOX[2:5, 3:7] = 80
SOON_S = 20.0
"""Longest wait for a thread on a loaded machine."""


class Slow(Seen):
    """A film each of whose showings takes a while."""

    def __init__(self, wait_s=0.0):
        super().__init__()
        self._wait_s = wait_s

    def show(self, relief, frame):
        time.sleep(self._wait_s)
        super().show(relief, frame)


@pytest.fixture
def play():
    """Plays frames to a film, and stops in the end."""
    players = []

    def play(given, film, fps=200.0, maker=None, first_s=0.0):
        frames = GivenFrames(given, fps, first_s)
        players.append(Player(Reliefs(lambda: frames, maker or NearnessOfGrey()), film))
        players[-1].start()
        return players[-1]

    yield play
    for player in players:
        player.stop()


def test_player_shows_frames_in_order_and_counts_skipped_ones(play):
    """Its first frame is due at once, whatever time it has, as in a part that was cut out of a longer film."""
    film = Seen()
    player = play(greys(*[BOX] * 5), film, first_s=50.0)
    until(lambda: film.frames[-1:] == [4])
    assert player.counts.age_ms is not None and 0 <= player.counts.age_ms < 1000 * SOON_S
    assert film.frames == sorted(set(film.frames))
    assert player.counts.shown + player.counts.skipped == 5
    player.check()
    film = Slow(0.03)
    player = play(greys(*[BOX] * 60), film, fps=200)
    until(lambda: film.frames[-1:] == [59])
    felt = player.counts
    assert felt.skipped > 20 and felt.shown + felt.skipped == 60
    assert 0 < felt.per_s < 40
    assert felt.age_ms >= 30


def test_player_repeats_a_relief_and_logs_damaged_frames_once(play, caplog):
    film = Seen(arrives=3)
    play(greys(BOX, BOX), film)
    until(lambda: film.frames[-4:] == [1] * 4 and film.arrived)
    count = len(film.frames)
    time.sleep(0.05)
    assert len(film.frames) == count, "and not once more"
    film, given = Seen(), greys(*[BOX] * 6)
    given[1] = given[3] = PictureError("frame is damaged")
    player = play(given, film, fps=20)
    until(lambda: film.frames[-1:] == [5])
    assert player.counts.damaged >= 1
    assert caplog.text.count("frame is damaged") == 1
    player.check()


def test_player_opens_a_missing_source_again(caplog, monkeypatch):
    monkeypatch.setattr("tangible_core.session.film.player.OPEN_AGAIN_S", 0.01)
    tries, film = defaultdict(int), Seen()

    def opened():
        tries["all"] += 1
        if tries["all"] < 3:
            raise PictureError("camera 0 is not there")
        return GivenFrames(greys(BOX), 30)

    player = Player(Reliefs(opened, NearnessOfGrey()), film)
    player.start()
    until(lambda: film.frames == [0])
    player.stop()
    assert sum("camera 0 is not there" in record.message for record in caplog.records) == 1


class Faulty(FrameMaker):
    """A maker that raises an error for every frame."""

    def __init__(self, error):
        self._error = error

    def begin(self, views):
        raise self._error

    disparity = scale = relief = begin


@pytest.mark.parametrize("error", [ZeroDivisionError("a plugin's fault"), BrokenMethod("made a map of 3 x 4")])
def test_player_raises_a_plugin_error_once_and_ends(play, error):
    player = play(greys(BOX), Seen(), maker=Faulty(error))

    def raised():
        try:
            player.check()
        except type(error) as fault:
            return fault is error
        return False

    until(raised)
    player.check()


def test_stopped_player_ends_soon_without_damage_or_a_process(play, caplog):
    """A stop may come while a frame is made: the player ends in silence, and one by the clock says so."""
    player = play(greys(BOX, BOX), Seen(), maker=Faulty(Stopped()))
    player._thread.join(SOON_S)
    assert not player._thread.is_alive()
    player.check()
    assert (player.counts.damaged, caplog.messages) == (0, [])
    begun, release = threading.Event(), threading.Event()

    class Long(Seen):
        def show(self, relief, frame):
            begun.set()
            release.wait(SOON_S)

    player = play(greys(BOX), Long())
    until(begun.is_set)
    at_s = time.monotonic()
    player.stop()
    assert time.monotonic() - at_s < STOPPING_S + 1
    assert all(each.daemon for each in threading.enumerate() if each.name == "film")
    release.set()
    player.check()


def test_by_clock_shows_every_due_frame_and_repeats_over_damaged_ones(caplog):
    film = Seen()
    with Reliefs(lambda: GivenFrames(greys(*[BOX] * 5), fps=10), NearnessOfGrey()) as reliefs:
        show, shown = ByClock(reliefs, film), []
        for tick in range(700):
            show(tick / 1000)
            shown.append(film.frames[-1])
        felt = show.counts
        heard = []
        show.with_counts(heard.append)(ServoReport(1, 0.0, HapticState((0.0, 0.0, 0.0)), NO_FORCE, 0.0, 0.0))
    assert [shown.index(number) for number in range(5)] == [0, 100, 200, 300, 400]
    assert (felt.shown, felt.skipped, felt.damaged, felt.age_ms) == (5, 0, 0, None)
    assert felt.per_s == pytest.approx(10)
    assert heard[0].film == felt
    film, given = Seen(arrives=2), greys(*[BOX] * 4)
    given[1] = given[2] = PictureError("frame is damaged")
    with Reliefs(lambda: GivenFrames(given, fps=10), NearnessOfGrey()) as reliefs:
        show = ByClock(reliefs, film)
        for tick in range(700):
            show(tick / 1000)
    assert film.frames == [0, 0, 0, 3, 3, 3] and show.counts.damaged == 2
    assert sum("frame is damaged" in record.message for record in caplog.records) == 1


GROUND = np.full((8, 12), 20.0)
NEARER = BOX.copy()
NEARER[4:8, 8:11] = 120


def heights(*pictures):
    """Return the heights of the frames of a film."""
    with Reliefs(lambda: GivenFrames(greys(*pictures)), NearnessOfGrey()) as reliefs:
        return [relief.relief.height_m for relief in reliefs]


def test_scale_follows_at_each_eighth_frame_with_its_time_constant():
    film = heights(BOX, *[NEARER] * 5)
    assert film[-1][6, 9] == film[-1][2, 3] == pytest.approx(0.01), "what is nearer is clipped, and pushes nothing down"
    assert film[-1][0, 0] == 0
    film = heights(BOX, *[NEARER] * 17)
    box = np.array([each[2, 3] for each in film])
    assert np.flatnonzero(np.diff(box)).tolist() == [7, 15], "between frames 7 and 8, and 15 and 16"
    for step_s in (0.1, 1.0):
        scale, seen = Scale(ReliefScale(ValueRange(0, 10), STRAIGHT)), ReliefScale(ValueRange(-5, 20), STRAIGHT**2)
        for number in range(1, round(ADAPTS_S / step_s) + 1):
            scale.look(seen, number * step_s)
        assert scale.current.spans == pytest.approx((-5 + 5 / np.e, 20 - 10 / np.e))
        assert np.allclose(scale.current.tones, STRAIGHT**2 + (STRAIGHT - STRAIGHT**2) / np.e)


def test_cut_or_dark_pause_begins_with_its_own_range():
    film = heights(*[GROUND] * 2, *[BOX] * 30)
    assert not film[0].any()
    assert film[-1][2, 3] == pytest.approx(0.01)
    maker = NearnessOfGrey()
    other = 200 - BOX / 2
    with Reliefs(lambda: GivenFrames(greys(BOX, BOX, other, other)), maker) as reliefs:
        film = [relief.relief.height_m for relief in reliefs]
    assert maker.begun == 2
    assert np.array_equal(film[2], film[1]), "one frame late"
    assert film[3][0, 0] == pytest.approx(0.01) and film[3][2, 3] == 0
    maker, dark, other = NearnessOfGrey(), np.full((8, 12), 255.0), 200 - BOX / 2
    film = []
    with Reliefs(lambda: GivenFrames(greys(BOX, *[dark] * 12, *[other] * 3)), maker) as reliefs:
        while (frame := reliefs.frames.next()) is not None:
            with suppress(GeometryError):
                film.append(reliefs.make(frame).relief.height_m)
    assert maker.begun == 2
    assert film[-1][0, 0] == pytest.approx(0.01) and film[-1][2, 3] == 0, "the range is the new one"


FLAT = np.full((6, 8), 10, np.float32)


def filter_maps(*maps, unit="px"):
    """Return the filtered maps of consecutive maps."""
    steady = Steady()
    return [steady.next(DisparityMap(np.float32(each), unit=unit)).disparity.disparity_px for each in maps]


def at(value, where=(2, 3)):
    """Return flat ground with one other pixel."""
    made = FLAT.copy()
    made[where] = value
    return made


def test_single_errors_and_noise_are_filtered_out():
    felt = filter_maps(FLAT, at(40), FLAT, FLAT)
    assert all(np.array_equal(each, FLAT) for each in felt)
    generator = np.random.default_rng(1)
    maps = [FLAT + generator.normal(0, 0.2, FLAT.shape) for _ in range(60)]
    flicker = np.diff(np.stack(filter_maps(*maps)[10:]), axis=0).std()
    assert flicker < 0.3 * np.diff(np.stack(maps[10:]), axis=0).std()
    felt = [filter_map[2, 3] for filter_map in filter_maps(FLAT, at(10 + GATE_PX), FLAT, at(10.18 + GATE_PX))]
    assert felt == pytest.approx([10, 10.2, 10.16, 10.16])


def test_change_is_adopted_at_the_second_frame_without_a_trail():
    felt = [filter_map[2, 3] for filter_map in filter_maps(FLAT, at(20), at(20.5), at(20.5), FLAT, FLAT, FLAT)]
    assert felt[:3] == [10, 10, 20.5]
    assert felt[4] == 20.5, "seen once"
    assert felt[5:] == [10, 10]
    felt = [filter_map[2, 3] for filter_map in filter_maps(*(at(10 + 5 * number) for number in range(9)))]
    assert all(abs(value - (10 + 5 * number)) <= 5 * MAX_DOUBTS for number, value in enumerate(felt))
    assert felt[-1] >= 40
    steady, other = Steady(), FLAT + 25
    generator = np.random.default_rng(2)
    noisy = other + generator.normal(0, 2, FLAT.shape).astype(np.float32)
    felt = [steady.next(DisparityMap(each)) for each in (FLAT, other, noisy, noisy)]
    assert [each.cut for each in felt] == [False, False, True, False]
    assert np.array_equal(felt[1].disparity.disparity_px, FLAT), "a flash of one frame is not felt"
    assert np.array_equal(felt[2].disparity.disparity_px, noisy), "no pixel of the scene before it is left"


def test_unknown_values_must_be_seen_twice_and_last():
    flickers = filter_maps(FLAT, at(np.nan), FLAT, at(np.nan), at(np.nan), FLAT)
    assert all(np.array_equal(flicker, FLAT) for flicker in flickers)
    stays = [filter_map[2, 3] for filter_map in filter_maps(FLAT, *[at(np.nan)] * (MAX_MISSING + 2))]
    assert np.isfinite(stays[: MAX_MISSING + 1]).all()
    assert np.isnan(stays[MAX_MISSING + 1 :]).all()
    felt = [filter_map[2, 3] for filter_map in filter_maps(at(np.nan), at(30), at(np.nan), at(12), at(12))]
    assert np.isnan(felt[:4]).all()
    assert felt[4] == 12


@pytest.mark.parametrize(("columns", "cut"), [(4, False), (5, True)])
def test_change_of_half_the_picture_is_no_cut(columns, cut):
    steady, other = Steady(), FLAT.copy()
    other[:, :columns] = 40
    felt = [steady.next(DisparityMap(each)) for each in (FLAT, other, other)]
    assert [each.cut for each in felt] == [False, False, cut]


def test_filter_has_a_gate_relative_to_its_range_and_restarts():
    ramp = np.linspace(0, 1, 48, dtype=np.float32).reshape(6, 8)
    felt = filter_maps(ramp, ramp + np.float32(0.02), ramp + np.float32(0.2), unit="relative")
    assert np.allclose(felt[1], ramp + 0.004, atol=1e-6), "noise is averaged"
    assert np.allclose(felt[2], felt[1]), "what is more is not believed at once"
    steady = Steady()
    steady.next(DisparityMap(FLAT))
    found = steady.next(DisparityMap(FLAT[:3] + 5))
    assert found.cut and np.array_equal(found.disparity.disparity_px, FLAT[:3] + 5)

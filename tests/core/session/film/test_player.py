"""The players of a film: a surface that stands still, runs late, or leaves a thread behind when the loop ends."""

import threading
import time
from collections import defaultdict

import numpy as np
import pytest

from films import GivenFrames, NearnessOfGrey, Seen, greys
from tangible_core.data import NO_FORCE, HapticState, ServoReport
from tangible_core.errors import BrokenMethod, PictureError, Stopped
from tangible_core.session.film import ByClock, FrameMaker, Player, Reliefs
from tangible_core.session.film.player import STOPPING_S
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


def test_player_shows_frames_in_order_and_stops_at_the_end_of_the_source(play):
    """Its first frame is due at once, whatever time it has, as in a part that was cut out of a longer film."""
    film = Seen()
    player = play(greys(*[BOX] * 5), film, first_s=50.0)
    until(lambda: film.frames[-1:] == [4])
    assert player.counts.age_ms is not None and 0 <= player.counts.age_ms < 1000 * SOON_S
    assert film.frames == sorted(set(film.frames))
    assert player.counts.shown + player.counts.skipped == 5
    player.check()


def test_player_shows_the_latest_frame_and_counts_skipped_ones(play):
    film = Slow(0.03)
    player = play(greys(*[BOX] * 60), film, fps=200)
    until(lambda: film.frames[-1:] == [59])
    felt = player.counts
    assert felt.skipped > 20 and felt.shown + felt.skipped == 60
    assert 0 < felt.per_s < 40
    assert felt.age_ms >= 30


def test_player_repeats_a_relief_until_the_surface_arrives(play):
    film = Seen(arrives=3)
    play(greys(BOX, BOX), film)
    until(lambda: film.frames[-4:] == [1] * 4 and film.arrived)
    count = len(film.frames)
    time.sleep(0.05)
    assert len(film.frames) == count, "and not once more"


def test_player_logs_damaged_frames_once_and_goes_on(play, caplog):
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


def test_stopped_work_ends_a_film_and_is_no_damage(play, caplog):
    """A stop may come while a frame is made: the player ends in silence, and one by the clock says so."""
    player = play(greys(BOX, BOX), Seen(), maker=Faulty(Stopped()))
    player._thread.join(SOON_S)
    assert not player._thread.is_alive()
    player.check()
    assert (player.counts.damaged, caplog.messages) == (0, [])


def test_player_stops_soon_during_a_slow_method_and_keeps_no_process_alive(play):
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


def test_by_clock_shows_every_frame_when_it_is_due():
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


def test_by_clock_repeats_reliefs_and_skips_damaged_frames(caplog):
    film, given = Seen(arrives=2), greys(*[BOX] * 4)
    given[1] = given[2] = PictureError("frame is damaged")
    with Reliefs(lambda: GivenFrames(given, fps=10), NearnessOfGrey()) as reliefs:
        show = ByClock(reliefs, film)
        for tick in range(700):
            show(tick / 1000)
    assert film.frames == [0, 0, 0, 3, 3, 3] and show.counts.damaged == 2
    assert sum("frame is damaged" in record.message for record in caplog.records) == 1

"""If one of these fails, a camera lags, is not found again once unplugged, or keeps the program from ending."""

import signal
import threading
from collections.abc import Callable, Iterator
from threading import Event
from time import monotonic, sleep

import pytest

from ctrl_c import hearing
from tangible_core import Scene
from tangible_core.errors import PictureError
from tangible_core.scene.video import camera as video_camera
from tangible_core.scene.video import capture as video_capture
from tangible_core.scene.video.camera import CameraFrames
from videos import Played, grey, shown

LONG_S = 10.0
"""Time-out, longer than any wait here."""


class Noise(Played):
    """A camera that delivers damaged pictures without end."""

    def grab(self) -> bool:
        return True

    def retrieve(self) -> tuple[bool, None]:
        return False, None


def frames_of(*captures: Played) -> CameraFrames:
    """Return a camera that opens as these captures in turn, and then not at all."""
    return CameraFrames(0, None, lambda picture: picture, opening(*captures))


def opening(*captures: Played) -> Callable[[int, float | None], Played]:
    left = iter(captures)
    return lambda number, fps: next(left, Played([], opened=False))


def until(there: Callable[[], object]) -> None:
    """Wait for another thread."""
    end_s = monotonic() + LONG_S
    while not there():
        assert monotonic() < end_s, "it never came"
        sleep(0.002)


@pytest.fixture(autouse=True)
def soon(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Search for lost cameras at once; no thread outlives a test."""
    monkeypatch.setattr(video_camera, "AGAIN_S", 0.01)
    yield
    until(lambda: not any(each.name.startswith("camera ") for each in threading.enumerate()))


class Stepped(Played):
    """A camera that takes a picture when a test allows it."""

    def __init__(self, count: int, first: int = 0) -> None:
        super().__init__([grey(number) for number in range(first, first + count)], fps=25)
        self.may = threading.Semaphore(0)

    def grab(self) -> bool:
        self.may.acquire(timeout=LONG_S)
        return super().grab()


def test_camera_keeps_the_newest_picture_only():
    camera = Stepped(9)
    camera.may.release()
    with frames_of(camera) as frames:
        first = frames.next()
        assert (first.number, first.time_s, frames.fps) == (0, 0.0, 25)
        assert frames.at(0) is None, "it was read"
        for _ in range(5):
            camera.may.release()
        until(lambda: frames._shot_count == 6)
        newest = frames.at(0)
        assert (newest.number, frames.skipped) == (5, 4) and newest.time_s > 0
        camera.may.release()
        assert frames.next().number == 6
        camera.may.release(9)
    assert frames.at_end and frames.next() is None and frames.at(0) is None


def test_scene_of_a_camera_shows_its_picture_if_there_is_one(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(video_capture, "open_camera", opening(Played([grey(4)] * 99), Played([grey(7)] * 99)))
    scene = Scene.video(1)
    assert scene.name == "camera 1" and shown(scene.views) == 4
    assert scene.notes == ("camera 1 is a video, of which this is one picture; `tangible feel` plays it",)
    with scene.frames.open() as frames:
        assert shown(frames.next().views) == 7
    monkeypatch.setattr(video_camera, "FIRST_S", 0.05)
    stuck = Event()
    with pytest.raises(PictureError, match="camera 0: delivers no picture; check its cable"):
        frames_of(Played([grey(0)], before=stuck))
    stuck.set()


def test_unplugged_camera_raises_once_and_goes_on_when_it_is_back():
    back = Stepped(3, first=5)
    with frames_of(Played([grey(0)]), Played([], opened=False), Noise([]), back) as frames:
        assert frames.next().number == 0
        with pytest.raises(PictureError, match="camera 0: was unplugged, or another program took it; plug it in again"):
            until(lambda: frames.at(9) and False)
        assert [frames.at(9) for _ in range(20)] == [None] * 20, "raised once"
        back.may.release()
        again = frames.next()
        assert (again.number, shown_number(again.views)) == (1, 5)
        back.may.release(9)
        with pytest.raises(PictureError, match="was unplugged"):
            until(lambda: frames.at(9) and False)


def shown_number(picture) -> int:
    return round(float(picture.mean()) / 8)


def test_camera_closes_or_is_interrupted_while_its_driver_hangs():
    camera = Stepped(1)
    camera.may.release()
    frames = frames_of(camera)
    began_s = monotonic()
    frames.close()
    assert monotonic() - began_s < 1.5
    frames.close()
    assert not camera.released.is_set(), "not while the driver has it"
    camera.may.release(9)
    until(camera.released.is_set)
    stuck = Event()
    timer = threading.Timer(0.1, signal.raise_signal, (signal.SIGINT,))
    began_s = monotonic()
    with hearing():
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            frames_of(Played([grey(0)], before=stuck))
        timer.join()
    stuck.set()
    assert monotonic() - began_s < LONG_S

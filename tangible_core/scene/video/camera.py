"""The frames of a camera: a thread keeps the newest picture, so that readers need not follow the camera's pace."""

from pathlib import Path
from threading import Condition, Event, Thread
from time import monotonic
from typing import NamedTuple, final

import numpy as np
from jaxtyping import UInt8

from ...errors import PictureError, shown
from . import capture as video_capture
from .capture import USUAL_FPS, Capture, OpenCamera, VideoFrame, VideoFrames, ViewsOf, grab, retrieve, stated_fps

FIRST_S = 15.0
NEXT_S = 5.0
AGAIN_S = 0.5
# Longest single wait, seconds: some systems deliver a signal only between two waits.
SLICE_S = 0.2
MAX_DAMAGED = 30  # number of damaged pictures in a row after which a camera counts as lost
# Time that `close` waits for the thread, seconds; if the camera's driver hangs, the thread ends when it returns.
ENDED_S = 0.8


class _Shot(NamedTuple):
    number: int
    taken_s: float
    picture: UInt8[np.ndarray, "h w 3"]


@final
class CameraFrames(VideoFrames):
    """The frames of a camera. An unplugged camera is reported once, and searched for until it is closed."""

    def __init__(
        self, number: int, fps: float | None, views_of: ViewsOf, open_capture: OpenCamera | None = None
    ) -> None:
        """Open a camera; open_capture is for tests. Raises: PictureError if it is missing or delivers no picture."""
        super().__init__(fps or USUAL_FPS, views_of)
        self._camera, self._requested_fps = number, fps
        self._open = open_capture or video_capture.open_camera
        self._condition, self._stopped = Condition(), Event()
        self._newest: _Shot | None = None
        self._fault: PictureError | None = None
        """The current fault of the camera; None once it was raised."""
        self._shot_count, self._read_number, self._first_s = 0, -1, 0.0
        self._thread = Thread(target=self._watch, name=f"camera {number}", daemon=True)
        try:
            self._thread.start()
            self._wait(FIRST_S)
        except BaseException:
            self.close()
            raise

    @property
    def at_end(self) -> bool:
        """True once it was closed: a camera has no end."""
        return self._stopped.is_set()

    def next(self) -> VideoFrame | None:
        """Wait for the next picture. Raises: PictureError if none comes for seconds, or, once, for a lost camera."""
        self._wait(NEXT_S)
        return None if self.at_end else self._newer()

    def at(self, time_s: float) -> VideoFrame | None:
        """Return the newest picture, whatever the time. Raises: PictureError, once, if the camera is lost."""
        with self._condition:
            self._raise_lost()
        return None if self.at_end else self._newer()

    def close(self) -> None:
        """Close the camera within a second; if its driver hangs, it is released when the driver returns."""
        if self._stopped.is_set():
            return
        self._stopped.set()
        with self._condition:
            self._condition.notify_all()
        if self._thread.is_alive():
            self._thread.join(ENDED_S)

    def _wait(self, most_s: float) -> None:
        """Wait until there is a newer picture. Raises: PictureError if none comes, or the camera is lost."""
        until_s = monotonic() + most_s
        with self._condition:
            while monotonic() < until_s:
                if self._condition.wait_for(lambda: self._is_newer() or self._fault or self.at_end, SLICE_S):
                    return self._raise_lost()
        raise PictureError(
            f"camera {self._camera}: delivers no picture; check its cable, and that no other program uses it"
        )

    def _is_newer(self) -> bool:
        return self._newest is not None and self._newest.number > self._read_number

    def _raise_lost(self) -> None:
        """Raise the fault of a lost camera, once, when no unread picture is left. Raises: PictureError."""
        if self._fault is not None and not self._is_newer():
            fault, self._fault = self._fault, None
            raise fault

    def _newer(self) -> VideoFrame | None:
        shot = self._newest
        if shot is None or shot.number <= self._read_number:
            return None
        self.skipped += shot.number - self._read_number - 1
        self._read_number = shot.number
        return self._frame(shot.number, shot.taken_s - self._first_s, shot.picture, f"camera {self._camera}")

    def _watch(self) -> None:
        """Keep the newest picture, or, once, the fault, until closed; the body of the thread."""
        is_reported = False
        while not self._stopped.is_set():
            shot_count = self._shot_count
            fault = self._follow()
            is_reported &= self._shot_count == shot_count
            if not is_reported:
                with self._condition:
                    self._fault, is_reported = fault, True
                    self._condition.notify_all()
            self._stopped.wait(AGAIN_S)

    def _follow(self) -> PictureError:
        shot_count, capture = self._shot_count, None
        try:
            capture = self._open(self._camera, self._requested_fps)
            if capture.isOpened():
                self.fps: float = self._requested_fps or stated_fps(capture) or USUAL_FPS
                self._take_all(capture)
        except PictureError as error:
            return error
        except Exception as error:  # noqa: BLE001 - a driver can raise any, and the reader must get it
            return PictureError(f"camera {self._camera}: {shown(str(error))}; check its cable")
        finally:
            if capture is not None:
                capture.release()
        if self._shot_count == shot_count:
            here = ", ".join(map(str, _cameras()))
            cure = f"name one of the others: {here}" if here else "check its cable, and that no other program uses it"
            return PictureError(f"camera {self._camera}: does not exist, or is in use; {cure}")
        return PictureError(
            f"camera {self._camera}: was unplugged, or another program took it; plug it in again to go on"
        )

    def _take_all(self, capture: Capture) -> None:
        damage_count = 0
        while damage_count < MAX_DAMAGED and not self._stopped.is_set() and grab(capture):
            taken_s = monotonic()
            if (picture := retrieve(capture, f"camera {self._camera}")) is None:
                damage_count += 1
                continue
            damage_count = 0
            with self._condition:
                self._first_s = self._first_s if self._shot_count else taken_s
                self._newest = _Shot(self._shot_count, taken_s, picture)
                self._shot_count += 1
                self._fault = None
                self._condition.notify_all()


def _cameras() -> list[int]:
    names = (path.name.removeprefix("video") for path in Path("/dev").glob("video*"))
    return sorted(int(name) for name in names if name.isdecimal())

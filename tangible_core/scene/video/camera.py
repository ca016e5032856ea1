"""A camera, frame by frame: a thread keeps the newest picture, so that nobody waits for the camera's own pace."""

import sys
from pathlib import Path
from threading import Condition, Event, Thread
from time import monotonic
from typing import NamedTuple, final

import numpy as np
from jaxtyping import UInt8

from ...errors import PictureError, shown
from . import capture as video_capture
from .capture import USUAL_FPS, Capture, OpenCamera, grabbed, retrieved, stated_fps
from .frames import VideoFrame, VideoFrames, ViewsOf

FIRST_S = 15.0
"""For a camera to give its first picture; some take seconds to find their exposure."""
NEXT_S = 5.0
"""For each one after that."""
AGAIN_S = 0.5
"""Between two attempts to reach a camera that was unplugged."""
SLICE_S = 0.2
"""Of waiting for it: in between, a signal is heard, which some systems do not let through to who waits."""
MOST_DAMAGED = 30
"""Pictures in a row, before a camera counts as lost."""
ENDED_S = 0.8
"""That an end waits for the thread; one that hangs in the camera's driver ends when it comes back."""


class _Shot(NamedTuple):
    number: int
    taken_s: float
    picture: UInt8[np.ndarray, "h w 3"]


@final
class CameraFrames(VideoFrames):
    """What a camera sees. One that is unplugged is said once, and looked for again until it is closed."""

    def __init__(
        self, number: int, fps: float | None, views_of: ViewsOf, open_capture: OpenCamera | None = None
    ) -> None:
        """fps: asked of the camera. open_capture: what opens it, for tests.

        Raises: PictureError if there is none, or it gives no picture.
        """
        super().__init__(fps or USUAL_FPS, views_of)
        self._camera, self._asked_fps = number, fps
        self._open = open_capture or video_capture.open_camera
        self._changed, self._closed = Condition(), Event()
        self._newest: _Shot | None = None
        self._lost: PictureError | None = None
        """What is wrong with the camera now; None once it was said."""
        self._taken, self._had, self._first_s = 0, -1, 0.0
        self._thread = Thread(target=self._watch, name=f"camera {number}", daemon=True)
        self._thread.start()
        try:
            self._wait(FIRST_S)
        except BaseException:
            self.close()
            raise

    @property
    def ended(self) -> bool:
        """Whether it was closed: a camera has no end."""
        return self._closed.is_set()

    def next(self) -> VideoFrame | None:
        """Waits for the next picture. Raises: PictureError if none comes for seconds, or, once, if it is lost."""
        self._wait(NEXT_S)
        return None if self.ended else self._newer()

    def at(self, time_s: float) -> VideoFrame | None:
        """The newest picture, whatever the time. Raises: PictureError, once, if the camera is lost."""
        with self._changed:
            self._raise_lost()
        return None if self.ended else self._newer()

    def close(self) -> None:
        """Within a second, also while the camera's driver hangs: then it is given back when that goes on."""
        if self._closed.is_set():
            return
        self._closed.set()
        with self._changed:
            self._changed.notify_all()
        self._thread.join(ENDED_S)

    def _wait(self, most_s: float) -> None:
        """Until there is a newer picture. Raises: PictureError if none comes, or the camera is lost."""
        until_s = monotonic() + most_s
        with self._changed:
            while monotonic() < until_s:
                if self._changed.wait_for(lambda: self._is_newer() or self._lost or self.ended, SLICE_S):
                    return self._raise_lost()
        raise PictureError(
            f"camera {self._camera}: gives no picture; check its cable, and that no other program uses it"
        )

    def _is_newer(self) -> bool:
        return self._newest is not None and self._newest.number > self._had

    def _raise_lost(self) -> None:
        """Raises: PictureError, once, if the camera is lost and there is no picture left from before."""
        if self._lost is not None and not self._is_newer():
            lost, self._lost = self._lost, None
            raise lost

    def _newer(self) -> VideoFrame | None:
        shot = self._newest
        if shot is None or shot.number <= self._had:
            return None
        self.skipped += shot.number - self._had - 1
        self._had = shot.number
        return self._frame(shot.number, shot.taken_s - self._first_s, shot.picture, f"camera {self._camera}")

    def _watch(self) -> None:
        """The thread: as long as it is not closed, the newest picture, or, once, what is wrong."""
        said = False
        while not self._closed.is_set():
            taken = self._taken
            lost = self._follow()
            said &= self._taken == taken
            if not said:
                with self._changed:
                    self._lost, said = lost, True
                    self._changed.notify_all()
            self._closed.wait(AGAIN_S)

    def _follow(self) -> PictureError:
        """Take pictures until that fails; why it did."""
        taken, capture = self._taken, None
        try:
            capture = self._open(self._camera, self._asked_fps)
            if capture.isOpened():
                self.fps = self._asked_fps or stated_fps(capture) or USUAL_FPS
                self._take_all(capture)
        except PictureError as error:
            return error
        except Exception as error:  # noqa: BLE001 - a driver can provoke any, and the reader is to hear of it
            return PictureError(f"camera {self._camera}: {shown(str(error))}; check its cable")
        finally:
            if capture is not None:
                capture.release()
        if self._taken == taken:
            return self._absent()
        return PictureError(
            f"camera {self._camera}: was unplugged, or another program took it; plug it in again, and it goes on"
        )

    def _take_all(self, capture: Capture) -> None:
        damaged = 0
        while damaged < MOST_DAMAGED and not self._closed.is_set() and grabbed(capture):
            taken_s = monotonic()
            if (picture := retrieved(capture, f"camera {self._camera}")) is None:
                damaged += 1
                continue
            damaged = 0
            with self._changed:
                self._first_s = self._first_s if self._taken else taken_s
                self._newest = _Shot(self._taken, taken_s, picture)
                self._taken += 1
                self._lost = None
                self._changed.notify_all()

    def _absent(self) -> PictureError:
        here = ", ".join(map(str, _cameras()))
        cure = f"name one of those that are: {here}" if here else "check its cable, and that no other program uses it"
        return PictureError(f"camera {self._camera}: there is none of this number, or it is in use; {cure}")


def _cameras() -> list[int]:
    """The numbers of the cameras that the system tells of."""
    if sys.platform != "linux":
        return []
    names = (each.name.removeprefix("video") for each in Path("/dev").glob("video*"))
    return sorted(int(name) for name in names if name.isdecimal())

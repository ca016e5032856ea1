"""Videos made in code, each frame of one grey that tells its number, and captures that play what a test says."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from threading import Event
from typing import Any

import cv2
import numpy as np

from tangible_core.data import Views
from tangible_core.runtime.opencv import silent_opencv

STEP = 8
"""Between the greys of two frames: JPEG keeps them apart."""


def grey(number: int, shape: tuple[int, int] = (24, 32)) -> np.ndarray:
    """The picture of a frame, BGR."""
    return np.full((*shape, 3), STEP * number, np.uint8)


def write_video(path: Path, pictures: Iterable[np.ndarray], fps: float = 25, codec: str = "MJPG") -> Path:
    """These pictures, BGR, as a video."""
    pictures = list(pictures)
    height, width = pictures[0].shape[:2]
    with silent_opencv():
        writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*codec), fps, (width, height))
    assert writer.isOpened(), f"OpenCV writes no {codec} here"
    for picture in pictures:
        writer.write(picture)
    writer.release()
    return path


def greys(path: Path, count: int, fps: float = 25, shape: tuple[int, int] = (24, 32)) -> Path:
    """A video of so many frames, the first of them black."""
    return write_video(path, (grey(number, shape) for number in range(count)), fps)


def jpegs(path: Path, pictures: Iterable[np.ndarray]) -> Path:
    """These pictures, of any sizes, as a stream of JPEGs."""
    path.write_bytes(b"".join(cv2.imencode(".jpg", picture)[1].tobytes() for picture in pictures))
    return path


def shown(views: Views | None) -> int:
    """The number that a frame's picture tells."""
    assert views is not None
    return round(float(views.left.mean()) / STEP)


class Played:
    """A capture of these pictures, at these times where they are said; it may wait before each."""

    def __init__(
        self,
        pictures: Sequence[np.ndarray | None],
        times_s: Sequence[float] = (),
        fps: float = 30,
        *,
        opened: bool = True,
        before: Event | None = None,
    ) -> None:
        """before: grab waits for it. A picture that is None is damaged."""
        self._pictures, self._times_s, self._fps = pictures, times_s, fps
        self._opened, self._before = opened, before
        self._at = -1
        self.retrieved: list[int] = []
        self.released = Event()

    def isOpened(self) -> bool:
        return self._opened

    def grab(self) -> bool:
        if self._before is not None:
            self._before.wait(20)
        self._at += 1
        return self._at < len(self._pictures)

    def retrieve(self) -> tuple[bool, Any]:
        self.retrieved.append(self._at)
        picture = self._pictures[self._at]
        return picture is not None, picture

    def get(self, which: int, /) -> float:
        if which == cv2.CAP_PROP_POS_MSEC:
            return 1000 * self._times_s[self._at] if self._times_s else 0
        return {cv2.CAP_PROP_FPS: self._fps, cv2.CAP_PROP_FRAME_COUNT: len(self._pictures)}.get(which, 0)

    def release(self) -> None:
        self.released.set()

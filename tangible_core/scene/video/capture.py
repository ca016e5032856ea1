"""Video files and cameras through OpenCV, opened within limits and silent on standard error."""

import os
import stat
from abc import ABC, abstractmethod
from collections.abc import Callable
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np
from jaxtyping import UInt8

from ...data import Views
from ...data.pictures import size_in_words, to_rgb8
from ...errors import PictureError
from ...files.reading import TooLargeError, check_size
from ...runtime.opencv import cv2, silent_opencv
from ...runtime.system.processes import processors
from ...runtime.threads import thread_limit
from ..formats.decoding import absent

USUAL_FPS = 30.0  # frames a second of a folder, and of a source that states no plausible rate
# Bounds of a plausible rate; some sources state 0, or the ticks of their clock.
MIN_FPS, MAX_FPS = 0.1, 480.0
MAX_THREADS = 4  # largest number of threads of a decoder, as each holds frames of its own


if TYPE_CHECKING:
    from cv2 import VideoCapture as Capture
else:
    Capture = Any  # what has its methods

# A function that opens a camera by its number, with frames a second or None; it may fail to open.
OpenCamera = Callable[[int, float | None], Capture]


def open_file(path: Path) -> Capture:
    """Open a video file. Raises: PictureError for one without frames, or with frames that are too large."""
    _check_is_file(path)
    with silent_opencv():
        # OpenCV's readers other than FFmpeg take the digits in a name for the numbers of pictures.
        threads = [cv2.CAP_PROP_N_THREADS, min(thread_limit() or processors(), MAX_THREADS)]
        capture = cv2.VideoCapture(str(path.absolute()), cv2.CAP_FFMPEG, threads)
    if not capture.isOpened():
        raise PictureError(
            f"{path}: is not a video that this program can play, or has no frames; convert it to an .mp4 with H.264"
        )
    size = round(capture.get(cv2.CAP_PROP_FRAME_HEIGHT)), round(capture.get(cv2.CAP_PROP_FRAME_WIDTH))
    check_frame(size, path)
    return capture


def open_camera(number: int, fps: float | None) -> Capture:
    """Open a camera by its number; check `isOpened` afterwards."""
    with silent_opencv():
        capture = cv2.VideoCapture(number)
        if fps is not None:
            capture.set(cv2.CAP_PROP_FPS, fps)
    return capture


def grab(capture: Capture) -> bool:
    """Go to the next frame, to be retrieved; tell whether there is one."""
    with silent_opencv():
        return bool(capture.grab())


def retrieve(capture: Capture, name: object) -> UInt8[np.ndarray, "h w 3"] | None:
    """Return the grabbed frame in RGB; None if it is damaged. Raises: PictureError if it is too large."""
    with silent_opencv():
        is_whole, picture = capture.retrieve()
    if not is_whole or picture.size == 0:
        return None
    picture = np.asarray(picture)
    check_frame(picture.shape, name)
    if picture.dtype == np.uint8 and picture.shape[2:] == (3,):
        return np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB), np.uint8)
    return np.ascontiguousarray(to_rgb8(picture.squeeze(2) if picture.shape[2:] == (1,) else picture)[..., ::-1])


def stated_fps(capture: Capture) -> float | None:
    """Return the frames a second that a file or a camera states; None for an implausible rate."""
    fps = capture.get(cv2.CAP_PROP_FPS)
    return fps if isfinite(fps) and MIN_FPS <= fps <= MAX_FPS else None


def stated_count(capture: Capture) -> int | None:
    """Return the number of frames that a file states; None if it states none."""
    count = capture.get(cv2.CAP_PROP_FRAME_COUNT)
    return int(count) if isfinite(count) and 0 < count < 1e9 else None


def position_s(capture: Capture) -> float:
    """Return the time stamp of the grabbed frame; any number if the file has none."""
    return capture.get(cv2.CAP_PROP_POS_MSEC) / 1000


def check_frame(shape: tuple[int, ...], name: object) -> None:
    """Check the size of a frame. Raises: PictureError if it is larger than a picture may be."""
    try:
        check_size((*shape[:2], 4), 1)
    except TooLargeError as error:
        raise PictureError(f"{name}: a frame {error}; make the video smaller first") from error


def _check_is_file(path: Path) -> None:
    """Check that a file is there and can be read. Raises: PictureError, with the cure."""
    try:
        status = path.stat()
        readable = os.access(path, os.R_OK)
    except (FileNotFoundError, NotADirectoryError) as error:
        raise absent(path, "file or folder") from error
    except (OSError, ValueError) as error:
        raise PictureError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from error
    if not stat.S_ISREG(status.st_mode):
        raise PictureError(
            f"{path}: is a device or a pipe, not a video file; name a file, a folder of pictures, or a camera by its "
            "number (video: 0)"
        )
    if not status.st_size:
        raise PictureError(f"{path}: the file is empty; copy or download it again")
    if not readable:
        raise PictureError(f"{path}: cannot be read: Permission denied; check its permissions")


ViewsOf = Callable[[np.ndarray], Views]  # a function from a stored picture to its views


class VideoFrame(NamedTuple):
    """A frame of a video."""

    number: int  # number of the frame, from 0; it goes on counting when the video starts again
    time_s: float  # time at which the frame is due, seconds after the first
    views: Views


class VideoFrames(ABC):
    """The frames of an open video: a context manager, for one reader; a faulty frame is raised once, then passed."""

    def __init__(self, fps: float, views_of: ViewsOf) -> None:
        """fps: approximate frames a second. views_of: converts each picture."""
        self.fps: float = fps
        self.skipped = 0
        """Number of frames that were skipped because a later one was due, or because they were damaged."""
        self.size: tuple[int, int] | None = None
        """Shape (h, w) of each stored frame; None until the first frame decides it."""
        self.count: int | None = None
        """Number of frames that the file states; None if unknown."""
        self._views_of = views_of
        self._raised_kinds: set[str] = set()

    @property
    @abstractmethod
    def at_end(self) -> bool:
        """True if no frame is left."""

    @abstractmethod
    def next(self) -> VideoFrame | None:
        """Return the next frame, or the next one a camera takes; None at the end. Raises: PictureError."""

    @abstractmethod
    def at(self, time_s: float) -> VideoFrame | None:
        """Return the latest frame due, or a camera's newest; None if it is not new. Raises: as `next`."""

    @abstractmethod
    def close(self) -> None:
        """Close the source. A second call does nothing."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _frame(self, number: int, time_s: float, picture: np.ndarray, name: object) -> VideoFrame:
        """Make a frame of a picture. Raises: PictureError if its size differs from the first frame's."""
        self.size = self.size or picture.shape[:2]
        if picture.shape[:2] != self.size:
            first = size_in_words(np.empty(self.size, np.bool_))
            raise PictureError(
                f"{name}: is {size_in_words(picture)} and the first frame {first}; all frames of a video must be of "
                "one size"
            )
        return VideoFrame(number, time_s, self._views_of(picture))

    def _raise_once(self, kind: str, error: PictureError) -> None:
        if kind not in self._raised_kinds:
            self._raised_kinds.add(kind)
            raise error

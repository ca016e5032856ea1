"""What OpenCV plays: video files and cameras, opened within limits and without a word on standard error."""

import os
import stat
from collections.abc import Callable
from math import isfinite
from pathlib import Path
from typing import Any, Protocol, cast

import numpy as np
from jaxtyping import UInt8

from ...data.pictures import to_rgb8
from ...errors import PictureError, did_you_mean
from ...files.reading import TooLargeError, check_size
from ...runtime.opencv import silent_opencv
from ...runtime.threads import processors, thread_limit

USUAL_FPS = 30.0
"""Of a folder, and where nothing that makes sense is said."""
LEAST_FPS, MOST_FPS = 0.1, 480.0
"""Between these, a rate that a file or a camera says of itself is believed; some say 0, or the ticks of their clock."""


MOST_THREADS = 4
"""Of a decoder: each holds frames of its own."""


class Capture(Protocol):
    """What is used of cv2.VideoCapture."""

    def isOpened(self) -> bool:
        """Whether there is anything to play."""
        ...

    def grab(self) -> bool:
        """Go to the next frame; whether there is one."""
        ...

    def retrieve(self) -> tuple[bool, Any]:
        """Whether the frame is whole, and its picture in BGR."""
        ...

    def get(self, propId: int, /) -> float:
        """What is known of it, by a number of OpenCV's."""
        ...

    def release(self) -> None:
        """Give it back."""
        ...


OpenCamera = Callable[[int, float | None], Capture]
"""(number, frames a second or None) -> a camera, opened or not."""


def open_file(path: Path) -> Capture:
    """A video file that has pictures. Raises: PictureError for any other file, and for one whose frames are too large.

    By FFmpeg alone: OpenCV's other readers take the digits in a name for the numbers of pictures.
    """
    import cv2

    _check_is_file(path)
    with silent_opencv():
        threads = [cv2.CAP_PROP_N_THREADS, min(thread_limit() or processors(), MOST_THREADS)]
        capture = cast(Capture, cv2.VideoCapture(str(path.absolute()), cv2.CAP_FFMPEG, threads))
    if not capture.isOpened():
        raise PictureError(
            f"{path}: is no video that this program can play, or has no pictures; convert it to an .mp4 with H.264"
        )
    size = round(capture.get(cv2.CAP_PROP_FRAME_HEIGHT)), round(capture.get(cv2.CAP_PROP_FRAME_WIDTH))
    check_frame(size, path)
    return capture


def open_camera(number: int, fps: float | None) -> Capture:
    """A camera by its number, opened or not."""
    import cv2

    with silent_opencv():
        capture = cv2.VideoCapture(number)
        if fps is not None:
            capture.set(cv2.CAP_PROP_FPS, fps)
    return cast(Capture, capture)


def grabbed(capture: Capture) -> bool:
    """Whether there is a next frame, which is now the one to retrieve."""
    with silent_opencv():
        return bool(capture.grab())


def retrieved(capture: Capture, name: object) -> UInt8[np.ndarray, "h w 3"] | None:
    """The frame that was grabbed, in RGB; None for one that is damaged. Raises: PictureError for one too large."""
    import cv2

    with silent_opencv():
        done, picture = capture.retrieve()
    if not done or picture is None or picture.size == 0:
        return None
    picture = np.asarray(picture)
    check_frame(picture.shape, name)
    if picture.dtype == np.uint8 and picture.shape[2:] == (3,):
        return np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB), np.uint8)
    return np.ascontiguousarray(to_rgb8(picture.squeeze(2) if picture.shape[2:] == (1,) else picture)[..., ::-1])


def stated_fps(capture: Capture) -> float | None:
    """The frames a second that a file or a camera says it has; None for nonsense."""
    import cv2

    fps = capture.get(cv2.CAP_PROP_FPS)
    return fps if isfinite(fps) and LEAST_FPS <= fps <= MOST_FPS else None


def stated_count(capture: Capture) -> int | None:
    """How many frames a file says it has; None where it does not say."""
    import cv2

    count = capture.get(cv2.CAP_PROP_FRAME_COUNT)
    return int(count) if isfinite(count) and 0 < count < 1e9 else None


def position_s(capture: Capture) -> float:
    """When the file says that the grabbed frame is due; anything, where it does not say."""
    import cv2

    return capture.get(cv2.CAP_PROP_POS_MSEC) / 1000


def check_frame(shape: tuple[int, ...], name: object) -> None:
    """Raises: PictureError for a frame that is larger than a picture may be."""
    try:
        check_size((*shape[:2], 4), 1)
    except TooLargeError as error:
        raise PictureError(f"{name}: a frame of it {error}; make the video smaller first") from error


def _check_is_file(path: Path) -> None:
    """Raises: PictureError, with the cure, where there is none that can be read."""
    try:
        found = path.stat()
        readable = os.access(path, os.R_OK)
    except (FileNotFoundError, NotADirectoryError) as error:
        if not path.parent.is_dir():
            raise PictureError(f"{path}: there is no folder {path.parent}; check the path") from error
        near = did_you_mean(path.name, (each.name for each in path.parent.iterdir()))
        raise PictureError(f"{path}: there is no such file or folder{near}") from error
    except (OSError, ValueError) as error:
        raise PictureError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from error
    if not stat.S_ISREG(found.st_mode):
        raise PictureError(
            f"{path}: is a device or a pipe, not a video file; name a file, a folder of pictures, or a camera by its "
            "number (video: 0)"
        )
    if not found.st_size:
        raise PictureError(f"{path}: the file is empty; copy or download it again")
    if not readable:
        raise PictureError(f"{path}: cannot be read: Permission denied; check its permissions")

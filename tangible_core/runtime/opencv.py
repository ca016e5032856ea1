"""OpenCV with one arithmetic on every processor."""

import os
from collections.abc import Generator
from contextlib import contextmanager
from threading import Lock
from typing import Any

from .threads import limiters

_LOCK = Lock()
_users = 0
_limits: list[int] = []
_before = (True, 1)
"""Whether OpenCV was optimised, and its threads, before the first of them came."""
_silent, _loud = 0, 0
"""How many want it to be silent, and the level of its log before the first of them came."""
_QUIET = "-8"  # AV_LOG_QUIET


@contextmanager
def plain_opencv() -> Generator[None]:
    """OpenCV without the code that it chooses by the processor, its own and Intel's IPP.

    With that code the last bits of floating-point filters, of interpolation and of SIFT differ between processors that
    fuse multiplication and addition and those that do not, between vector widths, and from run to run with the place of
    an array in memory. OpenCV's own code is switched for the whole process, until the last thread has left. IPP is
    switched for one thread alone: so this stands where the call is, inside a thread's own work, and OpenCV has no
    threads meanwhile, of which some would use IPP and others not. A Gaussian takes 15 % longer.
    """
    global _users
    import cv2

    ipp = cv2.ipp.useIPP()
    with _LOCK:
        _remember(cv2)
        _users += 1
        _switch(cv2)
    cv2.ipp.setUseIPP(False)
    try:
        yield
    finally:
        with _LOCK:
            _users -= 1
            _switch(cv2)
        cv2.ipp.setUseIPP(ipp)


@contextmanager
def opencv_at_most(threads: int) -> Generator[None]:
    """OpenCV with no more threads than these, for the whole process."""
    import cv2

    with _LOCK:
        _remember(cv2)
        _limits.append(threads)
        _switch(cv2)
    try:
        yield
    finally:
        with _LOCK:
            _limits.remove(threads)
            _switch(cv2)


@contextmanager
def silent_opencv() -> Generator[None]:
    """OpenCV, and FFmpeg in it, without a word on standard error, for the whole process until the last one has left.

    FFmpeg reads how much it may say once, when the first video is opened; who has set it (OPENCV_FFMPEG_LOGLEVEL) to
    look for a fault is heard.
    """
    global _silent, _loud
    import cv2

    logging: Any = cv2.utils.logging
    with _LOCK:
        if not _silent:
            os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", _QUIET)
            _loud = logging.getLogLevel()
            logging.setLogLevel(logging.LOG_LEVEL_SILENT)
        _silent += 1
    try:
        yield
    finally:
        with _LOCK:
            _silent -= 1
            if not _silent:
                logging.setLogLevel(_loud)


limiters.append(opencv_at_most)


def _remember(cv2: Any) -> None:
    global _before
    if not _users and not _limits:
        _before = cv2.useOptimized(), cv2.getNumThreads()


def _switch(cv2: Any) -> None:
    """To what all who are in a block need together."""
    optimised, threads = _before
    cv2.setUseOptimized(optimised and not _users)
    cv2.setNumThreads(1 if _users else min([threads, *_limits]))

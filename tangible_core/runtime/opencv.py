"""OpenCV with the same arithmetic on every processor, with limited threads, and without messages."""

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
"""OpenCV's own setting (is it optimised, number of threads) before the first block."""
_silent, _log_level = 0, 0
"""The number of blocks that want OpenCV silent, and its log level before the first of them."""
_QUIET = "-8"  # AV_LOG_QUIET


@contextmanager
def plain_opencv() -> Generator[None]:
    """Run OpenCV in this block without code for special processors, its own and Intel's IPP.

    With that code the last bits of floating-point filters, of interpolation and of SIFT differ between processors with
    and without fused multiplication and addition, between vector widths, and between runs by the address of an array.
    OpenCV's own code is switched for the whole process, until the last thread has left its block. IPP, which OpenCV
    switches with it, is switched for one thread only: so the block must be inside the thread that calls OpenCV, and
    OpenCV has no threads of its own meanwhile, some of which would use IPP. A Gaussian takes 15 % longer.
    """
    global _users
    import cv2

    ipp = cv2.ipp.useIPP()
    with _LOCK:
        _remember(cv2)
        _users += 1
        _switch(cv2)
    try:
        yield
    finally:
        with _LOCK:
            _users -= 1
            _switch(cv2)
        cv2.ipp.setUseIPP(ipp)


@contextmanager
def opencv_at_most(threads: int) -> Generator[None]:
    """Limit the threads of OpenCV in this block, for the whole process."""
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
    """Silence OpenCV, and FFmpeg in it, on standard error, for the whole process until the last block has ended.

    FFmpeg reads its log level once, when the first video is opened; a level that the user has set
    (OPENCV_FFMPEG_LOGLEVEL) is kept.
    """
    global _silent, _log_level
    import cv2

    logging: Any = cv2.utils.logging
    with _LOCK:
        if not _silent:
            os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", _QUIET)
            _log_level = logging.getLogLevel()
            logging.setLogLevel(logging.LOG_LEVEL_SILENT)
        _silent += 1
    try:
        yield
    finally:
        with _LOCK:
            _silent -= 1
            if not _silent:
                logging.setLogLevel(_log_level)


limiters.append(opencv_at_most)


def _remember(cv2: Any) -> None:
    global _before
    if not _users and not _limits:
        _before = cv2.useOptimized(), cv2.getNumThreads()


def _switch(cv2: Any) -> None:
    """Set OpenCV to the strictest setting of all open blocks."""
    optimised, threads = _before
    cv2.setUseOptimized(optimised and not _users)
    cv2.setNumThreads(1 if _users else min([threads, *_limits]))

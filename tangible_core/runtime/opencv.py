"""OpenCV, imported when a name of `cv2` is first used, with the same arithmetic on every processor and few threads.

Its import takes longer than to list methods or to plan a run. Blocks here also limit its threads and its messages.
"""

import os
from collections.abc import Generator
from contextlib import contextmanager
from threading import Lock
from typing import TYPE_CHECKING, Any

from .threads import limiters

if TYPE_CHECKING:
    import cv2 as cv2
else:

    class _OnFirstUse:
        def __getattr__(self, name: str) -> Any:
            import cv2

            return getattr(cv2, name)

    cv2 = _OnFirstUse()

_LOCK = Lock()
# The open blocks: the greatest number of threads, and True for one without code for special processors.
_blocks: list[tuple[int, bool]] = []
# OpenCV's own setting (is it optimised, number of threads) before the first block.
_before = (True, 1)
# The number of blocks that want OpenCV silent, and its log level before the first of them.
_silent, _log_level = 0, 0
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
    ipp = cv2.ipp.useIPP()
    try:
        with opencv_at_most(1, plain=True):
            yield
    finally:
        cv2.ipp.setUseIPP(ipp)


@contextmanager
def opencv_at_most(threads: int, plain: bool = False) -> Generator[None]:
    """Limit the threads of OpenCV in this block, for the whole process. plain: as in `plain_opencv`."""
    global _before
    with _LOCK:
        if not _blocks:
            _before = cv2.useOptimized(), cv2.getNumThreads()
        _blocks.append((threads, plain))
        _switch()
    try:
        yield
    finally:
        with _LOCK:
            _blocks.remove((threads, plain))
            _switch()


@contextmanager
def silent_opencv() -> Generator[None]:
    """Silence OpenCV, and FFmpeg in it, on standard error, for the whole process until the last block has ended.

    FFmpeg reads its log level once, when the first video is opened; a level that the user has set
    (OPENCV_FFMPEG_LOGLEVEL) is kept.
    """
    global _silent, _log_level
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


def _switch() -> None:
    """Set OpenCV to the strictest setting of all open blocks."""
    is_optimised, threads = _before
    cv2.setUseOptimized(is_optimised and not any(plain for _, plain in _blocks))
    cv2.setNumThreads(min([threads, *(most for most, _ in _blocks)]))

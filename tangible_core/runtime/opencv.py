"""OpenCV with one arithmetic on every processor."""

from collections.abc import Generator
from contextlib import contextmanager
from threading import Lock

_LOCK = Lock()
_users = 0
_before = (True, 1)
"""Whether OpenCV was optimised, and its threads, before the first of them came."""


@contextmanager
def plain_opencv() -> Generator[None]:
    """OpenCV without the code that it chooses by the processor, its own and Intel's IPP.

    With that code the last bits of floating-point filters, of interpolation and of SIFT differ between processors that
    fuse multiplication and addition and those that do not, between vector widths, and from run to run with the place of
    an array in memory. OpenCV's own code is switched for the whole process, until the last thread has left. IPP is
    switched for one thread alone: so this stands where the call is, inside a thread's own work, and OpenCV has no
    threads meanwhile, of which some would use IPP and others not. A Gaussian takes 15 % longer.
    """
    global _users, _before
    import cv2

    ipp = cv2.ipp.useIPP()
    with _LOCK:
        if not _users:
            _before = cv2.useOptimized(), cv2.getNumThreads()
            cv2.setUseOptimized(False)
            cv2.setNumThreads(1)
        _users += 1
    cv2.ipp.setUseIPP(False)
    try:
        yield
    finally:
        with _LOCK:
            _users -= 1
            if not _users:
                cv2.setUseOptimized(_before[0])
                cv2.setNumThreads(_before[1])
        cv2.ipp.setUseIPP(ipp)

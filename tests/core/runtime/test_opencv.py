"""OpenCV's switches: results differ between processors without them, and other programs are slow if they stay."""

from threading import Barrier, Thread

import cv2
import pytest

from tangible_core.runtime.opencv import plain_opencv


@pytest.fixture(autouse=True)
def check_reset():
    before = cv2.useOptimized(), cv2.getNumThreads(), cv2.ipp.useIPP()
    yield
    assert (cv2.useOptimized(), cv2.getNumThreads(), cv2.ipp.useIPP()) == before


def test_plain_opencv_switches_back_when_the_last_block_ends():
    with plain_opencv():
        assert not cv2.useOptimized()
        assert not cv2.ipp.useIPP()
        assert cv2.getNumThreads() == 1
    entered, left = Barrier(2, timeout=10), Barrier(2, timeout=10)
    seen = []

    def first():
        with plain_opencv():
            entered.wait()
        left.wait()

    def second():
        with plain_opencv():
            entered.wait()
            left.wait()
            seen.append((cv2.useOptimized(), cv2.ipp.useIPP(), cv2.getNumThreads()))

    threads = [Thread(target=each) for each in (first, second)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert seen == [(False, False, 1)]

"""OpenCV's switches, and that they are put back."""

from threading import Barrier, Thread

import cv2
import pytest

from tangible_core.runtime.opencv import plain_opencv


@pytest.fixture(autouse=True)
def as_it_was():
    before = cv2.useOptimized(), cv2.getNumThreads(), cv2.ipp.useIPP()
    yield
    assert (cv2.useOptimized(), cv2.getNumThreads(), cv2.ipp.useIPP()) == before


def test_opencv_is_plain_inside_and_as_before_afterwards():
    with plain_opencv():
        assert not cv2.useOptimized()
        assert not cv2.ipp.useIPP()
        assert cv2.getNumThreads() == 1


def test_what_fails_inside_leaves_no_switch_behind():
    with pytest.raises(ZeroDivisionError), plain_opencv():
        _ = 1 / 0


def test_it_stays_plain_until_the_last_has_left():
    with plain_opencv():
        with plain_opencv():
            pass
        assert not cv2.useOptimized()
        assert not cv2.ipp.useIPP()


def test_who_has_switched_optimising_off_finds_it_off():
    cv2.setUseOptimized(False)
    try:
        with plain_opencv():
            pass
        assert not cv2.useOptimized()
    finally:
        cv2.setUseOptimized(True)


def test_threads_that_overlap_are_plain_to_their_end():
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
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert seen == [(False, False, 1)]

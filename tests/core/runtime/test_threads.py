"""One limit for the threads of kernels, OpenCV and torch."""

import os
import subprocess
import sys
from threading import Barrier, BrokenBarrierError

import cv2
import numpy as np
import pytest

from tangible_core import Pipeline, Scene, SegmentMap
from tangible_core.compiled import threads
from tangible_core.compiled.threads import in_blocks, in_turns, thread_count
from tangible_core.errors import ArgumentError, ConfigError
from tangible_core.plugins.interfaces import Segmenter
from tangible_core.runtime.opencv import plain_opencv
from tangible_core.runtime.threads import check_threads, limited_threads, processors


@pytest.fixture
def eight(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(threads, "processors", lambda: 8)
    before = cv2.getNumThreads()
    cv2.setNumThreads(6)
    yield
    cv2.setNumThreads(before)


class Asking(Segmenter):
    def segment(self, picture: np.ndarray) -> SegmentMap:
        SEEN.append((thread_count(), cv2.getNumThreads()))
        return SegmentMap(np.zeros(picture.shape[:2], np.int32))


SEEN: list[tuple[int, int]] = []


def test_a_block_limits_kernels_and_opencv_and_leaves_them_as_they_were(eight):
    with limited_threads(3):
        assert (thread_count(), cv2.getNumThreads()) == (3, 3)
        with plain_opencv():
            assert cv2.getNumThreads() == 1
        with limited_threads(2), limited_threads():
            assert (thread_count(), cv2.getNumThreads()) == (2, 2)
        assert (thread_count(), cv2.getNumThreads()) == (3, 3)
    assert (thread_count(), cv2.getNumThreads()) == (8, 6)
    with limited_threads(20):
        assert (thread_count(), cv2.getNumThreads()) == (8, 6)


def test_no_more_work_at_once_than_the_limit(eight):
    meeting = Barrier(3)

    def meet(*_: object) -> None:
        try:
            meeting.wait(0.2)
        except BrokenBarrierError:
            return
        raise AssertionError("three at once")

    with limited_threads(2):
        in_turns(list(range(3)), lambda share: [meet(each) for each in share])
        meeting.reset()
        in_blocks(64, meet)


def test_the_environment_limits_a_method_that_is_called_by_itself(eight, monkeypatch: pytest.MonkeyPatch):
    SEEN.clear()
    monkeypatch.setenv("TANGIBLE_THREADS", "2")
    Asking().segment(np.zeros((4, 4), np.float32))
    monkeypatch.delenv("TANGIBLE_THREADS")
    Asking().segment(np.zeros((4, 4), np.float32))
    assert SEEN == [(2, 2), (8, 6)]


def test_a_pipeline_has_a_limit_of_its_own(eight, monkeypatch: pytest.MonkeyPatch):
    SEEN.clear()
    monkeypatch.setenv("TANGIBLE_THREADS", "5")
    scene = Scene.photo(np.zeros((8, 8), np.float32))
    pipeline = Pipeline(scene, texture=Asking(), cached=False, threads=3)
    assert pipeline.threads == pipeline.changed(pipeline.config).threads == 3
    pipeline.make("segments")
    Pipeline(scene, texture=Asking(), cached=False).make("segments")
    assert SEEN == [(3, 3), (5, 5)]


@pytest.mark.parametrize("said", ["none", "0", "-1", "1.5", "²"])
def test_a_variable_that_is_no_number_is_one_line(said: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("TANGIBLE_THREADS", said)
    with pytest.raises(ConfigError, match=r"TANGIBLE_THREADS: is .* a whole number of threads from 1"):
        thread_count()


@pytest.mark.parametrize("said", [0, -1, 1.5, True, "2"])
def test_an_option_that_is_no_number_is_one_line(said: object):
    with pytest.raises(ArgumentError, match=r"threads: is .* a whole number from 1"):
        check_threads(said)


TORCH = """
from tangible_core.runtime.threads import limited_threads
from tangible_core.runtime.torch_extra import need
with limited_threads(1):
    torch = need("torch")
    inside = torch.get_num_threads()
outside = torch.get_num_threads()
with limited_threads(1):
    again = torch.get_num_threads()
print(inside, outside, again, torch.get_num_threads())
"""


@pytest.mark.slow
def test_torch_obeys_it_whenever_it_is_imported():
    """Torch takes its own number from the environment, and no more than there are processors."""
    told = {**os.environ, "OMP_NUM_THREADS": "2", "MKL_NUM_THREADS": "2"}
    told.pop("TANGIBLE_THREADS", None)
    said = subprocess.run([sys.executable, "-c", TORCH], env=told, capture_output=True, text=True, timeout=120)
    own = str(min(2, processors()))
    assert said.stdout.split() == ["1", own, "1", own], said.stderr

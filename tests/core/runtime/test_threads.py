"""One limit for the threads of kernels, OpenCV and torch: several workers on a machine must not slow each other."""

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
from tangible_core.runtime.system.processes import processors
from tangible_core.runtime.threads import check_threads, limited_threads


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


def test_thread_limit_bounds_kernels_and_opencv_until_the_block_ends(eight):
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


def test_thread_limit_is_a_number_of_the_pipeline_or_the_environment(eight, monkeypatch: pytest.MonkeyPatch):
    SEEN.clear()
    scene = Scene.photo(np.zeros((8, 8), np.float32))
    Asking().segment(scene.views.left)
    monkeypatch.setenv("TANGIBLE_THREADS", "5")
    Asking().segment(scene.views.left)
    pipeline = Pipeline(scene, texture=Asking(), cached=False, threads=3)
    assert pipeline.engine.threads == Pipeline.from_config(pipeline.config, like=pipeline).engine.threads == 3
    pipeline.make("segments")
    Pipeline(scene, texture=Asking(), cached=False).make("segments")
    assert SEEN == [(8, 6), (5, 5), (3, 3), (5, 5)]
    for text in ("none", "0", "1.5", "²"):
        monkeypatch.setenv("TANGIBLE_THREADS", text)
        with pytest.raises(ConfigError, match="TANGIBLE_THREADS"):
            thread_count()
    for value in (0, 1.5, True, "2"):
        with pytest.raises(ArgumentError, match="threads"):
            check_threads(value)


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


@pytest.mark.whole
def test_thread_limit_holds_for_torch_whenever_it_is_imported():
    """Torch takes its number of threads from the environment, up to the number of processors."""
    variables = {**os.environ, "OMP_NUM_THREADS": "2", "MKL_NUM_THREADS": "2"}
    variables.pop("TANGIBLE_THREADS", None)
    done = subprocess.run([sys.executable, "-c", TORCH], env=variables, capture_output=True, text=True, timeout=120)
    own = str(min(2, processors()))
    assert done.stdout.split() == ["1", own, "1", own], done.stderr

"""Films made in code: frames that are given, and a scene of two layers whose disparity is known."""

from collections.abc import Sequence
from typing import final

import numpy as np

from tangible_core.data import DisparityMap, Relief, Views
from tangible_core.errors import PictureError
from tangible_core.plugins.interfaces import Film, Touch
from tangible_core.relief import ReliefScale
from tangible_core.relief.shaping import STRAIGHT
from tangible_core.scene.geometry import make_relief, nearness_range
from tangible_core.scene.video.capture import VideoFrame, VideoFrames
from tangible_core.session.film import FrameMaker


@final
class GivenFrames(VideoFrames):
    """Frames from a list, each due when its number says; an error in the list is raised in its place."""

    def __init__(self, given: Sequence[Views | PictureError], fps: float = 30.0, first_s: float = 0.0) -> None:
        super().__init__(fps, lambda picture: Views(picture))
        self._given, self._number, self._first_s = given, 0, first_s
        self.closed = False

    @property
    def at_end(self) -> bool:
        return self._number >= len(self._given)

    def next(self) -> VideoFrame | None:
        if self.at_end:
            return None
        number, self._number = self._number, self._number + 1
        views = self._given[number]
        if isinstance(views, PictureError):
            raise views
        return VideoFrame(number, self._first_s + number / self.fps, views)

    def at(self, time_s: float) -> VideoFrame | None:
        due = min(int((time_s - self._first_s) * self.fps + 1e-9), len(self._given) - 1)
        if due < self._number:
            return None
        self.skipped += due - self._number
        self._number = due
        return self.next()

    def close(self) -> None:
        self.closed = True


@final
class NearnessOfGrey(FrameMaker):
    """Grey levels as disparity in pixels, NaN where they are 255."""

    def __init__(self) -> None:
        self.begun = 0

    def begin(self, views: Views) -> DisparityMap:
        self.begun += 1
        return self.disparity(views)

    def disparity(self, views: Views) -> DisparityMap:
        values = views.left.astype(np.float32)
        return DisparityMap(np.where(values == 255, np.float32(np.nan), values))

    def scale(self, disparity: DisparityMap) -> ReliefScale:
        return ReliefScale(nearness_range(disparity, None), STRAIGHT)

    def relief(self, disparity: DisparityMap, scale: ReliefScale) -> Relief:
        return make_relief(disparity, None, 0.08, 0.01, "fill", scale.spans)


class Seen(Film):
    """A film that keeps what it is shown, and has no touch."""

    def __init__(self, arrives: int = 0) -> None:
        """arrives: so many showings after a new frame it is there."""
        self.frames: list[int] = []
        self.reliefs: list[Relief] = []
        self._arrives, self._left = arrives, 0

    @property
    def touch(self) -> Touch:
        raise AssertionError("this film is only shown")

    def show(self, relief: Relief, frame: int) -> None:
        self._left = self._left - 1 if self.frames[-1:] == [frame] else self._arrives
        self.frames.append(frame)
        self.reliefs.append(relief)

    @property
    def arrived(self) -> bool:
        return self._left <= 0

    @property
    def dropped(self) -> int:
        return 0


def greys(*values: np.ndarray | float, shape: tuple[int, int] = (8, 12)) -> list[Views]:
    """Views of one picture each, of these grey levels."""
    return [Views(np.broadcast_to(np.asarray(value, np.uint8), shape).copy()) for value in values]


def layered(number: int, noise: float, generator: np.random.Generator, shape: tuple[int, int] = (96, 128)) -> Views:
    """A pair: a box nearer by 12 px than the ground behind it walks by 3 px a frame; noise of this deviation."""
    return Views(*(_noisy(view, noise, generator) for view in _layers(number, shape)))


def true_disparity(number: int, shape: tuple[int, int] = (96, 128)) -> np.ndarray:
    """Of the left view of `layered`."""
    return np.where(_box(number, shape, 0), np.float32(16), np.float32(4))


def _box(number: int, shape: tuple[int, int], shift: int) -> np.ndarray:
    rows, columns = np.indices(shape)
    return (np.abs(columns + shift - 40 - 3 * number) < 20) & (np.abs(rows - shape[0] // 2) < shape[0] // 4)


def _layers(number: int, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    textures = np.random.default_rng(5).uniform(30, 220, (2, shape[0], 4 * shape[1]))
    width, at = shape[1], 60 + 3 * number
    ground, box = textures
    left = np.where(_box(number, shape, 0), box[:, 200 - at : 200 - at + width], ground[:, 60 : 60 + width])
    right = np.where(_box(number, shape, 16), box[:, 216 - at : 216 - at + width], ground[:, 64 : 64 + width])
    return left, right


def _noisy(view: np.ndarray, noise: float, generator: np.random.Generator) -> np.ndarray:
    return np.clip(view + generator.normal(0, noise, view.shape), 0, 255).astype(np.uint8)

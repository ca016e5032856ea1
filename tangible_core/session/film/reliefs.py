"""The frames of a video as reliefs of one scale, one after the other."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from types import TracebackType
from typing import NamedTuple, Self, final

import numpy as np

from ...data import DisparityMap, Relief, Views
from ...errors import ConfigError
from ...plugins.notes import silently
from ...scene.geometry import ValueRange
from ...scene.video.frames import VideoFrame, VideoFrames
from .scale import Scale
from .steady import Steady

LOOK_EVERY, LOOK_PIXELS = 8, 4
"""Frames after which the range of nearness is looked at, and one pixel in so many a side that is."""


class FrameMaker(ABC):
    """How one frame of a film becomes a disparity map, and that a relief: as the pipeline has it."""

    @abstractmethod
    def begin(self, views: Views) -> DisparityMap:
        """As `disparity`, of the first frame, in which what is found once, such as the range of disparities, is."""

    @abstractmethod
    def disparity(self, views: Views) -> DisparityMap:
        """Of a frame, on the grid that is felt."""

    @abstractmethod
    def nearness(self, disparity: DisparityMap) -> ValueRange:
        """The range of it that would span a relief of this map alone. Raises: GeometryError if nothing is known."""

    @abstractmethod
    def relief(self, disparity: DisparityMap, spans: ValueRange) -> Relief:
        """Of a map, within this range. Raises: GeometryError if nothing is known."""


class FrameRelief(NamedTuple):
    """A frame of a film as it is felt."""

    number: int
    time_s: float
    relief: Relief


@final
class Reliefs:
    """A video's frames as reliefs, as a context manager and an iterator; of one reader.

    What a frame shows is made steady against the frames before it, and has their scale until the scene is cut.
    """

    def __init__(self, opened: Callable[[], VideoFrames], maker: FrameMaker) -> None:
        """opened: opens the video, such as `Video.open`."""
        self._opened, self._maker = opened, maker
        self._frames: VideoFrames | None = None
        self._steady, self._scale = Steady(), Scale(ValueRange(0, 0))
        self._made = 0

    def __enter__(self) -> Self:
        """Raises: PictureError if the video is not there."""
        self._frames = self._opened()
        self._made = 0
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._frames is not None:
            self._frames.close()

    def __iter__(self) -> Iterator[FrameRelief]:
        """All of them, in order. Raises: TangibleError for a frame that cannot be read, or has no depth."""
        while (frame := self.frames.next()) is not None:
            yield self.made(frame)

    @property
    def frames(self) -> VideoFrames:
        """Those of the video."""
        if self._frames is None:
            raise ConfigError("the film is not open; use it in `with reliefs:`")
        return self._frames

    def made(self, frame: VideoFrame) -> FrameRelief:
        """The relief of the next frame that is to be felt. Raises: TangibleError if no depth can be found in it."""
        with silently():
            disparity = self._disparity(frame)
            return FrameRelief(frame.number, frame.time_s, self._maker.relief(disparity, self._scale.spans))

    def _disparity(self, frame: VideoFrame) -> DisparityMap:
        if not self._made:
            return self._begin(frame)
        found = self._steady.next(self._maker.disparity(frame.views))
        if found.cut:
            return self._begin(frame)
        if self._made % LOOK_EVERY == 0:
            self._scale.look(self._maker.nearness(_thinned(found.disparity)), frame.time_s)
        self._made += 1
        return found.disparity

    def _begin(self, frame: VideoFrame) -> DisparityMap:
        """A scene: the film's first, or one after a cut; the next frame, if nothing can be found in this one."""
        self._made = 0
        self._steady = Steady()
        disparity = self._steady.next(self._maker.begin(frame.views)).disparity
        self._scale = Scale(self._maker.nearness(disparity), frame.time_s)
        self._made = 1
        return disparity


def _thinned(disparity: DisparityMap) -> DisparityMap:
    step = slice(None, None, LOOK_PIXELS)
    few = disparity.disparity_px[step, step]
    return DisparityMap(few if np.isfinite(few).any() else disparity.disparity_px, unit=disparity.unit)

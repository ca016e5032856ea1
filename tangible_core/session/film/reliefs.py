"""The frames of a video as reliefs of one scale, one after the other."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from typing import NamedTuple, Self, final

import numpy as np

from ...data import DisparityMap, Relief, Views
from ...errors import ConfigError
from ...plugins.notes import silently
from ...relief import ReliefScale
from ...scene.geometry import ValueRange
from ...scene.video.capture import VideoFrame, VideoFrames
from .steady import Steady

# Interval, in frames, of measuring the scale; and step, in pixels, of the thinned map for it.
LOOK_EVERY, LOOK_PIXELS = 8, 4
# Time constant with which the range follows the frames: a relief of 10 mm then moves by 1 mm/s at most.
ADAPTS_S = 10.0


class FrameMaker(ABC):
    """A pipeline's conversion of one frame of a film into a disparity map, and of that into a relief."""

    @abstractmethod
    def begin(self, views: Views) -> DisparityMap:
        """Return the disparity of the first frame, and store what is determined once, such as the disparity range."""

    @abstractmethod
    def disparity(self, views: Views) -> DisparityMap:
        """Return the disparity of a frame, on the grid of the surface."""

    @abstractmethod
    def scale(self, disparity: DisparityMap) -> ReliefScale:
        """Return the scale for a relief of this map alone. Raises: GeometryError if nothing is known."""

    @abstractmethod
    def relief(self, disparity: DisparityMap, scale: ReliefScale) -> Relief:
        """Return the relief of a map by this scale. Raises: GeometryError if nothing is known."""


class FrameRelief(NamedTuple):
    """A frame of a film as a relief."""

    number: int
    time_s: float
    relief: Relief


@final
class Scale:
    """The scale of the first frame, which follows that of later ones slowly."""

    def __init__(self, first: ReliefScale, time_s: float = 0.0) -> None:
        self.current: ReliefScale = first
        self._time_s = time_s

    def look(self, scale: ReliefScale, time_s: float) -> None:
        """Follow the scale of a frame at this time of the film; the first that is not empty is adopted at once."""
        share = 1 - math.exp(-max(0.0, time_s - self._time_s) / ADAPTS_S)
        self._time_s = time_s
        if not self.current.spans.low < self.current.spans.high:
            self.current = scale
        elif scale.spans.low < scale.spans.high:
            low, high = (then + share * (now - then) for then, now in zip(self.current.spans, scale.spans, strict=True))
            tones = self.current.tones + share * (scale.tones - self.current.tones)
            self.current = ReliefScale(ValueRange(low, high), tones)


@final
class Reliefs:
    """A video's frames as reliefs, as a context manager and an iterator for one reader.

    Each frame is filtered in time with the frames before it, and has their scale until the scene is cut.
    """

    def __init__(self, open_frames: Callable[[], VideoFrames], maker: FrameMaker) -> None:
        """Prepare the reliefs. open_frames: opens the video, such as `Video.open`."""
        self._open_frames, self._maker = open_frames, maker
        self._frames: VideoFrames | None = None
        self._steady = Steady()
        self._scale: Scale | None = None
        self._count = 0
        """Number of frames since the last cut; 0 before the first frame of a scene."""

    def __enter__(self) -> Self:
        """Open the video. Raises: PictureError if it does not exist."""
        self._frames = self._open_frames()
        self._count = 0
        return self

    def __exit__(self, *_: object) -> None:
        if self._frames is not None:
            self._frames.close()

    def __iter__(self) -> Iterator[FrameRelief]:
        """Yield all reliefs in order. Raises: TangibleError for a frame that cannot be read, or has no depth."""
        while (frame := self.frames.next()) is not None:
            yield self.make(frame)

    @property
    def frames(self) -> VideoFrames:
        """The frames of the video."""
        if self._frames is None:
            raise ConfigError("the film is not open; use it in `with reliefs:`")
        return self._frames

    def make(self, frame: VideoFrame) -> FrameRelief:
        """Return the relief of the next frame. Raises: TangibleError if the frame has no depth."""
        with silently():
            disparity = self._disparity(frame)
            assert self._scale is not None
            return FrameRelief(frame.number, frame.time_s, self._maker.relief(disparity, self._scale.current))

    def _disparity(self, frame: VideoFrame) -> DisparityMap:
        if not self._count:
            return self._begin(frame)
        steady_map = self._steady.next(self._maker.disparity(frame.views))
        if steady_map.cut:
            return self._begin(frame)
        if self._scale is not None and self._count % LOOK_EVERY == 0:
            whole = steady_map.disparity
            few = whole.disparity_px[::LOOK_PIXELS, ::LOOK_PIXELS]
            thin = DisparityMap(few if np.isfinite(few).any() else whole.disparity_px, unit=whole.unit)
            self._scale.look(self._maker.scale(thin), frame.time_s)
        self._count += 1
        return steady_map.disparity

    def _begin(self, frame: VideoFrame) -> DisparityMap:
        """Begin a scene, the first or one after a cut; if this frame has no depth, the next one begins it."""
        self._count = 0
        self._steady = Steady()
        disparity = self._steady.next(self._maker.begin(frame.views)).disparity
        self._scale = Scale(self._maker.scale(disparity), frame.time_s)
        self._count = 1
        return disparity

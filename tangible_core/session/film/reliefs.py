"""The frames of a video as reliefs of one scale, one after the other, by disparity that is filtered in time."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, Self, cast, final

import numpy as np
from jaxtyping import Float32

from ...data import DisparityMap, Relief, Views
from ...errors import ConfigError
from ...plugins.notes import silently
from ...relief import ReliefScale
from ...scene.geometry import ValueRange
from ...scene.video.capture import VideoFrame, VideoFrames

# Interval, in frames, of measuring the scale; and step, in pixels, of the thinned map for it.
LOOK_EVERY, LOOK_PIXELS = 8, 4
# Time constant with which the range follows the frames: a relief of 10 mm then moves by 1 mm/s at most.
ADAPTS_S = 10.0
# Weight of a new value in the average, where it differs little: after five frames, two thirds are new.
AVERAGED = 0.2
# Threshold between noise and change: pixels of the pictures, or a share of the range of a relative map.
GATE_PX, GATE_SHARE = 1.0, 0.03
# Greatest number of frames for which a value is kept while other values, or none, are seen in its place.
MAX_DOUBTS, MAX_MISSING = 2, 5
# Share of the known pixels above which a simultaneous change is a cut to another scene.
CUT_SHARE = 0.5


class FilteredMap(NamedTuple):
    """A filtered map, and whether another scene began with it."""

    disparity: DisparityMap
    cut: bool


@final
class Steady:
    """A temporal filter for the maps of one film.

    At each pixel, a value that differs little from the kept one is averaged with it; a value that differs more is
    adopted when the next one agrees, so that an error of one frame has no effect and no change leaves a trail. Where
    the value is unknown, the kept one stays for some frames. After two frames of which most pixels differ from the kept
    ones, the whole map is adopted: a cut.
    """

    def __init__(self) -> None:
        self._values = self._waiting = np.empty((0, 0), np.float32)
        self._doubts = np.empty((0, 0), np.uint8)
        self._gate = GATE_PX
        self._is_changed = False
        """True if most of the frame before differed from the kept values."""

    def next(self, disparity: DisparityMap) -> FilteredMap:
        """Filter the next map. The first one, and one of another size, is adopted as it is."""
        new = disparity.disparity_px
        if self._values.shape != new.shape:
            return self._restart(disparity, cut=self._values.size > 0)
        out, is_changed = self._step(new)
        if is_changed and self._is_changed:
            return self._restart(disparity, cut=True)
        self._is_changed = is_changed
        return FilteredMap(DisparityMap(out, disparity.confidence, disparity.unit), cut=False)

    def _restart(self, disparity: DisparityMap, cut: bool) -> FilteredMap:
        new = disparity.disparity_px
        self._values, self._waiting = new.copy(), np.full(new.shape, np.nan, np.float32)
        self._doubts = np.zeros(new.shape, np.uint8)
        self._gate, self._is_changed = _gate(disparity), False
        return FilteredMap(disparity, cut)

    def _step(self, new: Float32[np.ndarray, "h w"]) -> tuple[Float32[np.ndarray, "h w"], bool]:
        from . import steady_kernels

        out = np.empty_like(new)
        how = (np.float32(AVERAGED), np.float32(self._gate), MAX_DOUBTS, MAX_MISSING)
        changes, count = cast(Any, steady_kernels).step(new, self._values, self._waiting, self._doubts, out, *how)
        return out, changes > CUT_SHARE * count


def _gate(disparity: DisparityMap) -> float:
    """Return the threshold between noise and change, in the unit of this map."""
    if disparity.unit == "px":
        return GATE_PX
    values = disparity.disparity_px[np.isfinite(disparity.disparity_px)]
    return GATE_SHARE * float(np.ptp(values)) if values.size else GATE_SHARE


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

"""The interface of a video that is read in order or by time."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import NamedTuple, Self

import numpy as np

from ...data import Views
from ...data.pictures import size_in_words
from ...errors import PictureError

ViewsOf = Callable[[np.ndarray], Views]
"""A function from a stored picture to its views."""


class VideoFrame(NamedTuple):
    """A frame of a video."""

    number: int
    """Number of the frame, from 0; it goes on counting when the video starts again."""
    time_s: float
    """Time at which the frame is due, seconds after the first."""
    views: Views


class VideoFrames(ABC):
    """The frames of an open video: a context manager, for one reader in one thread.

    A faulty frame is reported once: the call that reads it raises, and the next call goes on after it.
    """

    def __init__(self, fps: float, views_of: ViewsOf) -> None:
        """fps: approximate frames a second. views_of: converts each picture."""
        self.fps: float = fps
        self.skipped = 0
        """Number of frames that were skipped because a later one was due, or because they were damaged."""
        self.size: tuple[int, int] | None = None
        """Shape (h, w) of each stored frame; None until the first frame decides it."""
        self.count: int | None = None
        """Number of frames that the file states; None if unknown."""
        self._views_of = views_of
        self._raised: set[str] = set()

    @property
    @abstractmethod
    def at_end(self) -> bool:
        """True if no frame is left."""

    @abstractmethod
    def next(self) -> VideoFrame | None:
        """Return the next frame in order, or the next one that a camera takes; None at the end.

        Raises: PictureError for a frame that cannot be read, or that differs in size from the first.
        """

    @abstractmethod
    def at(self, time_s: float) -> VideoFrame | None:
        """Return the latest frame that is due at this time, or a camera's newest; earlier frames are skipped.

        Returns: None at the end, or if no new frame is due. Times do not go back.
        Raises: PictureError as `next`.
        """

    @abstractmethod
    def close(self) -> None:
        """Close the source. A second call does nothing."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _frame(self, number: int, time_s: float, picture: np.ndarray, name: object) -> VideoFrame:
        """Make a frame of a picture. Raises: PictureError if its size differs from the first frame's."""
        self.size = self.size or picture.shape[:2]
        if picture.shape[:2] != self.size:
            first = size_in_words(np.empty(self.size, np.bool_))
            raise PictureError(
                f"{name}: is {size_in_words(picture)} and the first frame {first}; all frames of a video must be of "
                "one size"
            )
        return VideoFrame(number, time_s, self._views_of(picture))

    def _raise_once(self, kind: str, error: PictureError) -> None:
        """Raise an error, if none of its kind was raised before."""
        if kind not in self._raised:
            self._raised.add(kind)
            raise error

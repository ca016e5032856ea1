"""The frames of a video, one after the other or as they are due."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import NamedTuple, Self

import numpy as np

from ...data import Views
from ...data.pictures import size_in_words
from ...errors import PictureError

ViewsOf = Callable[[np.ndarray], Views]
"""A picture as the views that it holds."""


class VideoFrame(NamedTuple):
    """One frame of a video."""

    number: int
    """From 0, of the source; where a video begins again, numbers go on."""
    time_s: float
    """When it is due, from the first."""
    views: Views


class VideoFrames(ABC):
    """The frames of a video that was opened: a context manager, for one reader in one thread.

    What is wrong with a frame is said once: the call that comes upon it raises, and the next one goes on behind it.
    """

    def __init__(self, fps: float, views_of: ViewsOf) -> None:
        """fps: frames a second, about. views_of: what becomes of each picture."""
        self.fps = fps
        self.skipped = 0
        """Frames that were passed over, as a later one was due or they were damaged."""
        self.size: tuple[int, int] | None = None
        """(h, w) of each frame as it is stored; None until the first one came, which decides."""
        self.count: int | None = None
        """How many frames there are, as a file says; None where nobody knows."""
        self._views_of = views_of
        self._said: set[str] = set()

    @property
    @abstractmethod
    def ended(self) -> bool:
        """Whether no frame will come any more."""

    @abstractmethod
    def next(self) -> VideoFrame | None:
        """The next frame in order, of a camera the next that comes; None at the end.

        Raises: PictureError for one that cannot be read, or of another size than the first.
        """

    @abstractmethod
    def at(self, time_s: float) -> VideoFrame | None:
        """The latest frame that is due by then, of a camera the newest; those before it are skipped.

        None at the end, or where none is due that was not had before. Times do not go back.
        Raises: PictureError as `next`.
        """

    @abstractmethod
    def close(self) -> None:
        """Give back what is open. A second time does nothing."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _frame(self, number: int, time_s: float, picture: np.ndarray, name: object) -> VideoFrame:
        """Raises: PictureError for another size than the first frame's."""
        self.size = self.size or picture.shape[:2]
        if picture.shape[:2] != self.size:
            first = size_in_words(np.empty(self.size, np.bool_))
            raise PictureError(
                f"{name}: is {size_in_words(picture)} and the first frame {first}; all frames of a video must be of "
                "one size"
            )
        return VideoFrame(number, time_s, self._views_of(picture))

    def _say_once(self, kind: str, error: PictureError) -> None:
        """Raises: this error, where none of its kind was raised before."""
        if kind not in self._said:
            self._said.add(kind)
            raise error

"""What is drawn in a picture, found once: its ink, its texts and its lines."""

from functools import cached_property, lru_cache
from typing import final

import numpy as np

from ..data.records import digest_of
from .ink import Ink, find_ink
from .lines import Lines, find_lines
from .text import Texts, add_upward_texts, find_texts


@final
class Marks:
    """The ink, texts and lines of a picture, each found when it is first asked for."""

    def __init__(self, picture: np.ndarray) -> None:
        self.picture = picture
        self._digest = digest_of(picture)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Marks) and self._digest == other._digest

    def __hash__(self) -> int:
        return hash(self._digest)

    @cached_property
    def ink(self) -> Ink:
        """The ink of the picture."""
        return find_ink(self.picture)

    @cached_property
    def texts(self) -> Texts:
        """The texts in the ink."""
        return add_upward_texts(self.ink, find_texts(self.ink))

    @cached_property
    def lines(self) -> Lines:
        """The lines in the ink, without letters."""
        return find_lines(self.ink, self.texts.ink)


@lru_cache(maxsize=2)
def _remember(marks: Marks) -> Marks:
    return marks


def find_marks(picture: np.ndarray) -> Marks:
    """Return the ink, texts and lines of a picture; those of the last two pictures are remembered by their content."""
    return _remember(Marks(picture))

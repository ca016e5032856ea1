"""Texts in a picture: where each is, and what it says."""

from dataclasses import dataclass

from .records import Record


@dataclass(frozen=True, eq=False)
class PictureText(Record):
    """A text in a picture, by what it says and its place.

    box: left, top, right and bottom of the upright rectangle around it, as shares of the picture's width and height.
    direction_deg: the direction in which it is read, in degrees counterclockwise from the picture's right.

    >>> PictureText("nucleus", (0.4, 0.5, 0.6, 0.55)).middle
    (0.5, 0.525)
    """

    content: str
    box: tuple[float, float, float, float]
    direction_deg: float = 0.0

    @property
    def middle(self) -> tuple[float, float]:
        """The middle of its box, as shares of the picture's width and height."""
        left, top, right, bottom = self.box
        return (left + right) / 2, (top + bottom) / 2

    @property
    def is_level(self) -> bool:
        """Whether it runs from left to right and not upwards, as the titles of axes do."""
        return abs(self.direction_deg % 180 - 90) >= 45

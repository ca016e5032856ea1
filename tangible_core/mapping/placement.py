"""Points, motions and forces from the hand's frame to the picture's, and back.

The picture's point s lies under the hand at h = o + k R (s - c): k the scale, R the turn about z, c the point of the
picture that the hand finds at o. Forces are only turned, F_h = R F_s: a newton of the law is a newton on the hand.
"""

import math
from typing import NamedTuple

from ..data import Vector

QUARTERS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
"""Cosine and sine of the quarter turns, exactly."""


class Placement(NamedTuple):
    """A mapping in numbers; as an array, what the kernels take."""

    scale: float = 1.0
    """Hand metres per picture metre."""
    cos: float = 1.0
    sin: float = 0.0
    centre_x_m: float = 0.0
    centre_y_m: float = 0.0
    """The point of the picture that lies at the offset."""
    offset_x_m: float = 0.0
    offset_y_m: float = 0.0
    offset_z_m: float = 0.0
    reach_x_m: float = math.inf
    reach_y_m: float = math.inf
    reach_z_m: float = math.inf
    """How far from its centre the device may give force."""
    clutch: float = 0.0
    """The bits of the button that moves the picture."""

    def on_picture(self, hand_m: Vector) -> Vector:
        """The point of the picture at a point of the hand's space, where no clutch has moved the picture."""
        x, y, z = hand_m
        x, y = self.turned_back(x - self.offset_x_m, y - self.offset_y_m)
        return self.centre_x_m + x / self.scale, self.centre_y_m + y / self.scale, (z - self.offset_z_m) / self.scale

    def under_hand(self, picture_m: Vector) -> Vector:
        """Where the hand finds a point of the picture, where no clutch has moved the picture."""
        x, y, z = picture_m
        x, y = self.scale * (x - self.centre_x_m), self.scale * (y - self.centre_y_m)
        return (
            self.offset_x_m + self.cos * x - self.sin * y,
            self.offset_y_m + self.sin * x + self.cos * y,
            self.offset_z_m + self.scale * z,
        )

    def turned_back(self, x: float, y: float) -> tuple[float, float]:
        """A horizontal vector of the hand's space as the picture has it."""
        return self.cos * x + self.sin * y, self.cos * y - self.sin * x


def turn(degrees: float) -> tuple[float, float]:
    """Cosine and sine; exact for quarter turns.

    >>> turn(-90.0), turn(360.0)
    ((0.0, -1.0), (1.0, 0.0))
    """
    quarters, rest = divmod(degrees, 90.0)
    if rest == 0.0:
        return QUARTERS[int(quarters) % 4]
    return math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

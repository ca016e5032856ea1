"""Conversion of points, motions and forces between the frames of hand and picture."""

import math
from typing import NamedTuple

from ..data import Vector

QUARTERS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
"""Cosine and sine of the quarter turns, exactly."""


class Placement(NamedTuple):
    """A mapping in numbers, as the kernels take it."""

    scale: float = 1.0
    """Hand metres per picture metre."""
    cos: float = 1.0
    sin: float = 0.0
    centre_x_m: float = 0.0
    centre_y_m: float = 0.0
    """The point of the picture that lies at the offset, x and y."""
    offset_x_m: float = 0.0
    offset_y_m: float = 0.0
    offset_z_m: float = 0.0
    reach_x_m: float = math.inf
    reach_y_m: float = math.inf
    reach_z_m: float = math.inf
    """Half the sides, x, y and z, of the box about the device's centre in which force is allowed."""
    clutch: float = 0.0
    """The bit of the button that moves the picture; 0 for none."""

    def under_hand(self, picture_m: Vector) -> Vector:
        """Return the point of the hand at a point of the picture, if no clutch has moved the picture."""
        # h = o + k R (s - c): k the scale, R the rotation about z, c the point of the picture that the hand finds at o.
        # Forces are only rotated, F_h = R F_s: a newton of the force law is a newton on the hand.
        x, y, z = picture_m
        x, y = self.scale * (x - self.centre_x_m), self.scale * (y - self.centre_y_m)
        return (
            self.offset_x_m + self.cos * x - self.sin * y,
            self.offset_y_m + self.sin * x + self.cos * y,
            self.offset_z_m + self.scale * z,
        )

    def rotate_back(self, x: float, y: float) -> tuple[float, float]:
        """Rotate a horizontal vector from the hand's frame to the picture's."""
        return self.cos * x + self.sin * y, self.cos * y - self.sin * x


def turn(degrees: float) -> tuple[float, float]:
    """Return cosine and sine; exact for quarter turns.

    >>> turn(-90.0), turn(360.0)
    ((0.0, -1.0), (1.0, 0.0))
    """
    quarters, rest = divmod(degrees, 90.0)
    if rest == 0.0:
        return QUARTERS[int(quarters) % 4]
    return math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

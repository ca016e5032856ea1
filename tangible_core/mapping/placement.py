"""The mapping of points, motions and forces between hand and picture, and its block `mapping:` in a pipeline file."""

import math
from dataclasses import replace
from typing import Annotated, NamedTuple

from pydantic import Field

from ..data import DeviceSpec, Vector
from ..data.quantities import Quantities

QUARTERS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))  # cosine and sine of the quarter turns, exactly


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


Metres = Annotated[float, Field(ge=-10, le=10)]
Size = Annotated[float, Field(gt=0, le=10)]


class WorkspaceMapping(Quantities):
    """The mapping from hand to picture; without options they coincide."""

    scale: Annotated[float, Field(ge=1e-3, le=1e3)] | None = None
    """Hand movement per movement on the picture. By default 1, or, with `region_m`, what fits the region to the
    device's workspace."""
    region_m: tuple[Metres, Metres, Size, Size] | None = None
    """The part of the picture to feel: x and y of its centre from the picture's centre, width, length."""
    rotation_deg: Annotated[float, Field(ge=-360, le=360)] = 0.0
    """Rotation of the picture under the hand, counter-clockwise seen from above; multiples of 90 are exact."""
    offset_m: tuple[Metres, Metres, Metres] = (0.0, 0.0, 0.0)
    """Position in the device's workspace of the centre of the picture, or of the region, on the base plane."""
    clutch_button: Annotated[int, Field(ge=0, le=31)] | None = None
    """Button (the first is 0) that, while held, switches the force off and moves the picture sideways with the hand."""
    limits_m: tuple[Size, Size, Size] | None = None
    """Size along x, y, z of a box about the device's centre; outside it there is no force."""

    def placement(self, workspace_m: Vector) -> Placement:
        """Return the mapping in numbers, for a device of this workspace."""
        cos, sin = turn(self.rotation_deg)
        x, y, width, length = self.region_m or (0.0, 0.0, 0.0, 0.0)
        scale = self.scale or 1.0
        if self.region_m and self.scale is None:
            across, along = abs(cos) * width + abs(sin) * length, abs(sin) * width + abs(cos) * length
            scale = min(workspace_m[0] / across, workspace_m[1] / along)
        sides = self.limits_m or (math.inf, math.inf, math.inf)
        reach = sides[0] / 2, sides[1] / 2, sides[2] / 2
        clutch = 0 if self.clutch_button is None else 1 << self.clutch_button
        return Placement(scale, cos, sin, x, y, *self.offset_m, *reach, float(clutch))

    def spec_on_picture(self, spec: DeviceSpec) -> DeviceSpec:
        """Return the device's specification in metres of the picture and newtons of the hand."""
        place = self.placement(spec.workspace_m)
        x, y, z = spec.workspace_m
        cos, sin = abs(place.cos), abs(place.sin)
        return replace(
            spec,
            workspace_m=((cos * x + sin * y) / place.scale, (sin * x + cos * y) / place.scale, z / place.scale),
            resolution_m=spec.resolution_m / place.scale,
            max_stiffness_n_per_m=spec.max_stiffness_n_per_m * place.scale,
            damping_n_s_per_m=spec.damping_n_s_per_m * place.scale,
        )

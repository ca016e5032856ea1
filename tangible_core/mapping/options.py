"""The block `mapping:` of a pipeline file."""

import math
from dataclasses import replace
from typing import Annotated

from pydantic import Field

from ..data import DeviceSpec, Vector
from ..data.quantities import Quantities
from .placement import Placement, turn

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

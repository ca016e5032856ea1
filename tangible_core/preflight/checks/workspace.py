"""The check that the device reaches all of the surface."""

from collections.abc import Iterator

from ..flight import Flight
from ..verdict import Change, Verdict, check_bound, under
from .cures import flatten

SOURCE = "the device's workspace"


def workspace(flight: Flight) -> Iterator[Verdict]:
    """Check width, length and height of the surface against the device's reach along x, y and z."""
    reach_x, reach_y, reach_z = flight.spec.workspace_m
    width_m, length_m = flight.surface.extent_m
    for of, size_m, reach_m in (("width", width_m, reach_x), ("length", length_m, reach_y)):
        narrower = under(width_m * reach_m / size_m)
        yield check_bound(
            *("workspace", of, size_m, "<=", reach_m, "m", SOURCE),
            says=f"the surface has more {of} than the device reaches",
            cure=[Change("workspace.width_m", narrower, "at most"), "; or the borders cannot be reached"],
        )
    height_m = float(flight.surface.height_m.max())
    yield check_bound(
        *("workspace", "height", height_m, "<=", reach_z, "m", SOURCE),
        says="the surface is higher than the device reaches",
        cure=[flatten(flight, reach_z / max(height_m, reach_z))],
    )

"""Checks of the device: plausible damping, known friction, and the reach of its workspace."""

from collections.abc import Iterator

from ..flight import Flight
from ..verdict import Verdict, check_bound, under
from .cures import flatten, narrow

REACH = "the device's workspace"


def damping(flight: Flight) -> Iterator[Verdict]:
    """Check that the device's damping, on which the limit of stiffness rests, is plausible.

    Makers' tables give the damping that a device can display: more than its greatest stiffness at 1 kHz implies.
    """
    stated, taken = flight.spec.damping_n_s_per_m, flight.damping_n_s_per_m
    known = flight.spec.simulated or 0 < stated <= taken
    note = "" if stated == taken else f"{stated:g} N s/m stated; its stiffness at 1 kHz implies no more than this"
    cure = "" if known else "a guess: start at half the stiffness, and raise it for as long as nothing buzzes"
    says = "" if known else "how well the device damps is a guess"
    source = "simulated" if flight.spec.simulated else "the device's specification"
    yield Verdict(
        *("device", "damping", "ok" if known else "warn", taken, "N s/m"),
        source=source,
        note=note,
        cure=cure,
        says=says,
    )


def friction(flight: Flight) -> Iterator[Verdict]:
    """Check that the handle's friction is known, which keeps the steps of its encoders from buzzing."""
    friction_n = flight.settings.safety.friction_n
    known = flight.spec.simulated or friction_n is not None
    cure = "" if known else "unknown: measure the force at which the handle starts to move, `safety.friction_n: ...`"
    source = "simulated" if flight.spec.simulated else "`safety.friction_n`" if known else ""
    says = "" if known else "the friction of the device's handle is unknown"
    yield Verdict(
        *("device", "friction", "ok" if known else "warn", friction_n or 0.0, "N"), source=source, cure=cure, says=says
    )


def workspace(flight: Flight) -> Iterator[Verdict]:
    """Check width, length and height of the surface against the device's reach along x, y and z."""
    reach_x, reach_y, reach_z = flight.spec.workspace_m
    width_m, length_m = flight.surface.extent_m
    for of, size_m, reach_m in (("width", width_m, reach_x), ("length", length_m, reach_y)):
        narrower = under(width_m * reach_m / size_m)
        yield check_bound(
            *("workspace", of, size_m, "<=", reach_m, "m", REACH),
            says=f"the surface has more {of} than the device reaches",
            cure=[narrow(flight, narrower), "; or the borders cannot be reached"],
        )
    height_m = float(flight.surface.height_m.max())
    yield check_bound(
        *("workspace", "height", height_m, "<=", reach_z, "m", REACH),
        says="the surface is higher than the device reaches",
        cure=[flatten(flight, reach_z / max(height_m, reach_z))],
    )

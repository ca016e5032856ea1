"""Checks of the device's specification: known values and guesses."""

from collections.abc import Iterator

from ..flight import Flight
from ..verdict import Verdict


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
    friction_n = flight.safety.friction_n
    known = flight.spec.simulated or friction_n is not None
    cure = "" if known else "unknown: measure the force at which the handle starts to move, `safety.friction_n: ...`"
    source = "simulated" if flight.spec.simulated else "`safety.friction_n`" if known else ""
    says = "" if known else "the friction of the device's handle is unknown"
    yield Verdict(
        *("device", "friction", "ok" if known else "warn", friction_n or 0.0, "N"), source=source, cure=cure, says=says
    )

"""The checks, one topic a file: functions from a flight to verdicts."""

from collections.abc import Callable, Iterable

from ..flight import Flight
from ..preflight import Preflight
from ..verdict import Verdict
from .device import damping, friction, lateness, tick_cost, workspace
from .features import features, textures
from .slopes import cliffs, clipping, contact, slope_stiffness
from .stiffness import law_damping, law_stiffness, material_stiffness, quantisation

Check = Callable[[Flight], Iterable[Verdict]]

CHECKS: tuple[Check, ...] = (
    *(damping, friction),
    *(law_stiffness, material_stiffness, law_damping, quantisation),
    *(slope_stiffness, cliffs),
    *(clipping, contact),
    *(textures, features, workspace),
    *(lateness, tick_cost),
)


def judge(flight: Flight) -> Preflight:
    """Run every check in order; return the verdicts, with cures that agree with each other."""
    return Preflight.of(verdict for check in CHECKS for verdict in check(flight))

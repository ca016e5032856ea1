"""Checks before a motor moves: of the surface, the force law, the device and this machine; a verdict a line."""

from .checks import CHECKS, judge
from .fitting import fit_surface
from .flight import Flight, Hand, Loop
from .preflight import Preflight
from .survey import survey
from .timing import PERCENTILES
from .verdict import Change, Verdict
from .wording import relation

__all__ = [
    "CHECKS",
    "PERCENTILES",
    "Change",
    "Flight",
    "Hand",
    "Loop",
    "Preflight",
    "Verdict",
    "fit_surface",
    "judge",
    "relation",
    "survey",
]

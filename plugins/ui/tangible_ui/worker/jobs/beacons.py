"""A job that makes a beacon: the pull to a part of the surface that is felt, as the force loop takes it."""

from pathlib import Path
from typing import Any

from tangible_core.data import HapticSurface
from tangible_core.errors import ConfigError
from tangible_core.servo import beacon_to, parcel

from ..state import Bench, Job
from ..view.surface_view import at_hand


def beacon(bench: Bench, text: str, path: Path, sets: list[str], part: int) -> dict[str, Any]:
    """A beacon to a part of the document's surface, by its number, in a parcel. Raises: ConfigError without one."""
    surface: HapticSurface | None = at_hand(bench.pipeline_of(text, path, sets), "surface")
    if surface is None:
        raise ConfigError("the surface of this document is not made yet; make it, and a beacon leads to its parts")
    made = beacon_to(surface, part)
    return {"part": made.part, "name": made.name, "parcel": str(parcel.pack(made))}


JOBS = {"beacon": Job(beacon, quick=True)}

"""A session joins a touch and a device: the loop, and what it records."""

from .beside import beside
from .following import EVERY, Followed, Looks, followed
from .in_turn import Turn, run_in_turn
from .keeper import Keeper
from .limited import changed_most
from .live import figures, keeping, run_in_real_time
from .loop import run_simulated
from .parts_felt import (
    BeaconFelt,
    PartFelt,
    beacons_felt,
    called,
    material_under,
    materials_text,
    names_in,
    names_of,
    names_text,
    part_under,
    parts_felt,
    telling_parts,
)
from .recording import INTERRUPTED, STOPPED, Recording, failure
from .recording_files import check_record_path
from .replay import compared, replay, undisturbed
from .tick_file import About
from .writer import Writer

__all__ = [
    "EVERY",
    "INTERRUPTED",
    "STOPPED",
    "About",
    "BeaconFelt",
    "Followed",
    "Keeper",
    "Looks",
    "PartFelt",
    "Recording",
    "Turn",
    "Writer",
    "beacons_felt",
    "beside",
    "called",
    "changed_most",
    "check_record_path",
    "compared",
    "failure",
    "figures",
    "followed",
    "keeping",
    "material_under",
    "materials_text",
    "names_in",
    "names_of",
    "names_text",
    "part_under",
    "parts_felt",
    "replay",
    "run_in_real_time",
    "run_in_turn",
    "run_simulated",
    "telling_parts",
    "undisturbed",
]

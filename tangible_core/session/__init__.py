"""A session joins a touch and a device: the loop, and what it records."""

from .beside import compare_recordings
from .following import EVERY, TickSampler, TrackingError, tracking_error
from .in_turn import Slot, run_kiosk
from .keeper import RingDrain
from .limited import guard_summary
from .live import figures, keeping, run_in_real_time
from .loop import run_simulated
from .parts_felt import (
    BeaconFelt,
    PartFelt,
    beacons_felt,
    material_under,
    materials_text,
    names_in,
    names_of,
    names_text,
    part_label,
    part_under,
    parts_felt,
    with_parts,
)
from .recording import INTERRUPTED, STOPPED, Recording, failure
from .recording_files import check_record_path
from .replay import compare_replay, replay, unaltered_forces
from .tick_file import About
from .writer import Writer

beside, Keeper, Turn, run_in_turn = compare_recordings, RingDrain, Slot, run_kiosk
"""Former names of these four."""

__all__ = [
    "EVERY",
    "INTERRUPTED",
    "STOPPED",
    "About",
    "BeaconFelt",
    "PartFelt",
    "Recording",
    "RingDrain",
    "Slot",
    "TickSampler",
    "TrackingError",
    "Writer",
    "beacons_felt",
    "check_record_path",
    "compare_recordings",
    "compare_replay",
    "failure",
    "figures",
    "guard_summary",
    "keeping",
    "material_under",
    "materials_text",
    "names_in",
    "names_of",
    "names_text",
    "part_label",
    "part_under",
    "parts_felt",
    "replay",
    "run_in_real_time",
    "run_kiosk",
    "run_simulated",
    "tracking_error",
    "unaltered_forces",
    "with_parts",
]

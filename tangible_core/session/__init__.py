"""A session joins a touch and a device: the loop, and what it records."""

from .guard_summary import guard_summary
from .kiosk import Slot, run_kiosk
from .live import RingDrain, figures, keeping, run_in_real_time
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
from .recording.comparison import compare_recordings
from .recording.files import check_record_path
from .recording.replay import compare_replay, replay, unaltered_forces
from .recording.tick_file import About
from .recording.writer import Writer
from .simulated import run_simulated
from .tracking_error import EVERY, TickSampler, TrackingError, tracking_error

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

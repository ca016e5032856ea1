"""The data that travels between stages: frozen records of read-only arrays, and the tuples of the force loop."""

from .device import NO_FORCE, DeviceSpec, Finding, Force, HapticState, Unit, Vector, limited
from .outcome import Kind, Note, NoteKind, Outcome, OutcomeKind, Outcomes, Plan
from .products import Work
from .records import Record, digest_of
from .surface import TEXTURES, HapticSurface, Material, MaterialMap, Relief, Texture
from .ticks import TICK_COLUMNS, UNTOUCHED, FilmFelt, ServoReport, Spread, TickFlag, beacon_part
from .views import Calibration, DisparityMap, PartMap, SegmentMap, SegmentTree, Views

__all__ = [
    "Calibration", "DeviceSpec", "DisparityMap", "FilmFelt", "Finding", "Force", "HapticState", "HapticSurface",
    "Kind", "Material", "MaterialMap", "NO_FORCE", "Note", "NoteKind", "Outcome", "OutcomeKind", "Outcomes",
    "PartMap", "Plan", "Record", "Relief", "SegmentMap", "SegmentTree", "ServoReport", "Spread", "TEXTURES",
    "TICK_COLUMNS", "Texture", "TickFlag", "UNTOUCHED", "Unit", "Vector", "Views", "Work", "beacon_part", "digest_of",
    "limited",
]  # fmt: skip

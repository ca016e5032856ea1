"""A session joins a touch and a device: the loop, and what it records."""

from .live import feel, figures, keeping
from .loop import limited, run
from .recording import INTERRUPTED, Recording, failure
from .recording_files import check_record_path
from .rehearsal import FELT, rehearsal
from .replay import replay, undisturbed
from .tick_file import About
from .writer import Writer

__all__ = [
    "FELT",
    "INTERRUPTED",
    "About",
    "Recording",
    "Writer",
    "check_record_path",
    "failure",
    "feel",
    "figures",
    "keeping",
    "limited",
    "rehearsal",
    "replay",
    "run",
    "undisturbed",
]

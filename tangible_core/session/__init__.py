"""A session joins a touch and a device: the loop, and what it records."""

from .live import feel, figures, keeping
from .loop import run
from .recording import INTERRUPTED, Recording, failure
from .recording_files import check_record_path
from .replay import replay, undisturbed
from .tick_file import About
from .writer import Writer

__all__ = [
    "INTERRUPTED",
    "About",
    "Recording",
    "Writer",
    "check_record_path",
    "failure",
    "feel",
    "figures",
    "keeping",
    "replay",
    "run",
    "undisturbed",
]

"""A session joins a touch and a device: the loop, and what it records."""

from .loop import limited, run
from .recording import INTERRUPTED, Recording, check_record_path, failure
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
    "limited",
    "replay",
    "run",
    "undisturbed",
]

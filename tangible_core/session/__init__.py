"""A session joins a touch and a device: the loop, and what it records."""

from .loop import limited, run
from .recording import INTERRUPTED, Recording, check_record_path, failure

__all__ = ["INTERRUPTED", "Recording", "check_record_path", "failure", "limited", "run"]

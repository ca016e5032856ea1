"""Recordings: in memory and in files, written during a session, replayed, and compared."""

from .recording import INTERRUPTED, STOPPED, Recording, failure

__all__ = ["INTERRUPTED", "STOPPED", "Recording", "failure"]

"""A device fed from outside the process: positions in, forces out, over a file in shared memory."""

from .client import PointerClient

__all__ = ["PointerClient"]

"""Files that no reader of text can read, each with the reason that it gives."""

from collections.abc import Iterator
from pathlib import Path


def unreadable(folder: Path, suffix: str) -> Iterator[tuple[Path, str]]:
    """Yield the folder itself, and a file of this suffix in it whose bytes are no text."""
    grey = folder / f"grey{suffix}"
    grey.write_bytes(b"\xff\n")
    yield folder, "it is not a file but a folder or a device"
    yield grey, "'utf-8' codec can't decode byte 0xff in position 0: invalid start byte"

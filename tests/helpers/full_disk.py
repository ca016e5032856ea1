"""A disk that runs full, without one; and files that no reader of text can read, each with the reason that it gives."""

import resource
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def files_up_to(size: int) -> Generator[None]:
    """No file of this process grows beyond so many bytes."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def unreadable(folder: Path, suffix: str) -> Iterator[tuple[Path, str]]:
    """Yield the folder itself, and a file of this suffix in it whose bytes are no text."""
    grey = folder / f"grey{suffix}"
    grey.write_bytes(b"\xff\n")
    yield folder, "it is not a file but a folder or a device"
    yield grey, "'utf-8' codec can't decode byte 0xff in position 0: invalid start byte"

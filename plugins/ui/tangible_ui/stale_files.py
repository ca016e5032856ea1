"""Temporary files of this process, and removal of those of dead processes: their names contain the process's number."""

import os
import re
import shutil
import tempfile
from collections.abc import Generator, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from tangible_core.errors import OutputError
from tangible_core.runtime.system import is_alive, is_mine
from tangible_devices.pointer.channel import channel_path

PREFIX = "tangible-ui-"
CHANNEL = "ui-"
NUMBER = re.compile(r"(?:.*-)?([0-9]{1,9})(?:-[\w.]+|\.\w+)")


@contextmanager
def folder_of_this_process() -> Generator[Path]:
    """Make an empty folder for what pages fetch; remove those of servers that were killed. Raises: OutputError."""
    try:
        for path in left_in(Path(tempfile.gettempdir()), f"{PREFIX}*"):
            shutil.rmtree(path, ignore_errors=True)
        folder = Path(tempfile.mkdtemp(prefix=f"{PREFIX}{os.getpid()}-"))
    except OSError as error:
        raise OutputError(f"no temporary folder can be made: {error.strerror or error}; name one in TMPDIR") from error
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def channel_of_this_process() -> Generator[str]:
    """Yield the channel of the page's pointer; remove its files at the end, now those of killed servers."""
    name = f"{CHANNEL}{os.getpid()}"
    folder = channel_path(name).parent
    for path in left_in(folder, f"{CHANNEL}*"):
        path.unlink(missing_ok=True)
    try:
        yield name
    finally:
        for path in [*folder.glob(f"{name}.*"), *folder.glob(f"{name}-*")]:
            path.unlink(missing_ok=True)


def left_in(folder: Path, pattern: str) -> Iterator[Path]:
    """Yield this user's files and folders of that pattern whose process is dead."""
    for path in sorted(folder.glob(pattern)):
        with suppress(OSError):
            number = NUMBER.fullmatch(path.name)
            if number and is_mine(path) and not is_alive(int(number[1])):
                yield path

"""What processes of this user that are gone left behind: named with the number of the process, as a ring is."""

import os
import re
import shutil
import tempfile
from collections.abc import Generator, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from tangible_core.errors import OutputError
from tangible_core.runtime.child_process import is_alive
from tangible_devices.pointer.channel import channel_path

PREFIX = "tangible-ui-"
CHANNEL = "ui-"
NUMBER = re.compile(r"(?:.*-)?([0-9]{1,9})(?:-[\w.]+|\.\w+)")


@contextmanager
def folder_of_this_process() -> Generator[Path]:
    """A folder for what pages fetch, empty, for this user alone; those of servers that were killed go.

    Raises: OutputError if there is no room for it.
    """
    try:
        for each in left_in(Path(tempfile.gettempdir()), f"{PREFIX}*"):
            shutil.rmtree(each, ignore_errors=True)
        folder = Path(tempfile.mkdtemp(prefix=f"{PREFIX}{os.getpid()}-"))
    except OSError as error:
        raise OutputError(f"no temporary folder can be made: {error.strerror or error}; name one in TMPDIR") from error
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@contextmanager
def channel_of_this_process() -> Generator[str]:
    """The name of the page's own pointer; its files go at the end, and so do those of servers that were killed.

    Raises: DeviceError if the folder for them is somebody else's.
    """
    name = f"{CHANNEL}{os.getpid()}"
    folder = channel_path(name).parent
    for each in left_in(folder, f"{CHANNEL}*"):
        each.unlink(missing_ok=True)
    try:
        yield name
    finally:
        for each in [*folder.glob(f"{name}.*"), *folder.glob(f"{name}-*")]:
            each.unlink(missing_ok=True)


def left_in(folder: Path, pattern: str) -> Iterator[Path]:
    """This user's files and folders of that name whose process is gone; none where that cannot be known."""
    for path in sorted(folder.glob(pattern)):
        with suppress(OSError):
            named = NUMBER.fullmatch(path.name)
            ours = hasattr(os, "getuid") and not path.is_symlink() and path.stat().st_uid == os.getuid()
            if named and ours and not is_alive(int(named[1])):
                yield path

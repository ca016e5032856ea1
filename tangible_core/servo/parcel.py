"""Parcels: objects with large arrays, passed to another process through shared memory without a copy there."""

import mmap
import os
import pickle
import tempfile
from pathlib import Path
from typing import Any

from ..errors import DeviceError
from ..runtime.child_process import dumps
from .ring import ALIGN, NAME, PREFIX, shared_folder


def pack(thing: Any) -> Path:
    """Write an object to a file, which `unpack` deletes again; return the file's path.

    Raises: DeviceError if there is no room, or if the object cannot be sent to another process.
    """
    buffers: list[pickle.PickleBuffer] = []
    try:
        small = dumps(thing, buffers.append)
    except Exception as error:
        raise DeviceError(
            f"a {type(thing).__name__} cannot be sent to the force loop's process ({error}); make it picklable"
        ) from error
    folder = shared_folder()
    number, name = tempfile.mkstemp(".parcel", f"{PREFIX}{os.getpid()}-", folder)
    try:
        with os.fdopen(number, "wb") as file:
            for part in (small, *(buffer.raw() for buffer in buffers)):
                file.write(len(part).to_bytes(8, "little").ljust(ALIGN, b"\0"))
                file.write(part)
                file.write(bytes(-file.tell() % ALIGN))
    except OSError as error:
        Path(name).unlink(missing_ok=True)
        raise DeviceError(f"{folder}: no room to pass on the scene: {error.strerror or error}") from error
    return Path(name)


def adopt(path: Path) -> Path:
    """Rename a file of `pack` to this process: it is deleted as stale once this process is gone, not its maker.

    Raises: DeviceError if the file does not exist any more, or is not a parcel.
    """
    named = NAME.fullmatch(path.name)
    if named is None or named[2] != "parcel":
        raise DeviceError(f"{path}: is not the file of a packed scene; give the file that `pack_touch` made")
    mine = path.with_name(f"{PREFIX}{os.getpid()}{path.name[named.end(1) :]}")
    try:
        return path.rename(mine)
    except OSError as error:
        raise DeviceError(f"{path}: the packed scene is missing ({error.strerror}); make it again") from error


def unpack(path: Path) -> Any:
    """Load the object from a file of `pack` and delete the file; its memory lasts as long as the object's arrays."""
    mapped = _map(path)
    path.unlink()
    return _load(mapped)


def share(path: Path) -> Any:
    """Load the object from a file of `pack`, which stays: the process that unpacks it later shares its arrays."""
    return _load(_map(path))


def _map(path: Path) -> memoryview:
    with path.open("r+b") as file:
        return memoryview(mmap.mmap(file.fileno(), 0))


def _load(mapped: memoryview) -> Any:
    parts: list[memoryview] = []
    at = 0
    while at < len(mapped):
        length = int.from_bytes(mapped[at : at + 8], "little")
        at += ALIGN
        parts.append(mapped[at : at + length])
        at += -(-length // ALIGN) * ALIGN
    return pickle.loads(parts[0], buffers=parts[1:])

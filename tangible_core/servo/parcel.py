"""Objects with large arrays, passed to another process through shared memory: there, nothing is copied."""

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
    """Write a thing to a file that `unpack` takes away again.

    Raises: DeviceError if there is no room, or if the thing cannot be sent to another process.
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
        raise DeviceError(f"{folder}: no room to hand over the scene: {error.strerror or error}") from error
    return Path(name)


def adopted(path: Path) -> Path:
    """The file of `pack` under a name of this process: it is swept away when this process is gone, not its maker.

    Raises: DeviceError if it is not there any more, or is no such file.
    """
    named = NAME.fullmatch(path.name)
    if named is None or named[2] != "parcel":
        raise DeviceError(f"{path}: is not the file of a packed scene; give the one that `packed` made")
    mine = path.with_name(f"{PREFIX}{os.getpid()}{path.name[named.end(1) :]}")
    try:
        return path.rename(mine)
    except OSError as error:
        raise DeviceError(f"{path}: the packed scene is not there ({error.strerror}); make it again") from error


def unpack(path: Path) -> Any:
    """The thing in a file of `pack`; its arrays are the file's own memory, which lasts as long as they do."""
    mapped = _mapped(path)
    path.unlink()
    return _thing(mapped)


def shared(path: Path) -> Any:
    """The thing in a file of `pack`, which stays there: its arrays are the memory of whoever unpacks it as well."""
    return _thing(_mapped(path))


def _mapped(path: Path) -> memoryview:
    with path.open("r+b") as file:
        return memoryview(mmap.mmap(file.fileno(), 0))


def _thing(mapped: memoryview) -> Any:
    parts: list[memoryview] = []
    at = 0
    while at < len(mapped):
        length = int.from_bytes(mapped[at : at + 8], "little")
        at += ALIGN
        parts.append(mapped[at : at + length])
        at += -(-length // ALIGN) * ALIGN
    return pickle.loads(parts[0], buffers=parts[1:])

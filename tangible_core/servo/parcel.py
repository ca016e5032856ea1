"""Parcels: objects with large arrays, passed to another process through shared memory without a copy there."""

import pickle
from pathlib import Path
from typing import Any

from ..errors import DeviceError
from ..runtime.child_process import dumps
from ..runtime.system import shared_memory
from ..runtime.system.shared_memory import NAME, shared_folder
from .ring import ALIGN


def pack(thing: Any) -> Path:
    """Write an object to shared memory, which `unpack` removes again; return its name, a path.

    Raises: DeviceError if there is no room, or if the object cannot be sent to another process.
    """
    buffers: list[pickle.PickleBuffer] = []
    try:
        small = dumps(thing, buffers.append)
    except Exception as error:
        raise DeviceError(
            f"a {type(thing).__name__} cannot be sent to the force loop's process ({error}); make it picklable"
        ) from error
    pieces: list[bytes | memoryview] = []
    for part in (small, *(buffer.raw() for buffer in buffers)):
        pieces += [len(part).to_bytes(8, "little").ljust(ALIGN, b"\0"), part, bytes(-len(part) % ALIGN)]
    try:
        return shared_memory.write("parcel", pieces)
    except OSError as error:
        raise DeviceError(f"{shared_folder()}: no room to pass on the scene: {error.strerror or error}") from error


def adopt(path: Path) -> Path:
    """Take over the memory of `pack`, and return its name here: it lasts as long as this process, not its maker.

    Raises: DeviceError if the memory does not exist any more, or is not a parcel.
    """
    named = NAME.fullmatch(path.name)
    if named is None or named[2] != "parcel":
        raise DeviceError(f"{path}: is not the file of a packed scene; give the file that `pack_touch` made")
    try:
        return shared_memory.adopt(path)
    except OSError as error:
        raise DeviceError(f"{path}: the packed scene is missing ({error.strerror}); make it again") from error


def unpack(path: Path) -> Any:
    """Load the object from the memory of `pack` and remove its name; the memory lasts as long as the arrays in it.

    Raises: OSError if there is no such memory any more.
    """
    mapped = shared_memory.attach(path)
    shared_memory.remove(path)
    return _load(mapped)


def share(path: Path) -> Any:
    """Load the object from the memory of `pack`, which stays: who unpacks it later shares its arrays."""
    return _load(shared_memory.attach(path))


def exists(path: Path) -> bool:
    """Return True if the memory of `pack` was neither unpacked nor discarded."""
    return shared_memory.exists(path)


def discard(path: Path) -> None:
    """Remove the memory of `pack`, if nobody has unpacked it."""
    shared_memory.remove(path)


def _load(mapped: memoryview) -> Any:
    parts: list[memoryview] = []
    at = 0
    while at < len(mapped):
        length = int.from_bytes(mapped[at : at + 8], "little")
        at += ALIGN
        parts.append(mapped[at : at + length])
        at += -(-length // ALIGN) * ALIGN
    return pickle.loads(parts[0], buffers=parts[1:])

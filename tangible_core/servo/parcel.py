"""Parcels: objects with large arrays, passed to another process through shared memory without a copy there."""

import pickle
from pathlib import Path
from typing import Any, NoReturn, final

from ..data import DeviceSpec, HapticState
from ..errors import DeviceError
from ..plugins.interfaces import Film, Touch, as_touch
from ..runtime.child_process import dumps
from ..runtime.system import shared_memory
from ..runtime.system.shared_memory import NAME, shared_folder
from .guard.stiffness import find_stiffness
from .ring import ALIGN


def pack(thing: Any) -> Path:
    """Write an object to shared memory, which `unpack` removes again; return its name, a path."""
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
    """Take over the memory of `pack`, and return its name here: it lasts as long as this process, not its maker."""
    match = NAME.fullmatch(path.name)
    if match is None or match[2] != "parcel":
        raise DeviceError(f"{path}: is not the file of a packed scene; give the file that `pack_touch` made")
    try:
        return shared_memory.adopt(path)
    except OSError as error:
        raise DeviceError(f"{path}: the packed scene is missing ({error.strerror}); make it again") from error


def unpack(path: Path) -> Any:
    """Load the object from the memory of `pack` and remove its name; the memory lasts as long as the arrays in it."""
    memory = shared_memory.attach(path)
    shared_memory.remove(path)
    return _load(memory)


def share(path: Path) -> Any:
    """Load the object from the memory of `pack`, which stays: who unpacks it later shares its arrays."""
    return _load(shared_memory.attach(path))


def _load(memory: memoryview) -> Any:
    parts: list[memoryview] = []
    at = 0
    while at < len(memory):
        length = int.from_bytes(memory[at : at + 8], "little")
        at += ALIGN
        parts.append(memory[at : at + length])
        at += -(-length // ALIGN) * ALIGN
    return pickle.loads(parts[0], buffers=parts[1:])


@final
class Packed(Touch):
    """A touch in a parcel (`pack`) for a `Servo`; it becomes the touch itself in the loop's process.

    The parcel belongs to this process from now on: while this process lives, it is not deleted, even if the process
    that packed it ends; once this process is gone, the next start of a loop deletes it. It can be used once: a loop,
    by `Servo` or by its `swap`, consumes the parcel, even if that fails. A parcel that is given to no loop must be
    discarded.
    """

    def __init__(self, path: Path | str, stiffness_n_per_m: float) -> None:
        """Adopt the parcel of the `Packed` that `pack_touch` returned in the process that made the touch."""
        self.stiffness_n_per_m: float | None = float(stiffness_n_per_m)
        self.parcel: Path = adopt(Path(path))
        """The file, renamed to this process."""
        self.film: Film | None = None
        """The film, if the touch is one, in the process that packed it: reliefs shown here move the surface there."""

    def __reduce__(self) -> tuple[Any, ...]:
        return unpack, (self.parcel,)

    def force(self, state: HapticState) -> NoReturn:
        """Raise DeviceError, always."""
        raise DeviceError("a packed touch has forces only in the loop's process; ask the touch that was packed")

    def path(self, positions_m: Any, period_s: float = 0.001) -> NoReturn:
        """Raise DeviceError, always."""
        raise DeviceError("a packed touch has a path only in the loop's process; ask the touch that was packed")

    def unused_parcel(self) -> Path:
        """Return the parcel, for a loop. Raises: DeviceError if a loop has consumed it, or it was discarded."""
        if not shared_memory.exists(self.parcel):
            raise DeviceError("this packed touch was already used or discarded; pack a new one")
        return self.parcel

    def discard(self) -> None:
        """Delete the parcel, if no loop has; a second call does nothing."""
        shared_memory.remove(self.parcel)


def pack_touch(touch: Touch | Film, spec: DeviceSpec) -> Packed:
    """Pack a touch into a parcel, with its stated or measured stiffness; takes some seconds at most.

    Another process makes its own `Packed` of `str(parcel)` and `stiffness_n_per_m`; until then, the parcel is deleted
    if this process ends. If the touch is a film, `Packed.film` shows reliefs from here, whichever process feels it.
    spec: of the device on which the touch will act.
    Raises: DeviceError if there is no room, or the touch cannot be sent; BrokenMethod for an invalid stiffness.
    """
    stiffness = find_stiffness(as_touch(touch), spec).n_per_m
    parcel_touch = Packed(pack(touch), stiffness)
    parcel_touch.film = share(parcel_touch.parcel) if isinstance(touch, Film) else None
    return parcel_touch

"""A packed touch: made in one process, passed on by the host, and read only in the loop's process.

The process that makes the touch may take long, and may end at any moment. The host imports no kernels, and so spends
neither time nor memory on them: of the touch it has the name of a file and a stiffness.
"""

from pathlib import Path
from typing import Any, NoReturn, final

from ..data import DeviceSpec, HapticState
from ..errors import DeviceError
from ..plugins.interfaces import Film, Touch, touch_of
from . import parcel
from .guard.stiffness import stiffness_of


@final
class Packed(Touch):
    """A touch in a parcel (`parcel.pack`) for a `Servo`; it becomes the touch itself in the loop's process.

    The parcel belongs to this process from now on: while this process lives, it is not deleted, even if the process
    that packed it ends; once this process is gone, the next start of a loop deletes it. It can be used once: a loop,
    by `Servo` or by its `swap`, consumes the parcel, even if that fails. A parcel that is given to no loop must be
    discarded.
    """

    def __init__(self, path: Path | str, stiffness_n_per_m: float) -> None:
        """Adopt a parcel.

        path, stiffness_n_per_m: those of the `Packed` that `pack_touch` returned in the process that made the touch.
        Raises: DeviceError if the parcel does not exist any more, or is not a parcel.
        """
        self.stiffness_n_per_m: float | None = float(stiffness_n_per_m)
        self.parcel: Path = parcel.adopt(Path(path))
        """The file, renamed to this process."""
        self.film: Film | None = None
        """The film, if the touch is one, in the process that packed it: reliefs shown here move the surface there."""

    def __reduce__(self) -> tuple[Any, ...]:
        return parcel.unpack, (self.parcel,)

    def force(self, state: HapticState) -> NoReturn:
        """Raise DeviceError, always."""
        raise DeviceError("a packed touch has forces only in the loop's process; ask the touch that was packed")

    def path(self, positions_m: Any, period_s: float = 0.001) -> NoReturn:
        """Raise DeviceError, always."""
        raise DeviceError("a packed touch has a path only in the loop's process; ask the touch that was packed")

    def unused_parcel(self) -> Path:
        """Return the parcel, for a loop. Raises: DeviceError if a loop has consumed it, or it was discarded."""
        if not parcel.exists(self.parcel):
            raise DeviceError("this packed touch was already used or discarded; pack a new one")
        return self.parcel

    def discard(self) -> None:
        """Delete the parcel, if no loop has; a second call does nothing."""
        parcel.discard(self.parcel)


def pack_touch(touch: Touch | Film, spec: DeviceSpec) -> Packed:
    """Pack a touch into a parcel, with its stated or measured stiffness; takes some seconds at most.

    Another process makes its own `Packed` of `str(parcel)` and `stiffness_n_per_m`; until then, the parcel is deleted
    if this process ends. If the touch is a film, `Packed.film` shows reliefs from here, whichever process feels it.
    spec: of the device on which the touch will act.
    Raises: DeviceError if there is no room, or the touch cannot be sent; BrokenMethod for an invalid stiffness.
    """
    stiffness = stiffness_of(touch_of(touch), spec).n_per_m
    packed = Packed(parcel.pack(touch), stiffness)
    packed.film = parcel.share(packed.parcel) if isinstance(touch, Film) else None
    return packed

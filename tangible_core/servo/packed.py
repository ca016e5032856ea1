"""A touch that one process makes, another has felt, and only the loop's own process reads.

The one that makes it may take long and be ended at any moment, the one in the middle imports no kernels and so neither
takes time nor memory for them. Of the touch, it holds a file's name and a stiffness.
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
    """A touch in a parcel (`parcel.pack`), for `Servo` to pass on: in the loop's process it is the touch itself.

    The parcel is this process's own from here on: while this process lives, nobody takes it away, whatever becomes of
    the process that packed it, and once this process is gone, whoever starts a loop next does. It is felt once: a loop
    that is given it, by `Servo` or by its `swap`, takes it, and where that fails it is gone too. One that is given to
    no loop is to be discarded.
    """

    def __init__(self, path: Path | str, stiffness_n_per_m: float) -> None:
        """path, stiffness_n_per_m: those of the `Packed` that `packed` gave in the process that made the touch.

        Raises: DeviceError if the parcel is not there any more, or is none.
        """
        self.stiffness_n_per_m = float(stiffness_n_per_m)
        self.parcel = parcel.adopted(Path(path))
        """The file; its name is another one than was given."""
        self.film: Film | None = None
        """Of a film, in the process that packed it: what is shown here is felt there."""

    def __reduce__(self) -> tuple[Any, ...]:
        return parcel.unpack, (self.parcel,)

    def force(self, state: HapticState) -> NoReturn:
        """Raises: DeviceError, always."""
        raise DeviceError("a packed touch is felt in the loop's process alone; ask the touch it was made of for forces")

    def path(self, positions_m: Any, period_s: float = 0.001) -> NoReturn:
        """Raises: DeviceError, always."""
        raise DeviceError("a packed touch is felt in the loop's process alone; ask the touch it was made of for a path")

    def handed_on(self) -> Path:
        """The parcel, for a loop that takes it away. Raises: DeviceError if one has, or it was discarded."""
        if not self.parcel.exists():
            raise DeviceError("a packed touch is felt once, and this one was, or was discarded; pack it again")
        return self.parcel

    def discard(self) -> None:
        """Take the parcel away, if no loop has; a second call does nothing."""
        self.parcel.unlink(missing_ok=True)


def packed(touch: Touch | Film, spec: DeviceSpec) -> Packed:
    """A touch in a parcel, and its stiffness: what it says of it, or what is felt of it; takes some seconds at most.

    What another process makes a `Packed` of are its `str(parcel)` and `stiffness_n_per_m`. Until it has, the parcel
    goes with this process. Of a film, `Packed.film` stays here to be shown pictures, whichever process feels it.
    spec: of the device that it will be felt with.
    Raises: DeviceError if there is no room, or the touch cannot be sent; BrokenMethod for a stiffness that is none.
    """
    stiffness = stiffness_of(touch_of(touch), spec).n_per_m
    made = Packed(parcel.pack(touch), stiffness)
    made.film = parcel.shared(made.parcel) if isinstance(touch, Film) else None
    return made

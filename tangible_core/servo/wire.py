"""Messages between the host and the loop's process: pickles, each after its length, over a pipe."""

import pickle
from typing import IO, Any, NamedTuple

import numpy as np

from ..child_process import dumps
from ..interfaces import HapticDevice


class Start(NamedTuple):
    """What the loop's process is told first."""

    ring: str
    """File of the ring."""
    scene: str
    """File of the parcel with the touch."""
    device: HapticDevice
    settings: np.ndarray
    """Of the guard."""


class Swap(NamedTuple):
    """Feel another scene from the next tick on."""

    scene: str
    settings: np.ndarray


class Stop(NamedTuple):
    """End the loop."""

    why: str


class Running(NamedTuple):
    """The device is open, everything is compiled, the first tick is due."""

    how: str
    """What the operating system granted, and who ticks."""


class Swapped(NamedTuple):
    """The scene sent last is ready to be felt."""


class Ended(NamedTuple):
    """The loop is over and the device has no force."""

    stopped: str
    """Why it ended early; empty when the time was over."""
    error: Exception | None = None
    """What a plugin raised, if that was the reason."""


def send(file: IO[bytes], message: Any) -> None:
    """Raises: OSError if nobody listens."""
    data = dumps(message)
    file.write(len(data).to_bytes(8, "little") + data)
    file.flush()


def receive(file: IO[bytes]) -> Any:
    """The next message; None when the other side is gone."""
    data = _exactly(file, int.from_bytes(_exactly(file, 8), "little"))
    return pickle.loads(data) if data else None


def _exactly(file: IO[bytes], length: int) -> bytes:
    """So many bytes of an unbuffered file, or fewer if it ends."""
    data = b""
    while len(data) < length and (more := file.read(length - len(data))):
        data += more
    return data

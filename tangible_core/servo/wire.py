"""Messages between the host and the loop's process: pickles, each after its length, over a pipe.

That a loop is to end is no message, but a word in the ring: it is heard whatever else is on its way.
"""

import pickle
import traceback
from typing import IO, Any, NamedTuple

import numpy as np

from ..errors import BrokenMethod, TangibleError, exit_error
from ..plugins.failures import remember_place, sentence
from ..plugins.interfaces import HapticDevice
from ..runtime.child_process import dumps


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


class StartReply(NamedTuple):
    """The device is open, everything is compiled, the first tick is due."""

    how: str
    """What the operating system granted, and who ticks."""


class SwapReply(NamedTuple):
    """The scene sent last is felt."""

    how: str
    """As of `StartReply`, of this scene."""


class Refusal(NamedTuple):
    """The scene sent last cannot be felt; the one before it still is."""

    error: Exception


class End(NamedTuple):
    """The loop is over and the device has no force."""

    stopped: str
    """Why it ended early, where its process knows; else empty."""
    error: Exception | None = None
    """What a plugin raised, if that was the reason."""


def sendable(error: BaseException) -> Exception:
    """The error, if it arrives as it is at the other end; else one that says whose it is, its name and its text."""
    if isinstance(error, SystemExit):
        return exit_error(error)
    try:
        if not isinstance(error, TangibleError):
            remember_place(error, "".join(traceback.format_exception(error)))
        if isinstance(error, Exception) and type(pickle.loads(dumps(error))) is type(error):
            return error
    except Exception:  # noqa: BLE001 - pickling runs the plugin's own code
        pass
    return BrokenMethod(sentence(error))


def send(file: IO[bytes], message: Any) -> None:
    """Raises: OSError if nobody listens."""
    data = dumps(message)
    file.write(len(data).to_bytes(8, "little") + data)
    file.flush()


def receive(file: IO[bytes]) -> Any:
    """The next message; None when the other side is gone."""
    size = _exactly(file, 8)
    length = int.from_bytes(size, "little")
    data = _exactly(file, length)
    return pickle.loads(data) if size and len(data) == length else None


def _exactly(file: IO[bytes], length: int) -> bytes:
    """So many bytes of an unbuffered file, or fewer if it ends."""
    data = b""
    while len(data) < length and (more := file.read(length - len(data))):
        data += more
    return data

"""Messages between the host and the loop's process, and their framing: pickles, each after its length."""

import pickle
import traceback
from typing import IO, Any, NamedTuple

import numpy as np

from ..errors import BrokenMethod, TangibleError, exit_error
from ..plugins.failures import remember_place, sentence
from ..plugins.interfaces import HapticDevice
from ..runtime.child_process import dumps


class Start(NamedTuple):
    """The first message to the loop's process: start."""

    ring: str  # file of the ring
    scene: str  # file of the parcel with the touch
    device: HapticDevice
    settings: np.ndarray  # settings of the guard
    timeout_s: float  # the watchdog's time-out
    language: str  # the language of what a device asks of the person while it is opened, such as to home it


class Swap(NamedTuple):
    """The request to go on with another scene from the next tick on."""

    scene: str
    settings: np.ndarray
    timeout_s: float


class StartReply(NamedTuple):
    """The reply to `Start`: the device is open, everything is compiled, the first tick is due."""

    how: str  # the rights that the operating system granted, and the kind of loop


class SwapReply(NamedTuple):
    """The reply to `Swap`: the loop has gone on with the new scene."""

    how: str  # the sentence of `StartReply`, for this scene


class Refusal(NamedTuple):
    """The reply to `Swap` if the new scene cannot be used; the loop goes on with the scene before."""

    error: Exception


class End(NamedTuple):
    """The last message of the loop's process: the loop is over and the device has no force."""

    stopped: str  # the reason for an early end, if the process knows it; else empty
    error: Exception | None = None  # the error of a plugin that ended the loop


def sendable(error: BaseException) -> Exception:
    """Return the error if it can be pickled as it is, or else a `BrokenMethod` with its origin, name and text."""
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
    """Send a message. Raises: OSError if the other side is gone."""
    data = dumps(message)
    file.write(len(data).to_bytes(8, "little") + data)
    file.flush()


def receive(file: IO[bytes]) -> Any:
    """Return the next message; None when the other side is gone."""
    size = _read(file, 8)
    length = int.from_bytes(size, "little")
    data = _read(file, length)
    return pickle.loads(data) if size and len(data) == length else None


def _read(file: IO[bytes], length: int) -> bytes:
    """Read this number of bytes from an unbuffered file, or fewer if the file ends."""
    data = b""
    while len(data) < length and (more := file.read(length - len(data))):
        data += more
    return data

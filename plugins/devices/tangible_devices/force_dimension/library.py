"""`forcedimension_core.dhd`, the bindings to the maker's library, and which of its devices are open here."""

import io
from contextlib import redirect_stderr
from importlib import import_module
from threading import Lock
from typing import Any, final

from tangible_core.errors import DeviceAbsent, DeviceError

INSTALL = (
    "install the Force Dimension SDK 3.16 or newer (forcedimension.com), then pip install "
    "'tangible-images[force-dimension]' with Python 3.12 or older; FDSDK in the environment may name the SDK's folder"
)


def library() -> Any:
    """The bindings. Raises: DeviceAbsent saying what to install."""
    try:
        with redirect_stderr(io.StringIO()):  # which says less than the message below
            return import_module("forcedimension_core.dhd")
    except ImportError as error:
        first = str(error).split(". ")[0]
        raise DeviceAbsent(f"device force-dimension: {first}; {INSTALL}") from error


def done(dhd: Any, result: int, doing: str, cure: str) -> int:
    """A result that is none of failure. Raises: DeviceError in the library's words, and with a cure, otherwise."""
    if result < 0:
        raise DeviceError(f"Force Dimension, {doing}: {dhd.errorGetLastStr()}; {cure}")
    return result


@final
class OpenDevices:
    """The devices that this program has open: asked for again, the library would hand out the same one twice."""

    def __init__(self) -> None:
        self._numbers: set[int] = set()
        self._lock = Lock()

    def __contains__(self, number: int) -> bool:
        with self._lock:
            return number in self._numbers

    def take(self, number: int) -> bool:
        """Whether it was free."""
        with self._lock:
            free = number not in self._numbers
            self._numbers.add(number)
            return free

    def give_back(self, number: int) -> None:
        """It is free again."""
        with self._lock:
            self._numbers.discard(number)


OPENED = OpenDevices()

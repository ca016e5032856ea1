"""`forcedimension_core.dhd`, the bindings to the maker's library, and the devices that this program has open."""

import io
from contextlib import redirect_stderr
from importlib import import_module
from threading import Lock
from typing import Any, final

from tangible_core.errors import DeviceAbsent, DeviceError

INSTALL = (
    "install the Force Dimension SDK 3.16 or newer (forcedimension.com), then pip install "
    "forcedimension-core with Python 3.12 or older; FDSDK in the environment may name the SDK's folder"
)


def library() -> Any:
    """Return the bindings. Raises: DeviceAbsent that names what to install."""
    try:
        with redirect_stderr(io.StringIO()):  # its output is less specific than the message below
            return import_module("forcedimension_core.dhd")
    except ImportError as error:
        first = str(error).split(". ")[0]
        raise DeviceAbsent(f"device force-dimension: {first}; {INSTALL}") from error


def check_result(dhd: Any, result: int, doing: str, cure: str) -> int:
    """Return a result that is not an error. Raises: DeviceError with the library's message and the cure otherwise."""
    if result < 0:
        raise DeviceError(f"Force Dimension, {doing}: {dhd.errorGetLastStr()}; {cure}")
    return result


@final
class OpenDevices:
    """The devices that this program has open; the library itself would open the same one twice."""

    def __init__(self) -> None:
        self._numbers: set[int] = set()
        self._lock = Lock()

    def __contains__(self, number: int) -> bool:
        with self._lock:
            return number in self._numbers

    def take(self, number: int) -> bool:
        """Mark a device as open; return False if it was open already."""
        with self._lock:
            free = number not in self._numbers
            self._numbers.add(number)
            return free

    def give_back(self, number: int) -> None:
        """Mark a device as closed."""
        with self._lock:
            self._numbers.discard(number)


OPENED = OpenDevices()

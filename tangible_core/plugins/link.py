"""An open device: what a driver does, and around it, once for all drivers, what keeps the hand safe."""

import logging
import math
from abc import ABC, abstractmethod
from types import TracebackType
from typing import Any, Self, final

from ..data import NO_FORCE, Force, HapticState, limited
from ..data.arguments import as_force, as_state
from ..errors import ArgumentError, BrokenMethod, DeviceError, what_is, wrong_argument

log = logging.getLogger(__name__)


class Link(ABC):
    """An open device. As a context manager it leaves zero force behind, whatever happens.

    A driver is `_read`, `_send`, `_release` and `applied`. What it cannot forget stands around them: a force that is
    not finite is sent as zero, one over the greatest is scaled down, a link that is closed refuses in one sentence,
    and one that is being closed sends zero force before the device is let go of.
    """

    # Mangled, so that no driver's own field of such a name takes their place.

    def __init__(self, name: str, max_force_n: float) -> None:
        """name: as messages call it, such as "the mock device". max_force_n: the greatest force that is sent."""
        self.__name, self.__max_force_n = name, max_force_n
        self.__closed = ""

    @abstractmethod
    def _read(self) -> HapticState:
        """Where the tip is now. Raises: DeviceError if the device stopped answering."""

    @abstractmethod
    def _send(self, force: Force) -> None:
        """Set this force, which is finite and no greater than the device's. Raises: DeviceError as `_read`."""

    @abstractmethod
    def _release(self) -> None:
        """Let go of the device, to which zero force was sent before, if it listened; called once."""

    @property
    @abstractmethod
    def applied(self) -> Force:
        """The force the device holds now, as far as the driver knows."""

    @final
    def read(self) -> HapticState:
        """Where the tip is now. Raises: DeviceError if the device stopped answering or the link is closed."""
        if self.__closed:
            raise self.__refusal()
        found = self._read()
        return found if type(found) is HapticState else self.__as_state(found)

    @final
    def write(self, force: Force) -> None:
        """Set the force on the hand; a force that is not finite becomes zero, one too strong is scaled down.

        Raises: DeviceError if the device stopped answering or the link is closed.
        """
        if self.__closed:
            raise self.__refusal()
        if type(force) is not Force:
            force = _as_force(force)
        most_n = self.__max_force_n
        self._send(force if math.hypot(*force) <= most_n else limited(force, most_n))

    @final
    def close(self) -> None:
        """Let go of the device, with no force left; a second call does nothing."""
        try:
            self.__let_go()
        except DeviceError as error:
            log.warning("%s: its force could not be made zero, turn off its power: %s", self.__name, error)

    @final
    def __enter__(self) -> Self:
        return self

    @final
    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.__let_go()
        except DeviceError:
            if error is None:  # a device that died raised already
                raise

    @final
    def _check_open(self) -> None:
        """For what else a driver can be asked. Raises: DeviceError if the link is closed."""
        if self.__closed:
            raise self.__refusal()

    @final
    def _end(self, why: str) -> None:
        """For a driver that let go by itself: closed from now on. why: such as "was closed after an error"."""
        self.__closed = self.__closed or why

    def __let_go(self) -> None:
        if self.__closed:
            return
        try:
            self._send(NO_FORCE)
        finally:
            if not self.__closed:  # else the driver did so itself
                self.__closed = "is closed"
                self._release()

    def __as_state(self, found: Any) -> HapticState:
        try:
            return as_state(found)
        except ArgumentError as error:
            gave = what_is(found)
            raise BrokenMethod(f"{self.__name}: its driver read {gave}; it must read a HapticState") from error

    def __refusal(self) -> DeviceError:
        return DeviceError(f"{self.__name} {self.__closed}; open it again")


def _as_force(force: Any) -> Force:
    if (found := as_force(force)) is None:
        raise wrong_argument("force", force, "a Force, or three numbers: x, y and z in newtons")
    return found

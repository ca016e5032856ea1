"""An open device: the methods of a driver, and around them the checks that keep the hand safe."""

import logging
import math
from abc import ABC, abstractmethod
from types import TracebackType
from typing import Any, Self, final

from ..data import NO_FORCE, Force, HapticState, limited
from ..data.arguments import as_force, as_state
from ..errors import ArgumentError, BrokenMethod, DeviceError, what_is, wrong_argument

log: logging.Logger = logging.getLogger(__name__)


class Link(ABC):
    """An open device. As a context manager it leaves zero force behind, whatever happens.

    A driver implements `_read`, `_send`, `_release` and `applied`. The link around them keeps every driver safe: a
    force that is not finite is sent as zero, a force over the limit is scaled down, a closed link raises an error in
    one sentence, and closing sends zero force before the device is released.
    """

    # Mangled names, so that a driver's fields cannot replace them.

    def __init__(self, name: str, max_force_n: float) -> None:
        """Keep the name for messages, such as "the mock device", and the greatest force to send, in newtons."""
        self.__name, self.__max_force_n = name, max_force_n
        self.__end_reason = ""
        self.__newest_s, self.__fresh = -math.inf, False

    @abstractmethod
    def _read(self) -> HapticState:
        """Read the state of the tip; its time goes forward. Raises: DeviceError if the device stopped answering."""

    @abstractmethod
    def _send(self, force: Force) -> None:
        """Set this force, which is finite and not over the device's limit. Raises: DeviceError as `_read`."""

    @abstractmethod
    def _release(self) -> None:
        """Release the device. Called once, after zero force was sent, which a broken device may not have received."""

    @property
    @abstractmethod
    def applied(self) -> Force:
        """The force that the device applies now, as far as the driver knows."""

    @final
    def read(self) -> HapticState:
        """Read the state of the tip. Raises: DeviceError if the device stopped answering or the link is closed."""
        if self.__end_reason:
            raise self.__refusal()
        state = self._read()
        if type(state) is not HapticState:
            state = self.__as_state(state)
        self.__fresh = self.__newest_s < state.time_s < math.inf
        if self.__fresh:
            self.__newest_s = state.time_s
        return state

    @final
    @property
    def fresh(self) -> bool:
        """Whether the last state read is newer than all before it; False if its time stood, went back or is NaN.

        A driver that hangs may return its last state again and again, and the hand may be elsewhere by then.
        """
        return self.__fresh

    @final
    def write(self, force: Force) -> None:
        """Set the force on the hand; a force that is not finite becomes zero, a too strong one is scaled down.

        Raises: DeviceError if the device stopped answering or the link is closed.
        """
        if self.__end_reason:
            raise self.__refusal()
        if type(force) is not Force:
            force = _as_force(force)
        most_n = self.__max_force_n
        self._send(force if math.hypot(*force) <= most_n else limited(force, most_n))

    @final
    def close(self) -> None:
        """Send zero force and release the device; a second call does nothing."""
        try:
            self.__release_once()
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
            self.__release_once()
        except DeviceError:
            if error is None:  # a device that died raised already
                raise

    @final
    def _check_open(self) -> None:
        """Refuse a closed link, in a driver's own methods. Raises: DeviceError if the link is closed."""
        if self.__end_reason:
            raise self.__refusal()

    @final
    def _end(self, why: str) -> None:
        """Mark the link as closed, for a driver that released its device. why: such as "was closed after an error"."""
        self.__end_reason = self.__end_reason or why

    def __release_once(self) -> None:
        if self.__end_reason:
            return
        try:
            self._send(NO_FORCE)
        finally:
            if not self.__end_reason:  # else the driver released it
                self.__end_reason = "is closed"
                self._release()

    def __as_state(self, value: Any) -> HapticState:
        try:
            return as_state(value)
        except ArgumentError as error:
            raise BrokenMethod(
                f"{self.__name}: its driver read {what_is(value)}; it must read a HapticState"
            ) from error

    def __refusal(self) -> DeviceError:
        return DeviceError(f"{self.__name} {self.__end_reason}; open it again")


def _as_force(force: Any) -> Force:
    if (result := as_force(force)) is None:
        raise wrong_argument("force", force, "a Force, or three numbers: x, y and z in newtons")
    return result

"""An Inverse3 in use."""

import time
from contextlib import suppress
from typing import final

from tangible_core.data import NO_FORCE, Force, HapticState, Vector
from tangible_core.errors import DeviceError
from tangible_core.plugins.interfaces import Link

from .service import Answer, Session


@final
class HaplyLink(Link):
    """An Inverse3 in use; it answers while the next force is computed, so that a tick waits for one answer only."""

    def __init__(self, session: Session, device_id: str, centre_m: Vector, max_force_n: float) -> None:
        super().__init__("this Haply device", max_force_n)
        self._session = session
        self._device_id = device_id
        self._centre_m = centre_m
        self._applied = NO_FORCE
        self._before: tuple[float, Vector] | None = None
        self._answers = True

    def _read(self) -> HapticState:
        """Return the answer to the last force, or to the same force sent again.

        Raises: DeviceError if the service or the arm is gone.
        """
        try:
            if not self._session.waits:
                self._session.send(self._device_id, self._applied)
            answer = self._session.newest(self._device_id)
        except DeviceError:
            self._applied, self._answers = NO_FORCE, False  # commands lapse when none are sent
            raise
        return self._state(time.perf_counter(), answer)

    def _send(self, force: Force) -> None:
        """Send a force. Raises: DeviceError as `_read`."""
        try:
            if self._session.waits:
                self._session.newest(self._device_id)
            self._session.send(self._device_id, force)
        except DeviceError:
            self._applied, self._answers = NO_FORCE, False
            raise
        self._applied, self._answers = force, True

    @property
    def applied(self) -> Force:
        """The force sent last; zero after the service is gone, as its commands lapse."""
        return self._applied

    def _release(self) -> None:
        """Wait for the answer to the last force, and disconnect."""
        if self._answers:
            with suppress(DeviceError):
                self._session.newest(self._device_id)
        self._session.close()

    def _state(self, now_s: float, answer: Answer) -> HapticState:
        (x, y, z), (cx, cy, cz) = answer.position_m, self._centre_m
        velocity = answer.velocity_m_per_s or self._velocity(now_s, answer.position_m)
        self._before = now_s, answer.position_m
        return HapticState((x - cx, y - cy, z - cz), velocity, now_s, answer.buttons)

    def _velocity(self, now_s: float, position_m: Vector) -> Vector:
        """Return the mean velocity since the last answer, for a service that reports none."""
        then_s, (x, y, z) = self._before or (now_s, position_m)
        span = now_s - then_s or 1.0
        return (position_m[0] - x) / span, (position_m[1] - y) / span, (position_m[2] - z) / span

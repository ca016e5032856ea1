"""Scenes in rotation on one loop, each with its limits, its beacon and its film."""

import logging
import math
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from typing import NamedTuple, final

from ...data import FilmFelt, HapticSurface
from ...plugins.interfaces import Film, Touch
from ...runtime.system.service import tell_service_manager
from ...servo import Beacon, Safety, Servo
from ...servo.beacon import BUTTON
from ..film import Player, Reliefs

log: logging.Logger = logging.getLogger(__name__)


class Slot(NamedTuple):
    """A scene of the rotation, and the limits of its forces."""

    touch: Touch | Film
    limits: Safety
    parts: HapticSurface | None = None
    """The surface with the names of parts and materials for reports; None for none."""
    beacon: Beacon | None = None
    """A beacon to a part of this scene, on in each of its turns until a button has released a beacon."""
    reliefs: Callable[[], Reliefs] | None = None
    """A function that makes the reliefs of a touch that is a film; called for each turn."""
    name: str = ""
    """The name of the scene, for the log."""


@final
class Rotation:
    """The current scene, and the time of its end."""

    def __init__(self, slots: Sequence[Slot], each_s: float, threads: int | None) -> None:
        self._slots, self._each_s, self._threads = slots, each_s, threads
        self._at, self._due_s = 0, math.inf
        self._swapping: Future[None] | None = None
        self._player: Player | None = None
        self._is_released = False
        """True once a button has released a beacon: then no beacon follows."""

    @property
    def current(self) -> Slot:
        """The scene under the hand."""
        return self._slots[self._at]

    @property
    def frames(self) -> FilmFelt | None:
        """The counts of the current film; None for a scene without one."""
        return self._player.counts if self._player is not None else None

    def begin(self, servo: Servo) -> None:
        """Begin the turn of the current scene, with its beacon and the first frame of its film."""
        self._swapping, self._due_s = None, time.monotonic() + self._each_s
        log.info("now on the device, at %s: %s", time.strftime("%H:%M:%S"), self.current.name)
        tell_service_manager(f"READY=1\nSTATUS=on the device: {self.current.name}")
        self.note_release(servo)
        if not self._is_released:
            servo.pull_to(self.current.beacon)
        self._player, reliefs, film = None, self.current.reliefs, servo.film
        if reliefs is not None and film is not None:
            self._player = Player(reliefs(), film, self._threads)
            self._player.start()

    def look(self, servo: Servo, background: ThreadPoolExecutor) -> None:
        """Swap in the next scene when it is time, in the background, while ticks are recorded and reported."""
        if self._player is not None:
            self._player.check()
        if self._swapping is not None and self._swapping.done():
            swap, self._swapping = self._swapping, None
            if servo.running:  # else it fails for what ended the loop
                swap.result()
                self._at = self._next
                self.begin(servo)
        elif self._swapping is None and len(self._slots) > 1 and time.monotonic() >= self._due_s:
            self.note_release(servo)
            self.stop_film()
            self._swapping = background.submit(servo.swap, *self._slots[self._next][:2])

    def stop_film(self) -> None:
        """Stop the film; the surface stays as the last frame left it."""
        if self._player is not None:
            self._player.stop()
            self._player.check()

    def note_release(self, servo: Servo) -> None:
        """Note whether a button has released the beacon."""
        self._is_released = self._is_released or servo.ring.beacon.state.why == BUTTON

    @property
    def _next(self) -> int:
        return (self._at + 1) % len(self._slots)

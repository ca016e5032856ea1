"""A mock of Haply's service, with the same messages."""

import json
import math
import time
from collections.abc import Callable
from threading import Lock, Thread
from types import TracebackType
from typing import Any, Self, final

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

from tangible_core.data import NO_FORCE, Force, Vector

Motion = Callable[[float], tuple[Vector, Vector]]
"""A function that gives position and velocity at a time in seconds."""


def circling(time_s: float) -> tuple[Vector, Vector]:
    """Move on a circle of 2 cm around (0, -0.14, 0.12), once a second."""
    turn, rate, radius = 2 * math.pi * time_s, 2 * math.pi, 0.02
    x, y = radius * math.cos(turn), radius * math.sin(turn)
    return (x, y - 0.14, 0.12), (-rate * y, rate * x, 0.0)


@final
class MockService:
    """A service on a free port of this machine, as a context manager; every arm makes the same motion.

    A full snapshot on connecting, then one state for each message. A force lapses when no other one has come for
    lapse_s, and when its session ends.
    """

    def __init__(self, arms: tuple[str, ...] = ("049D",), motion: Motion = circling, lapse_s: float = 0.1) -> None:
        self.arms = list(arms)
        self.motion = motion
        self.lapse_s = lapse_s
        self.status: dict[str, bool] = {"calibrated": True, "in_use": False, "power_supply": True, "ready": True}
        self.tells_velocity = True
        self.button = False
        self.mute = False
        """True to leave messages without an answer, as a service that hangs."""
        self.messages: list[Any] = []
        """All messages received."""
        self._forces: dict[str, tuple[float, Force]] = {}
        self._lock = Lock()
        self._server = serve(self._talk, "127.0.0.1", 0, compression=None, ping_interval=None, close_timeout=1)
        self._thread = Thread(target=self._server.serve_forever, daemon=True)

    @property
    def uri(self) -> str:
        """Address of the service."""
        return f"ws://127.0.0.1:{self._server.socket.getsockname()[1]}"

    def force(self, device_id: str = "049D") -> Force:
        """Return the force of an arm's motors."""
        with self._lock:
            since, force = self._forces.get(device_id, (0.0, NO_FORCE))
        return force if time.monotonic() - since <= self.lapse_s else NO_FORCE

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._server.shutdown()
        self._thread.join()

    def _talk(self, connection: ServerConnection) -> None:
        try:
            connection.send(json.dumps(self._message(full=True)))
            for text in connection:
                message = json.loads(text)
                self.messages.append(message)
                self._obey(message)
                if not self.mute:
                    connection.send(json.dumps(self._message(full=False)))
        except ConnectionClosed:
            pass
        with self._lock:
            self._forces.clear()

    def _obey(self, message: dict[str, Any]) -> None:
        now = time.monotonic()
        with self._lock:
            for each in message["inverse3"]:
                vector = each["commands"]["set_cursor_force"]["vector"]
                self._forces[each["device_id"]] = now, Force(vector["x"], vector["y"], vector["z"])

    def _message(self, full: bool) -> dict[str, Any]:
        position, velocity = self.motion(time.perf_counter())
        state: dict[str, Any] = {"cursor_position": _xyz(position), "control_mode": "cartesian_force"}
        if self.tells_velocity:
            state["cursor_velocity"] = _xyz(velocity)
        extra = {"config": {"type": "inverse3", "port": "COM12", "handedness": "right"}} if full else {}
        arms = [{"device_id": arm, **extra, "state": state, "status": dict(self.status)} for arm in self.arms]
        grip = {"device_id": "61548", "state": {"button": self.button, "hall": 0}}
        return (
            {"session_id": 7, "inverse3": arms, "verse_grip": [grip]}
            if full
            else {"inverse3": arms, "verse_grip": [grip]}
        )


def _xyz(vector: Vector) -> dict[str, float]:
    return dict(zip("xyz", vector, strict=True))

"""The Haply Inverse3, through its maker's local service: JSON over a web socket, one answer for each message.

Source: Haply, Inverse SDK 3.5, WebSocket protocol (docs.haply.co/inverseSDK/service/realtime/websocket-protocol).
"""

import json
import math
import time
from collections.abc import Generator, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, final

from pydantic import Field

from tangible_core.data import NO_FORCE, DeviceSpec, Finding, Force, HapticState, Unit, Vector
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.plugins import HapticDevice, Link, Serviceable

if TYPE_CHECKING:
    from websockets.sync.client import ClientConnection

START = "start Haply Hub or the Haply Inverse Service, or give its address with option uri"
MAX_BYTES = 1 << 22
# Problems by the status flags that the service reports as false; a missing flag is not a problem.
PROBLEMS = {
    "ready": "is not ready",
    "power_supply": "has no power; plug in its power supply",
    "calibrated": "is not calibrated; follow what its light asks for, or Haply Hub",
}
Metres = Annotated[float, Field(ge=-1, le=1)]


class Haply(HapticDevice, Serviceable):
    """A Haply Inverse3 (or Minverse), through the Haply Inverse Service 3.5 or newer on this machine.

    The axes of the service are those of the workspace: x right, y away from the user, z up. The origin is the base of
    the arm, in front of which the hand moves; `centre_m` is the point that becomes the picture's centre. A wired
    VerseGrip's button is button 0.
    """

    uri: Annotated[str, Field(pattern=r"^wss?://")] = "ws://localhost:10001"
    """Address at which the service listens."""
    device_id: str | None = None
    """Identifier of the Inverse3, as `tangible devices` lists it; null selects the first."""
    centre_m: tuple[Metres, Metres, Metres] = (0.0, -0.14, 0.1)
    """Position, in the service's frame, that becomes the origin; the default is a guess at a comfortable place."""
    max_force_n: Annotated[float, Field(gt=0, le=20)] = 5.0
    """Greatest force that is sent; less than the arm's short-term peak, because motors heat up."""
    timeout_s: Annotated[float, Field(gt=0, le=60)] = 1.0
    """Time without an answer after which the service counts as lost."""

    def spec(self) -> DeviceSpec:
        """Return the option's force, and cautious guesses of the rest: the maker states no stiffness or damping."""
        return DeviceSpec(
            max_force_n=self.max_force_n,
            max_stiffness_n_per_m=2000.0,
            damping_n_s_per_m=5.0,
            workspace_m=(0.2, 0.2, 0.2),
            resolution_m=1e-4,
            buttons=1,
        )

    def open(self) -> Link:
        """Connect to the arm. Raises: DeviceAbsent if service or arm is missing; DeviceError on failure."""
        session = Session(self.uri, self.timeout_s)
        return HaplyLink(session, session.choose(self.device_id), self.centre_m, self.max_force_n)

    def connected(self) -> tuple[Unit, ...]:
        """Return the arms that the service lists. Raises: DeviceError as `open`."""
        session = Session(self.uri, self.timeout_s)
        try:
            return session.arms
        finally:
            session.close()

    def examine(self) -> Iterator[Finding]:
        """Check the library, the service, and the status that each arm reports."""
        try:
            arms = self.connected()
        except DeviceAbsent as absent:
            yield Finding("service", "not asked", str(absent))
            return
        except DeviceError as error:
            yield Finding("service", "failed", str(error), "restart the Haply Inverse Service")
            return
        yield Finding("service", "fine", f"answers at {self.uri}")
        for arm in arms:
            verdict = "failed" if arm.problem else "fine"
            cure = "look into Haply Hub" if arm.problem else ""
            yield Finding(f"{arm.name} {arm.serial}", verdict, arm.problem or "is ready", cure)


class Answer(NamedTuple):
    """The state of an arm from an answer."""

    position_m: tuple[float, float, float]
    velocity_m_per_s: tuple[float, float, float] | None
    buttons: int


@final
class Session:
    """A connection to the service. Commands lapse when none are sent; a force of zero keeps the session alive."""

    def __init__(self, uri: str, timeout_s: float) -> None:
        """Connect. Raises: DeviceAbsent if the service is missing, DeviceError for another server."""
        self.uri = uri
        self._timeout_s = timeout_s
        self._open = ExitStack()
        self._connection = _connect(self._open, uri, timeout_s)
        self._answers_due = 1  # the snapshot comes without a message
        try:
            self.arms: tuple[Unit, ...] = tuple(_arm(device) for device in _devices(self._receive(), "inverse3"))
        except BaseException:
            self.close()
            raise

    def choose(self, device_id: str | None) -> str:
        """Return the id of the arm to use. Raises: DeviceAbsent if there is none, DeviceError if not this one."""
        serials = [arm.serial for arm in self.arms]
        if not serials:
            self.close()
            raise DeviceAbsent(f"{self.uri}: no Inverse3 is connected; plug in its USB cable and its power supply")
        if device_id is not None and device_id not in serials:
            self.close()
            raise DeviceError(f"{self.uri}: there is no Inverse3 {device_id!r}; there are {', '.join(serials)}")
        return serials[0] if device_id is None else device_id

    def send(self, device_id: str, force_n: tuple[float, float, float]) -> None:
        """Set a force, to which the service owes an answer. Raises: DeviceError if the service is gone."""
        vector = dict(zip("xyz", force_n, strict=True))
        command = {"device_id": device_id, "commands": {"set_cursor_force": {"vector": vector}}}
        with _service_errors(self.uri):
            self._connection.send(json.dumps({"inverse3": [command]}))
        self._answers_due += 1

    @property
    def waits(self) -> bool:
        """True while an answer is still owed."""
        return self._answers_due > 0

    def newest(self, device_id: str) -> Answer:
        """Return the last of the owed answers. Raises: DeviceError if it does not come, or lacks this arm."""
        message: Mapping[str, Any] = {}
        while self._answers_due:
            message = self._receive()
        with _service_errors(self.uri):
            states = {str(device["device_id"]): device["state"] for device in _devices(message, "inverse3")}
            if device_id not in states:
                raise DeviceError(f"{self.uri}: Inverse3 {device_id} was unplugged; check its plug, then open it again")
            state = states[device_id]
            velocity = state.get("cursor_velocity")
            is_down = any(device["state"].get("button") is True for device in _devices(message, "verse_grip"))
            return Answer(_vector(state["cursor_position"]), velocity and _vector(velocity), int(is_down))

    def close(self) -> None:
        """Disconnect; never fails."""
        self._open.close()

    def _receive(self) -> Mapping[str, Any]:
        with _service_errors(self.uri):
            message = json.loads(self._connection.recv(self._timeout_s))
        self._answers_due -= 1
        if not isinstance(message, dict):
            raise DeviceError(f"{self.uri}: answers {str(message)[:60]!r}; is this the Haply Inverse Service 3.5?")
        return message


@final
class HaplyLink(Link):
    """An Inverse3 in use; it answers while the next force is computed, so that a tick waits for one answer only."""

    def __init__(self, session: Session, device_id: str, centre_m: Vector, max_force_n: float) -> None:
        super().__init__("this Haply device", max_force_n)
        self._session = session
        self._device_id = device_id
        self._centre_m = centre_m
        self._force = NO_FORCE
        self._before: tuple[float, Vector] | None = None
        self._answers = True

    def _read(self) -> HapticState:
        """Return the answer to the last force, or to the same force sent again. Raises: DeviceError."""
        try:
            if not self._session.waits:
                self._session.send(self._device_id, self._force)
            answer = self._session.newest(self._device_id)
        except DeviceError:
            self._force, self._answers = NO_FORCE, False  # commands lapse when none are sent
            raise
        return self._state(time.perf_counter(), answer)

    def _send(self, force: Force) -> None:
        try:
            if self._session.waits:
                self._session.newest(self._device_id)
            self._session.send(self._device_id, force)
        except DeviceError:
            self._force, self._answers = NO_FORCE, False
            raise
        self._force, self._answers = force, True

    @property
    def applied(self) -> Force:
        """The force sent last; zero after the service is gone, as its commands lapse."""
        return self._force

    def _release(self) -> None:
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


def _connect(until: ExitStack, uri: str, timeout_s: float) -> "ClientConnection":
    from websockets.exceptions import WebSocketException
    from websockets.sync.client import connect

    try:  # no proxy, compression or pings: the service is on this machine, and answers a thousand times a second
        connection = connect(
            uri,
            open_timeout=timeout_s,
            close_timeout=1,
            compression=None,
            proxy=None,
            ping_interval=None,
            max_size=MAX_BYTES,
        )
        return until.enter_context(connection)
    except (ConnectionRefusedError, TimeoutError) as error:
        raise DeviceAbsent(f"{uri}: no Haply service listens there ({error}); {START}") from error
    except (OSError, WebSocketException, EOFError) as error:
        raise DeviceError(f"{uri}: is not a Haply service ({error}); {START}") from error


def _arm(device: Mapping[str, Any]) -> Unit:
    """Return an Inverse3 as the service describes it on connecting."""
    config, status = device.get("config", {}), device.get("status", {})
    problems = [words for flag, words in PROBLEMS.items() if status.get(flag) is False]
    kind, port = str(config.get("type", "inverse3")), str(config.get("port", ""))
    return Unit(kind, str(device.get("device_id", "")), port, "; ".join(problems))


def _devices(message: Mapping[str, Any], kind: str) -> list[dict[str, Any]]:
    """Return the devices of a kind in a message; entries that are not objects are skipped."""
    devices = message.get(kind)
    return [device for device in devices if isinstance(device, dict)] if isinstance(devices, list) else []


def _vector(coordinates: Mapping[str, Any]) -> tuple[float, float, float]:
    vector = float(coordinates["x"]), float(coordinates["y"]), float(coordinates["z"])
    if not all(map(math.isfinite, vector)):
        raise ValueError(f"{vector} is not finite")
    return vector


@contextmanager
def _service_errors(uri: str) -> Generator[None]:
    """Turn errors of the exchange with the service into DeviceErrors."""
    from websockets.exceptions import ConnectionClosed

    try:
        yield
    except TimeoutError as error:
        raise DeviceError(f"{uri}: the Haply service no longer answers; restart it, open the device again") from error
    except ConnectionClosed as error:
        raise DeviceError(f"{uri}: the Haply service closed the connection ({error}); open the device again") from error
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise DeviceError(f"{uri}: sends invalid answers ({error!r}); is this the service 3.5?") from error

"""An Inverse3 would get wrong forces, or keep one after a fault: exact messages to a mock of its service."""

import json
import math
import socket
import time
from collections.abc import Callable, Iterator
from threading import Lock, Thread
from types import TracebackType
from typing import Any, Self, final

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

from tangible_core.data import NO_FORCE, Finding, Force, Unit, Vector
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.testing import run_checks
from tangible_devices.haply.haply import Haply, Session

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
        return {"inverse3": arms, "verse_grip": [grip], **({"session_id": 7} if full else {})}


def _xyz(vector: Vector) -> dict[str, float]:
    return dict(zip("xyz", vector, strict=True))


ZERO = {"x": 0.0, "y": 0.0, "z": 0.0}


def command(force: dict[str, float], device_id: str = "049D") -> dict:
    return {"inverse3": [{"device_id": device_id, "commands": {"set_cursor_force": {"vector": force}}}]}


@pytest.fixture
def service() -> Iterator[MockService]:
    with MockService() as service:
        yield service


def test_haply_conforms(service: MockService):
    failed = [check for check in run_checks("device", "haply", uri=service.uri) if not check.passed]
    assert not failed
    assert service.force() == NO_FORCE


class TestMessages:
    def test_message_is_one_command_with_one_answer(self, service: MockService):
        with Haply(uri=service.uri).open() as link:
            link.read()
            link.write(Force(1.0, -2.0, 0.5))
            link.read()
            link.read()
        assert service.messages == [
            command(ZERO),  # the snapshot is not what a read returns: it may be old
            command({"x": 1.0, "y": -2.0, "z": 0.5}),
            command({"x": 1.0, "y": -2.0, "z": 0.5}),  # a read without a write between sends the force again
            command(ZERO),
        ]

    def test_close_disconnects_after_last_zero_is_answered(self, service: MockService, monkeypatch: pytest.MonkeyPatch):
        waited: list[bool] = []
        close = Session.close
        monkeypatch.setattr(Session, "close", lambda session: (waited.append(not session.waits), close(session)))
        with Haply(uri=service.uri).open() as link:
            link.write(Force(1.0, -2.0, 0.5))
        assert waited == [True]

    def test_position_has_centre_as_origin_and_workspace_axes(self):
        with MockService(motion=lambda _: ((0.01, -0.12, 0.13), (0.1, 0.2, 0.3))) as service:
            service.button = True
            with Haply(uri=service.uri, centre_m=(0.0, -0.14, 0.1)).open() as link:
                state = link.read()
        assert state.position_m == pytest.approx((0.01, 0.02, 0.03))
        assert (state.velocity_m_per_s, state.buttons) == ((0.1, 0.2, 0.3), 1)

    def test_velocity_of_service_without_velocities_is_estimated(self, service: MockService):
        service.tells_velocity = False
        with Haply(uri=service.uri).open() as link:
            before = link.read()
            assert before.velocity_m_per_s == (0, 0, 0)
            for _ in range(5):
                time.sleep(0.002)
                after = link.read()
                way = [end - start for start, end in zip(before.position_m, after.position_m, strict=True)]
                span = after.time_s - before.time_s
                assert after.velocity_m_per_s == pytest.approx([part / span for part in way])
                before = after

    def test_close_leaves_no_force_at_motors(self, service: MockService):
        service.lapse_s = 60.0
        link = Haply(uri=service.uri).open()
        link.write(Force(0.0, 0.0, 1.5))
        link.close()
        assert service.force() == NO_FORCE
        assert service.messages[-1] == command(ZERO)

    def test_arm_is_chosen_by_its_id(self):
        with MockService(arms=("049D", "05DA"), lapse_s=60.0) as service:
            with Haply(uri=service.uri, device_id="05DA").open() as link:
                link.write(Force(0.0, 0.0, 1.0))
                link.read()
                assert service.force("05DA") == (0, 0, 1)
                assert service.force("049D") == NO_FORCE
            with pytest.raises(DeviceError, match="049D, 05DA"):
                Haply(uri=service.uri, device_id="1234").open()


class TestFaults:
    def test_open_without_service_or_arm_names_what_to_do(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            uri = f"ws://127.0.0.1:{taken.getsockname()[1]}"
            with pytest.raises(DeviceAbsent, match="no Haply service"):
                Haply(uri=uri).open()
        with MockService(arms=()) as service, pytest.raises(DeviceAbsent, match="plug in"):
            Haply(uri=service.uri).open()

    def test_open_on_another_server_is_refused(self):
        with socket.create_server(("127.0.0.1", 0)) as other:

            def refuse() -> None:
                with other.accept()[0] as caller:
                    caller.sendall(b"HTTP/1.1 404 Not Found\r\n\r\n")

            thread = Thread(target=refuse)
            thread.start()
            with pytest.raises(DeviceError, match="is not a Haply service"):
                Haply(uri=f"ws://127.0.0.1:{other.getsockname()[1]}", timeout_s=5).open()
            thread.join()

    def test_read_from_hanging_service_is_refused(self, service: MockService):
        link = Haply(uri=service.uri, timeout_s=0.6).open()
        link.read()
        service.mute = True
        link.write(Force(0.0, 0.0, 1.0))
        with pytest.raises(DeviceError, match="no longer answers"):
            link.read()
        assert link.applied == NO_FORCE
        link.close()

    def test_read_from_unplugged_arm_is_refused(self, service: MockService):
        link = Haply(uri=service.uri).open()
        link.read()
        service.arms.clear()
        with pytest.raises(DeviceError, match="was unplugged"):
            link.read()
        link.close()

    def test_read_from_ended_service_is_refused(self):
        with MockService() as service:
            link = Haply(uri=service.uri).open()
            link.write(Force(0.0, 0.0, 1.0))
            link.read()
        with pytest.raises(DeviceError, match="closed the connection"):
            for _ in range(3):
                link.read()
        with pytest.raises(DeviceError, match="closed the connection"):
            link.write(Force(0.0, 0.0, 1.0))
        assert link.applied == NO_FORCE
        link.close()
        with MockService() as service, Haply(uri=service.uri).open() as link:
            link.read()

    @pytest.mark.usefixtures("unchecked_shapes")
    @pytest.mark.parametrize(
        "answer",
        [
            "not json",
            "[]",
            '{"inverse3": [{"device_id": "049D", "state": {}}]}',
            '{"inverse3": [{"device_id": "049D", "state": {"cursor_position": {"x": 0, "y": 0}}}]}',
            '{"inverse3": [{"device_id": "049D", "state": {"cursor_position": {"x": NaN, "y": 0, "z": 0}}}]}',
            '{"inverse3": ' + "[" * 3000,
            "{}",
        ],
    )
    def test_read_of_invalid_answer_is_refused(self, answer: str):
        snapshot = json.dumps({"inverse3": [{"device_id": "049D", "config": {}, "status": {}}]})

        def talk(connection: ServerConnection) -> None:
            connection.send(snapshot)
            for _ in connection:
                connection.send(answer)

        with serve(talk, "127.0.0.1", 0) as server:
            thread = Thread(target=server.serve_forever)
            thread.start()
            link = Haply(uri=f"ws://127.0.0.1:{server.socket.getsockname()[1]}").open()
            link.write(NO_FORCE) if "state" in answer else None
            with pytest.raises(DeviceError, match=r"invalid answers|is this the Haply|was unplugged"):
                for _ in range(2):
                    link.read()
            link.close()
            server.shutdown()
            thread.join()


class TestService:
    def test_connected_lists_arms_and_doctor_repeats_their_problem(self, service: MockService):
        with MockService(arms=("049D", "05DA")) as two:
            assert Haply(uri=two.uri).connected() == (
                Unit("inverse3", "049D", "COM12"),
                Unit("inverse3", "05DA", "COM12"),
            )
            assert two.messages == []
        service.status |= {"power_supply": False, "calibrated": False}
        findings = list(Haply(uri=service.uri).examine())
        assert findings[0] == Finding("service", "fine", f"answers at {service.uri}")
        assert findings[1].verdict == "failed"
        assert "plug in its power supply" in findings[1].says and "not calibrated" in findings[1].says
        [finding] = Haply(uri="ws://127.0.0.1:9").examine()
        assert finding.verdict == "not asked"

"""The Inverse3 against a mock of its service: the exact messages, and faults."""

import json
import socket
import time
from collections.abc import Iterator
from threading import Thread

import pytest
from websockets.sync.client import ClientConnection
from websockets.sync.server import ServerConnection, serve

from haply_service import MockService, circling
from tangible_core.data import NO_FORCE, Finding, Force, Unit
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.testing import run_checks
from tangible_devices.haply.haply import Haply
from tangible_devices.haply.link import HaplyLink
from tangible_devices.haply.service import Answer, Session

ZERO = {"x": 0.0, "y": 0.0, "z": 0.0}


def command(force: dict[str, float], device_id: str = "049D") -> dict:
    return {"inverse3": [{"device_id": device_id, "commands": {"set_cursor_force": {"vector": force}}}]}


@pytest.fixture
def service() -> Iterator[MockService]:
    with MockService() as service:
        yield service


def test_haply_conforms(service: MockService):
    failed = [each for each in run_checks("device", "haply", uri=service.uri) if not each.passed]
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
        assert state.velocity_m_per_s == (0.1, 0.2, 0.3)
        assert state.buttons == 1

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

    def test_force_reaches_motors_and_lapses_in_silence(self, service: MockService):
        service.lapse_s = 30.0  # no machine is so slow
        with Haply(uri=service.uri).open() as link:
            link.write(Force(0.0, 0.0, 1.5))
            link.read()
            assert service.force() == (0, 0, 1.5)
            service.lapse_s = 0.05
            time.sleep(0.1)
            assert service.force() == NO_FORCE

    def test_close_leaves_no_force_at_motors(self, service: MockService):
        service.lapse_s = 60.0
        link = Haply(uri=service.uri).open()
        link.write(Force(0.0, 0.0, 1.5))
        link.close()
        assert service.force() == NO_FORCE
        assert service.messages[-1] == command(ZERO)

    def test_force_limit_is_that_of_the_option(self, service: MockService):
        with Haply(uri=service.uri, max_force_n=3.0).open() as link:
            link.write(Force(0.0, 30.0, 40.0))
            assert link.applied == pytest.approx((0, 1.8, 2.4))

    def test_arm_is_chosen_by_its_id(self):
        with MockService(arms=("049D", "05DA"), lapse_s=60.0) as service:
            with Haply(uri=service.uri, device_id="05DA").open() as link:
                link.write(Force(0.0, 0.0, 1.0))
                link.read()
                assert service.force("05DA") == (0, 0, 1)
                assert service.force("049D") == NO_FORCE
            with pytest.raises(DeviceError, match="no Inverse3 '1234'; there are 049D, 05DA"):
                Haply(uri=service.uri, device_id="1234").open()

    def test_mock_velocity_matches_its_positions(self):
        (x, y, _), (vx, vy, _) = circling(0.3)
        (x1, y1, _), _ = circling(0.3 + 1e-6)
        assert ((x1 - x) / 1e-6, (y1 - y) / 1e-6) == pytest.approx((vx, vy), rel=1e-3)


class RecordingSession:
    """A session that records its calls, and fails after `fails` is set."""

    def __init__(self) -> None:
        self.steps: list[object] = []
        self.owed, self.fails = 0, False

    @property
    def waits(self) -> bool:
        return self.owed > 0

    def send(self, device_id: str, force_n: tuple[float, float, float]) -> None:
        self._step(tuple(force_n))
        self.owed += 1

    def newest(self, device_id: str) -> Answer:
        self._step("answer")
        self.owed = 0
        return Answer((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0)

    def close(self) -> None:
        self.steps.append("close")

    def _step(self, what: object) -> None:
        self.steps.append(what)
        if self.fails:
            raise DeviceError("the service closed the connection; open the device again")


@pytest.mark.usefixtures("unchecked_shapes")
class TestSteps:
    """The calls of a link to its session, in order."""

    def link_and_session(self) -> tuple[HaplyLink, RecordingSession]:
        session = RecordingSession()
        return HaplyLink(session, "049D", (0.0, 0.0, 0.0), 5.0), session  # pyright: ignore[reportArgumentType]

    def test_link_never_owes_more_than_one_answer(self):
        link, session = self.link_and_session()
        for size in (1.0, 2.0, 3.0):
            link.write(Force(0.0, 0.0, size))
        link.read()
        assert session.steps == [(0, 0, 1), "answer", (0, 0, 2), "answer", (0, 0, 3), "answer"]

    def test_link_closed_waits_for_answer_to_zero_force(self):
        link, session = self.link_and_session()
        link.write(Force(0.0, 0.0, 1.0))
        del session.steps[:]
        link.close()
        link.close()
        assert session.steps == ["answer", (0, 0, 0), "answer", "close"]

    @pytest.mark.parametrize("call", ["read", "write"])
    def test_link_with_failed_force_applies_none(self, call: str):
        link, session = self.link_and_session()
        link.write(Force(0.0, 0.0, 1.0))
        assert link.applied == (0, 0, 1)
        session.fails = True
        with pytest.raises(DeviceError, match="closed the connection"):
            link.read() if call == "read" else link.write(Force(0.0, 0.0, 2.0))
        assert link.applied == NO_FORCE
        link.close()
        assert session.steps[-1] == "close"
        assert link.applied == NO_FORCE


class TestFaults:
    def test_session_newest_answer_is_the_last_owed(self):
        places = iter([(float(place), 0.0, 0.0) for place in range(10)])
        with MockService(motion=lambda _: (next(places), (0.0, 0.0, 0.0))) as service:
            session = Session(service.uri, 5.0)
            for _ in range(3):
                session.send("049D", (0.0, 0.0, 0.0))
            assert session.newest("049D").position_m == (3, 0, 0)
            assert not session.waits
            session.close()

    def test_session_waits_for_answer_until_timeout(self, service: MockService, monkeypatch: pytest.MonkeyPatch):
        waited: list[float | None] = []
        recv = ClientConnection.recv

        def recorded(self: ClientConnection, timeout: float | None = None) -> object:
            waited.append(timeout)
            return recv(self, timeout)

        monkeypatch.setattr(ClientConnection, "recv", recorded)
        with Haply(uri=service.uri, timeout_s=7.5).open() as link:
            link.read()
        assert set(waited) == {7.5}

    def test_open_without_service_names_what_to_start(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            uri = f"ws://127.0.0.1:{taken.getsockname()[1]}"
            with pytest.raises(DeviceAbsent, match=r"no Haply service listens there .*; start Haply Hub"):
                Haply(uri=uri).open()

    def test_open_without_arm_names_what_to_plug_in(self):
        with MockService(arms=()) as service, pytest.raises(DeviceAbsent, match="plug in its USB cable"):
            Haply(uri=service.uri).open()

    def test_open_without_library_names_what_to_install(self, monkeypatch: pytest.MonkeyPatch):
        monkeypatch.setitem(__import__("sys").modules, "websockets.sync.client", None)
        with pytest.raises(DeviceAbsent, match=r"pip install websockets"):
            Haply().open()

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
        with pytest.raises(DeviceError, match="no longer answers; restart it"):
            link.read()
        assert link.applied == NO_FORCE
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

    def test_read_from_unplugged_arm_is_refused(self, service: MockService):
        link = Haply(uri=service.uri).open()
        link.read()
        service.arms.clear()
        with pytest.raises(DeviceError, match="Inverse3 049D was unplugged"):
            link.read()
        link.close()

    @pytest.mark.usefixtures("unchecked_shapes")
    @pytest.mark.parametrize(
        "answer",
        [
            "not json",
            "[]",
            '{"inverse3": [{"device_id": "049D"}]}',
            '{"inverse3": [{"device_id": "049D", "state": {}}]}',
            '{"inverse3": [{"device_id": "049D", "state": {"cursor_position": {"x": 0, "y": 0}}}]}',
            '{"inverse3": [{"device_id": "049D", "state": {"cursor_position": {"x": NaN, "y": 0, "z": 0}}}]}',
            '{"inverse3": [{"device_id": "049D", "state": {"cursor_position": [0, 0, 0]}}]}',
            '{"inverse3": [{"device_id": "049D", "state": [0, 0, 0]}]}',
            '{"inverse3": ["state"]}',
            '{"inverse3": "none"}',
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
    def test_connected_lists_arms(self):
        with MockService(arms=("049D", "05DA")) as service:
            assert Haply(uri=service.uri).connected() == (
                Unit("inverse3", "049D", "COM12"),
                Unit("inverse3", "05DA", "COM12"),
            )
            assert service.messages == []

    def test_doctor_repeats_the_arm_s_problem(self, service: MockService):
        service.status |= {"power_supply": False, "calibrated": False}
        findings = list(Haply(uri=service.uri).examine())
        assert findings[0] == Finding("service", "fine", f"answers at {service.uri}")
        assert findings[1].verdict == "failed"
        assert "plug in its power supply" in findings[1].says and "not calibrated" in findings[1].says

    def test_doctor_finds_nothing_wrong(self, service: MockService):
        assert {each.verdict for each in Haply(uri=service.uri).examine()} == {"fine"}

    def test_doctor_without_service_has_not_asked(self):
        [finding] = Haply(uri="ws://127.0.0.1:9").examine()
        assert finding.verdict == "not asked"

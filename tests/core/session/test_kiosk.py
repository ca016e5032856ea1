"""A kiosk whose device may be unplugged and return: no force is left, and no tick is lost or counted twice."""

import signal
from contextlib import closing
from functools import partial
from pathlib import Path
from socket import AF_UNIX, SOCK_DGRAM, socket
from threading import Event

import numpy as np
import pytest

from ctrl_c import hearing
from loop_devices import Circling, Failing
from loop_scenes import SOFT_N_PER_M, proxy
from tangible_core.data import NO_FORCE, TICK_COLUMNS, Force, HapticState, ServoReport, TickFlag
from tangible_core.errors import DeviceError
from tangible_core.plugins.interfaces import PlainTouch
from tangible_core.servo import OVER, Safety
from tangible_core.session import INTERRUPTED, STOPPED, Slot, run_kiosk
from tangible_core.session.kiosk import kiosk

AT_ONCE = Safety(ramp_s=0, max_step_n=10, stale_s=1.0, passivity="off")  # late ticks change nothing
pytestmark = pytest.mark.usefixtures("patient")
TIME_S, PROXY_Z_M, FORCE_Z_N, FLAGS = (TICK_COLUMNS.index(name) for name in ("time_s", "proxy_z_m", "fz_n", "flags"))


soft = partial(proxy, stiffness_n_per_m=SOFT_N_PER_M)


@pytest.fixture
def no_pause(monkeypatch: pytest.MonkeyPatch) -> None:
    """Search for a device again without a pause."""
    monkeypatch.setattr(kiosk, "FIRST_PAUSE_S", 0.01)


@pytest.mark.usefixtures("loop_in_thread")
def test_kiosk_rotates_scenes_with_their_own_limits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    heard = socket(AF_UNIX, SOCK_DGRAM)
    heard.bind(str(tmp_path / "systemd"))
    heard.setblocking(False)
    monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "systemd"))
    caplog.set_level("INFO", "tangible_core.session.kiosk")
    kept: list[np.ndarray] = []
    stop = Event()

    def keep(rows: np.ndarray) -> None:
        kept.append(rows)
        if sum(int((each[:, FLAGS].astype(int) & TickFlag.SWAPPED != 0).sum()) for each in kept) == 2:
            stop.set()

    tighter = AT_ONCE.model_copy(update={"max_force_n": 0.08})
    turns = [Slot(soft(0.05), AT_ONCE, name="forest"), Slot(soft(0.06), tighter, name="harbour")]
    last = run_kiosk(turns, Circling(), 60.0, each_s=0.2, keep=keep, stop=stop)
    rows = np.concatenate(kept)
    assert (last.stopped, last.ticks) == (STOPPED, len(rows))
    first, second = np.flatnonzero(rows[:, FLAGS].astype(int) & TickFlag.SWAPPED)
    assert rows[first, TIME_S] >= 0.2 and rows[second, TIME_S] - rows[first, TIME_S] >= 0.2
    scenes = rows[:first], rows[first:second], rows[second:]
    found = [(np.median(scene[:, PROXY_Z_M]), scene[:, FORCE_Z_N].max()) for scene in scenes]
    np.testing.assert_allclose(found, [(0.05, 0.1), (0.06, 0.08), (0.05, 0.1)], atol=1e-6)
    with closing(heard):
        said = [heard.recv(200).decode() for _ in range(3)]
    assert said[:2] == ["READY=1\nSTATUS=on the device: forest", "WATCHDOG=1"]
    assert [text.rpartition(": ")[2] for text in caplog.messages[:2]] == ["forest", "harbour"]


@pytest.mark.usefixtures("no_pause")
def test_kiosk_waits_for_a_lost_device_without_force(tmp_path: Path) -> None:
    """It answers 99 times each time it is opened."""
    force = tmp_path / "force"
    kept: list[np.ndarray] = []
    said: list[str] = []
    left: list[float] = []
    reports: list[ServoReport] = []
    stop = Event()

    def wait(text: str) -> None:
        said.append(text)
        if text.startswith("no force"):
            left.append(float(force.read_text()))
        if len(left) == 2:
            stop.set()

    device = Failing(record=str(force))
    last = run_kiosk(
        [Slot(soft(), AT_ONCE)], device, keep=kept.append, on_report=reports.append, on_wait=wait, stop=stop
    )
    gone = "no force; waiting for the device: the failing device does not answer; plug it in"
    assert said == [gone, "the device is back; the session goes on", gone]
    assert left == [0, 0]
    assert (last, last.stopped, last.ticks, last.contact_share) == (reports[-1], STOPPED, 198, 1.0)
    rows = np.concatenate(kept)
    stale = rows[:, FLAGS].astype(int) & TickFlag.STALE != 0
    assert np.flatnonzero(stale).tolist() == [99, 199]
    assert (rows[:, FORCE_Z_N] > 0).tolist() == (~stale).tolist()
    assert (np.diff(rows[:, TIME_S]) > 0).all()
    assert last.time_s == rows[-2, TIME_S] > 0.3  # a new loop takes as long to start
    assert last.work_j == pytest.approx(0, abs=1e-9)


@pytest.mark.usefixtures("no_pause")
@pytest.mark.usefixtures("loop_in_thread")
def test_kiosk_waits_for_a_device_that_is_absent_at_first(tmp_path: Path) -> None:
    said: list[str] = []
    device = Failing(fault="none", opens="second", record=str(tmp_path / "force"))
    last = run_kiosk([Slot(soft(), AT_ONCE)], device, 0.1, on_wait=said.append)
    assert (last.stopped, last.ticks, len(said)) == (OVER, 100, 2)
    assert "in use by another program" in said[0]


@pytest.mark.usefixtures("loop_in_thread")
def test_kiosk_goes_on_without_a_device_while_it_waits() -> None:
    last = run_kiosk([Slot(soft(), AT_ONCE)], Failing(), 0.5, on_wait=lambda _: None)
    assert (last.stopped, last.ticks) == (OVER, 99)
    last = run_kiosk([Slot(soft(), AT_ONCE)], Failing())
    assert (last.stopped, last.ticks) == ("the failing device does not answer; plug it in", 99)


@pytest.mark.usefixtures("loop_in_thread")
def test_kiosk_ends_on_a_scene_that_cannot_be_sent(tmp_path: Path) -> None:
    class Local(PlainTouch):
        """A touch of a local class, which no other process can import."""

        def force(self, state: HapticState) -> Force:
            return NO_FORCE

    record = tmp_path / "force"
    device = Failing(fault="none", record=str(record))
    with pytest.raises(DeviceError, match="cannot be sent to the force loop"):
        run_kiosk([Slot(soft(), AT_ONCE), Slot(Local(), AT_ONCE)], device, each_s=0.05, on_wait=pytest.fail)
    assert float(record.read_text()) == 0


def test_kiosk_on_ctrl_c_while_waiting_ends() -> None:
    reports: list[ServoReport] = []
    with hearing():
        last = run_kiosk(
            [Slot(soft(), AT_ONCE)],
            Failing(),
            5.0,
            on_report=reports.append,
            on_wait=lambda _: signal.raise_signal(signal.SIGINT),
        )
    assert (last, last.stopped, last.ticks) == (reports[-1], INTERRUPTED, 99)


def test_kiosk_reports_a_reason_once_and_searches_less_and_less_often(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kiosk, "FIRST_PAUSE_S", 1e-3)
    monkeypatch.setattr(kiosk, "LONGEST_PAUSE_S", 3e-3)
    said: list[str] = []
    wait = kiosk.DeviceWait(said.append)
    pauses: list[float] = []
    for why in ("it is out", "it is out", "it is in use"):
        pauses.append(wait._pause_s)
        assert wait.pause(why, str) == ""
    assert [each.partition("device: ")[2] for each in said] == ["it is out", "it is in use"]
    assert pauses == [1e-3, 2e-3, 3e-3]

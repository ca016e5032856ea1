"""Sessions in real time: every tick is kept, and whatever ends one leaves no force and a readable file."""

import signal
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ctrl_c import hearing
from full_disk import files_up_to
from loop_devices import Circling, Failing
from tangible_core import HapticSurface, load_method
from tangible_core.data import ServoReport
from tangible_core.errors import OutputError
from tangible_core.plugins.interfaces import Touch
from tangible_core.servo import OVER, Ring, Safety, Servo
from tangible_core.servo.ticks import cycle
from tangible_core.servo.ticks.loop import sections
from tangible_core.session import INTERRUPTED, Recording, RingDrain, figures, keeping, run_in_real_time
from tangible_core.session.recording.tick_file import About

pytestmark = pytest.mark.usefixtures("patient")


@pytest.fixture(scope="module")
def touch() -> Touch:
    return load_method("render", "proxy")().touch(HapticSurface.from_heights(np.full((16, 16), 0.002, np.float32)))


def test_session_records_every_tick_and_reports_ten_times_a_second(touch: Touch, tmp_path: Path) -> None:
    reports: list[ServoReport] = []
    began_s: list[float] = []
    kept_at: list[int] = []
    with keeping(tmp_path / "hand.nc", About("circling", "proxy", "")) as writer:

        def keep(rows: np.ndarray) -> None:
            kept_at.append(len(rows))
            writer.append(rows)

        last = run_in_real_time(
            touch, Circling(), 1.0, Safety(), reports.append, keep, lambda _: began_s.append(time.monotonic())
        )
        took_s = time.monotonic() - began_s[0]
        writer.close()
    kept = Recording.load(tmp_path / "hand.nc")
    assert (last.ticks, len(kept.rows), last.stopped, kept.stopped) == (1000, 1000, OVER, "")
    assert len(kept_at) / 2 <= len(reports) <= took_s / 0.1 + 2  # one at every second look, however late these come
    assert figures(last)["peak_force_n"] == pytest.approx(kept.peak_force_n, rel=1e-6)
    assert figures(last)["contact_share"] == kept.figures()["contact_share"]
    middle_n = kept.figures()["median_contact_force_n"]
    assert figures(last)["median_contact_force_n"] == pytest.approx(middle_n, abs=1e-3) != 0
    assert figures(last)["work_j"] == pytest.approx(kept.work_j, abs=1e-9)
    assert 0 < figures(last)["ramping"] <= 500  # by the clock: late ticks are fewer


@pytest.mark.parametrize("name", ["hand.npz", "hand.csv"])
@pytest.mark.usefixtures("loop_in_thread")
def test_keeping_converts_other_suffixes_at_the_end(touch: Touch, tmp_path: Path, name: str) -> None:
    with keeping(tmp_path / name, About("circling", "proxy", "")) as writer:
        run_in_real_time(touch, Circling(), 0.2, Safety(), lambda _: None, writer.append)
    assert len(Recording.load(tmp_path / name).rows) == 200
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_keeping_leaves_the_nc_file_if_the_conversion_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OutputError("no room; free some space")

    monkeypatch.setattr(Recording, "save", full)
    with pytest.raises(OutputError, match="no room"), keeping(tmp_path / "hand.csv", About()) as writer:
        writer.append(np.ones((3, 17)))
    assert len(Recording.load(tmp_path / "hand.csv.nc").rows) == 3


@pytest.mark.usefixtures("unchecked_shapes")
def test_drain_logs_overwritten_ticks_and_keeps_the_others(caplog: pytest.LogCaptureFixture) -> None:
    firsts: list[int] = []

    def since(first: int) -> tuple[np.ndarray, int]:
        firsts.append(first)
        return np.zeros((3, 17)), first + 5

    kept: list[np.ndarray] = []
    servo: Any = SimpleNamespace(ring=SimpleNamespace(since=since))
    drain = RingDrain(servo, kept.append)
    drain.look()
    drain.look()
    assert (firsts, len(kept)) == ([0, 5], 2)
    assert caplog.text.count("2 ticks were overwritten before they could be recorded") == 2


def write_ticks(ring: Ring, count: int) -> None:
    """Write more ticks, whose first value is the number of the tick."""
    for number in range(ring.count, ring.count + count):
        row = np.zeros(17)
        row[0] = number
        cycle.finish(sections(ring), row, number * 1_000_000, 0)


@pytest.fixture
def loop_part(touch: Touch) -> Iterator[Servo]:
    """The part of a loop that a drain uses."""
    servo = Servo(touch, Circling())
    servo._ring = Ring.create(64)
    yield servo
    servo.ring.remove()


def test_drain_starts_at_its_first_tick_and_passes_each_tick_once(loop_part: Servo) -> None:
    kept: list[np.ndarray] = []
    write_ticks(loop_part.ring, 100)
    drain = RingDrain(loop_part, kept.append, loop_part.ring.count)
    drain.look()
    assert kept == [], "of what was before, nothing"
    for count in (1, 0, 30):
        write_ticks(loop_part.ring, count)
        drain.look()
    loop_part.ring.remove()  # the loop has ended
    drain.look()
    assert [rows[:, 0].tolist() for rows in kept] == [[100], list(range(101, 131))]


def test_drain_passes_unrecorded_ticks_again(loop_part: Servo) -> None:
    kept: list[np.ndarray] = []
    full = [OutputError("no room")]

    def keep(rows: np.ndarray) -> None:
        if full:
            raise full.pop()
        kept.append(rows)

    drain = RingDrain(loop_part, keep)
    write_ticks(loop_part.ring, 5)
    with pytest.raises(OutputError, match="no room"):
        drain.look()
    write_ticks(loop_part.ring, 5)
    drain.look()
    assert [rows[:, 0].tolist() for rows in kept] == [list(range(10))]


@pytest.mark.usefixtures("loop_in_thread")
def test_session_on_full_disk_ends_without_force(touch: Touch, tmp_path: Path) -> None:
    force = tmp_path / "force"
    device = Failing(fault="none", record=str(force))
    with (
        pytest.raises(OutputError, match="free some space"),
        keeping(tmp_path / "hand.nc", About("failing", "proxy", "")) as writer,
    ):

        def keep(rows: np.ndarray) -> None:
            with files_up_to(20_000):
                for part in np.split(rows, range(10, len(rows), 10)):  # a late look comes for more than there is room
                    writer.append(part)

        run_in_real_time(touch, device, 5.0, Safety(ramp_s=0), lambda _: None, keep)
    assert float(force.read_text()) == 0
    kept = Recording.load(tmp_path / "hand.nc")
    assert len(kept.rows) > 50
    assert kept.stopped.startswith("the recording ends early")


def test_session_on_ctrl_c_ends_without_force_and_keeps_its_ticks(touch: Touch, tmp_path: Path) -> None:
    force = tmp_path / "force"
    reports: list[ServoReport] = []
    with keeping(tmp_path / "hand.nc", About("failing", "proxy", "")) as writer:

        def keep(rows: np.ndarray) -> None:
            first = not writer.ticks
            writer.append(rows)
            if first:
                signal.raise_signal(signal.SIGINT)

        with hearing():
            last = run_in_real_time(
                touch, Failing(fault="none", record=str(force)), None, Safety(), reports.append, keep
            )
        writer.close(last.stopped)
    assert last.stopped == INTERRUPTED
    assert [report for report in reports if report.ticks] == [last]  # it ended before the first one was due
    assert float(force.read_text()) == 0
    kept = Recording.load(tmp_path / "hand.nc")
    assert kept.stopped == INTERRUPTED
    assert len(kept.rows) == last.ticks  # each once, those too that came between the last look and the end
    assert (np.diff(kept.time_s) > 0).all()

"""The session that all tabs share: what is felt and told, and what its end closes."""

import asyncio
from collections.abc import Callable, Coroutine
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sessions import Heard, InlineWorker, run_in_session
from tangible_core import load_method
from tangible_core.errors import DeviceError, OutputError
from tangible_ui.feeling.choice import Choice, NotConfirmed
from tangible_ui.state.scheduling import LatestWins, LongJobs
from tangible_ui.state.session import Session

Check = Callable[[Session, Heard], Coroutine[Any, Any, None]]


@pytest.fixture
def with_session(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[Check], None]:
    """Runs a test with a session without processes, and a tab."""
    monkeypatch.setattr("tangible_ui.state.session.Worker", InlineWorker)
    monkeypatch.setenv("TANGIBLE_DATA_DIR", str(tmp_path / "data"))

    return partial(run_in_session, tmp_path, sets=["device={use: mock}"])


class Touch(SimpleNamespace):
    """The input of a loop that keeps whether its file was removed."""

    def __init__(self, *, own_hand: bool = True) -> None:
        self.discarded = 0
        device = load_method("device", "mock")()
        super().__init__(own_hand=own_hand, unmapped_device=device, touch=SimpleNamespace(discard=self.discard))

    def discard(self) -> None:
        self.discarded += 1


def feeling(running: bool, error: Exception | None = None) -> Any:
    def feel(_: Any) -> float:
        if error is not None:
            raise error
        return 0.5

    return SimpleNamespace(feel=feel, running=running)


@pytest.mark.parametrize(
    ("error", "running", "told"),
    [
        (DeviceError("pulled out"), False, (False, "pulled out", True)),
        (OutputError("no room"), False, (False, "no room", False)),
        (OutputError("no room"), True, None),
    ],
)
def test_touch_that_fails_is_told_as_the_end_of_a_loop_only_if_it_ended(
    with_session: Callable[[Check], None], error: Exception, running: bool, told: tuple[bool, str, bool] | None
) -> None:
    async def check(session: Session, tab: Heard) -> None:
        session.feeling, felt = feeling(running, error), Touch()
        with pytest.raises(type(error)):
            await session.put(felt)  # pyright: ignore[reportArgumentType]
        found = [(each["running"], each["why"], each["lost"]) for each in tab.events if each["event"] == "loop"]
        assert found == ([] if told is None else [told])

    with_session(check)


def test_touch_without_consent_or_for_another_device_is_discarded(with_session: Callable[[Check], None]) -> None:
    async def check(session: Session, tab: Heard) -> None:
        session.feeling = feeling(running=True)

        def refuses(_: Any) -> None:
            raise NotConfirmed("it has a motor")

        unsure = SimpleNamespace(check=refuses, kind="document")
        session.choice, felt = unsure, Touch(own_hand=False)  # pyright: ignore[reportAttributeAccessIssue]
        with pytest.raises(NotConfirmed):
            await session.put(felt)  # pyright: ignore[reportArgumentType]
        assert felt.discarded == 1
        for kind, own_hand in (("hand", False), ("document", True), ("other", True)):
            chosen = SimpleNamespace(check=lambda _: None, kind=kind)
            session.choice, felt = chosen, Touch(own_hand=own_hand)  # pyright: ignore[reportAttributeAccessIssue]
            assert await session.put(felt) is None  # pyright: ignore[reportArgumentType]
            assert felt.discarded == 1

    with_session(check)


def test_chosen_device_overrides_that_of_the_command_line(with_session: Callable[[Check], None]) -> None:
    async def check(session: Session, tab: Heard) -> None:
        session.choice = Choice("other", "falcon", sure=True)
        sets = session.felt_sets()
        assert sets[0] == "device={use: mock}"
        assert "falcon" in str(sets[1:])

    with_session(check)


def test_event_has_its_time_to_the_millisecond(
    with_session: Callable[[Check], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    async def check(session: Session, tab: Heard) -> None:
        monkeypatch.setattr("tangible_ui.state.session.time.time", lambda: 12.34567)
        session.tell("plan", slow=[])
        assert tab.last("plan") == {"event": "plan", "at_s": 12.346, "slow": []}

    with_session(check)


def test_failure_in_the_background_is_told_by_its_sentence(with_session: Callable[[Check], None]) -> None:
    async def check(session: Session, tab: Heard) -> None:
        async def fail() -> None:
            raise DeviceError("the device is gone")

        session.begin(fail())
        while "error" not in tab.names():
            await asyncio.sleep(0.001)
        assert tab.last("error")["text"] == "the device is gone"

    with_session(check)


def test_history_is_in_the_order_of_its_events(
    with_session: Callable[[Check], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    async def check(session: Session, tab: Heard) -> None:
        times = iter(range(100))
        monkeypatch.setattr("tangible_ui.state.session.time.time", lambda: float(next(times)))
        order = ["log", "touch", "plan", "log", "error", "document"]
        for event in order:
            session.tell(event)
        session.tell("scene", digest="x")  # which a tab gets by itself
        assert [each["event"] for each in session.history] == order

    with_session(check)


@pytest.mark.parametrize("fails", [False, True])
def test_end_of_a_session_closes_everything_whatever_fails(
    with_session: Callable[[Check], None], monkeypatch: pytest.MonkeyPatch, fails: bool
) -> None:
    async def check(session: Session, tab: Heard) -> None:
        ended: list[str] = []

        def stop() -> None:
            ended.append("force")
            if fails:
                raise DeviceError("does not answer")

        monkeypatch.setattr(session.feeling, "stop", stop)
        monkeypatch.setattr(session.laws.comparison, "close", lambda: ended.append("other law"))
        session.recorder = SimpleNamespace(stop=lambda: ended.append("recording"))  # pyright: ignore[reportAttributeAccessIssue]
        if fails:
            with pytest.raises(DeviceError):
                await session.close()
        else:
            await session.close()
        assert session.feeling.stopped
        assert ended == ["force", "other law", "recording"]

    with_session(check)


def test_drawings_of_dragged_heights_have_a_pause_between_them(
    with_session: Callable[[Check], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    async def check(session: Session, tab: Heard) -> None:
        for queue, pause_s in ((session.heights, 0.0), (session.strokes, 0.0), (session.drawn, 0.4)):
            rests: list[float] = []

            async def rest(seconds: float, rests: list[float] = rests) -> None:
                rests.append(seconds)

            async def work() -> int:
                return 1

            with monkeypatch.context() as patch:
                patch.setattr("tangible_ui.state.scheduling.asyncio.sleep", rest)
                assert [await queue.run(work) for _ in range(2)] == [1, 1]
            assert sum(rests) == pytest.approx(pause_s, abs=0.1)

    with_session(check)


def test_queue_rests_after_a_call_that_failed_too() -> None:
    async def check() -> None:
        queue, times = LatestWins(0.2), []

        async def work() -> None:
            times.append(asyncio.get_running_loop().time())
            raise DeviceError("gone")

        for _ in range(2):
            with pytest.raises(DeviceError):
                await queue.run(work)
        assert np.diff(times)[0] > 0.19

    asyncio.run(check())


def test_stop_of_all_jobs_drops_the_edit_that_waited_for_them() -> None:
    jobs = LongJobs()
    number, jobs.apply_after = jobs.begin(), True
    jobs.stop()
    assert (jobs.apply_after, jobs.killed, jobs.newest > number) == (False, True, True)

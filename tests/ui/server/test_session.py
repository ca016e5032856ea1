"""The session that all tabs share: otherwise its end leaves a force, or a tab is told of another state."""

import asyncio
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sessions import Heard, InlineWorker
from tangible_core import load_method
from tangible_core.errors import DeviceError, OutputError
from tangible_ui.feeling.choice import NotConfirmed
from tangible_ui.feeling.feeling import Feeling
from tangible_ui.state.session import LatestWins, Session

pytestmark = pytest.mark.anyio


@pytest.fixture
async def session(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Session:
    """A session without processes."""
    monkeypatch.setattr("tangible_ui.state.session.Worker", InlineWorker)
    monkeypatch.setenv("TANGIBLE_DATA_DIR", str(tmp_path / "data"))
    return Session(tmp_path, Feeling("none"), ["device={use: mock}"])


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
async def test_touch_that_fails_is_told_as_the_end_of_a_loop_only_if_it_ended(
    session: Session, tab: Heard, error: Exception, running: bool, told: tuple[bool, str, bool] | None
) -> None:
    session.feeling, felt = feeling(running, error), Touch()
    with pytest.raises(type(error)):
        await session.put(felt)  # pyright: ignore[reportArgumentType]
    found = [(event["running"], event["why"], event["lost"]) for event in tab.events if event["event"] == "loop"]
    assert found == ([] if told is None else [told])


async def test_touch_without_consent_or_for_another_device_is_discarded(session: Session) -> None:
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


async def test_failure_in_the_background_is_told_by_its_sentence(session: Session, tab: Heard) -> None:
    async def fail() -> None:
        raise DeviceError("the device is gone")

    session.begin(fail())
    while "error" not in tab.names():
        await asyncio.sleep(0.001)
    assert tab.last("error")["text"] == "the device is gone"


@pytest.mark.parametrize("fails", [False, True])
async def test_end_of_a_session_closes_everything_whatever_fails(
    session: Session, monkeypatch: pytest.MonkeyPatch, fails: bool
) -> None:
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
    assert session.feeling.is_stopped
    assert ended == ["force", "other law", "recording"]


async def test_queue_rests_after_a_call_that_failed_too() -> None:
    queue, times = LatestWins(0.2), []

    async def work() -> None:
        times.append(asyncio.get_running_loop().time())
        raise DeviceError("gone")

    for _ in range(2):
        with pytest.raises(DeviceError):
            await queue.run(work)
    assert np.diff(times)[0] > 0.19


async def test_call_that_is_overtaken_is_answered_while_another_one_runs() -> None:
    """Otherwise a slow worker keeps a dragging tab waiting for so many answers that the newest is refused."""
    queue, may_end = LatestWins(), asyncio.Event()
    running = asyncio.ensure_future(queue.run(may_end.wait))
    waiting = [asyncio.ensure_future(queue.run(partial(asyncio.sleep, 0, k))) for k in range(40)]
    assert await asyncio.gather(*waiting[:-1]) == [None] * 39
    assert not running.done()
    may_end.set()
    assert await waiting[-1] == 39

"""Requests of tabs, without worker and loop: otherwise a click does something else, or overwrites a file."""

import asyncio
from collections.abc import Callable, Coroutine
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from sessions import Heard
from tangible_core.data import TICK_COLUMNS
from tangible_core.errors import ConfigError, DeviceError, Stopped, TangibleError
from tangible_core.servo.ring import PERIOD_NS, SPINS
from tangible_ui.feeling.feeling import Feeling
from tangible_ui.requests import devices, find_request, making, preflight
from tangible_ui.requests import document as asks_document
from tangible_ui.state.document import Text
from tangible_ui.state.session import Session
from tangible_ui.worker.handle import WorkerKilled

Ask = Callable[..., Coroutine[Any, Any, Any]]
pytestmark = pytest.mark.anyio


class Answers:
    """A worker whose answers a test sets by job; each is a value, an error, or a function of the arguments."""

    def __init__(self, *_: Any) -> None:
        self.answers: dict[str, Any] = {
            "check": lambda text, path, sets: {"digest": f"digest of {text}", "complaints": [], "text": text},
            "begin": lambda files: {"text": f"text of {files[0].name}", "path": files[0]},
            "plan": {"slow": [], "refusal": ""},
            "save": None,
            "give_way": False,
        }
        self.asked: list[tuple[str, dict[str, Any]]] = []
        self.kills = 0

    async def ask(self, job: str, **told: Any) -> Any:
        self.asked.append((job, told))
        answer = self.answers[job]
        found = answer(**told) if callable(answer) else answer
        found = await found if asyncio.iscoroutine(found) else found
        if isinstance(found, BaseException):
            raise found
        return found

    quick = ask

    def kill(self) -> None:
        self.kills += 1

    def jobs(self) -> list[str]:
        return [job for job, _ in self.asked]


@pytest.fixture
async def session(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Session:
    """A session without processes, that no tab has entered yet."""
    monkeypatch.setattr("tangible_ui.state.session.Worker", Answers)
    monkeypatch.setenv("TANGIBLE_DATA_DIR", str(tmp_path / "data"))
    session = Session(tmp_path, Feeling("none"), [])
    session.document.path = tmp_path / "mine.yaml"
    return session


@pytest.fixture
def ask(session: Session, tab: Heard) -> Ask:
    """Sends requests of the tab."""

    async def ask(request: str, /, **told: Any) -> Any:
        return await find_request(request)(session, tab, **told)

    return ask


def worker(session: Session) -> Any:
    return session.worker


class TestDevices:
    async def test_device_that_is_away_is_looked_for_less_and_less(
        self, session: Session, tab: Heard, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        pauses: list[float] = []
        whys = ["unplugged"] * 3 + ["in use"] * 2 + ["unplugged"]

        async def make(session: Session, tab: Any) -> None:
            if len(pauses) >= len(whys):
                session.feeling.is_stopped = True
                return
            raise DeviceError(whys[len(pauses)])

        async def rest(seconds: float) -> None:
            pauses.append(seconds)

        monkeypatch.setattr(devices, "make", make)
        monkeypatch.setattr(devices, "asyncio", SimpleNamespace(sleep=rest))
        await devices._wait(session)  # pyright: ignore[reportPrivateUsage]
        assert pauses == [1.0, 2.0, 4.0, 8.0, 8.0, 8.0]
        told = [(event["why"], event["waiting"]) for event in tab.events if event["event"] == "loop"]
        assert told == [("unplugged", True), ("in use", True), ("unplugged", True)]

    async def test_limits_are_counted(self, session: Session, ask: Ask) -> None:
        assert await ask("limits") is None
        report = SimpleNamespace(ticks=5000, overruns=3, flagged={"force": 7})
        session.feeling = Mock(Feeling, servo=SimpleNamespace(report=lambda: report))
        assert await ask("limits") == {"ticks": 5000, "overruns": 3, "flagged": {"force": 7}}


class TestDocument:
    async def test_document_is_saved_under_its_whole_name_and_over_no_other_file(
        self, session: Session, ask: Ask, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def saved_at() -> Path:
            return next(told["out"] for job, told in reversed(worker(session).asked) if job == "save")

        monkeypatch.chdir(tmp_path)
        for name in ("mine.yaml", "other.yml", "vase.yaml"):
            (tmp_path / name).touch()
        await ask("save", path="mine.yaml")  # its own file
        assert saved_at() == tmp_path / "mine.yaml"
        await ask("save", path="vase.2")
        assert saved_at() == session.document.path == tmp_path / "vase.2.yaml"
        for name in ("other.yml", "mine.yaml", "vase"):
            with pytest.raises(ConfigError, match="is there already"):
                await ask("save", path=name)
        await ask("save", path=str(tmp_path / "other.yml"), replace=True)
        assert saved_at() == tmp_path / "other.yml"

    async def test_draft_is_offered_until_it_is_restored(
        self, session: Session, tab: Heard, ask: Ask, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        with pytest.raises(ConfigError, match="no unsaved draft"):
            await ask("restore")
        file = tmp_path / "1.json"
        file.touch()
        draft: Any = SimpleNamespace(file=file, text=Text("mine", tmp_path / "b.yaml"), at_s=3.0)
        session.document.drafts.earlier = draft
        monkeypatch.setattr(session.document.drafts, "look", lambda: draft)
        await asks_document.offer(session)
        told = tab.last("restored")
        assert (told["path"], told["edited_s"]) == (str(tmp_path / "b.yaml"), 3.0)
        worker(session).answers["make"] = Stopped()
        await ask("restore")
        assert (session.document.text, session.document.path) == ("mine", tmp_path / "b.yaml")
        assert (tab.last("restored")["path"], session.document.drafts.earlier, file.exists()) == ("", None, False)
        assert tab.last("restored")["edited_s"] == 0.0


class TestMaking:
    async def test_edit_is_applied_if_its_plan_is_quick_and_possible(
        self, session: Session, tab: Heard, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        made: list[str] = []

        async def make(session: Session, tab: Any) -> None:
            made.append(session.document.text)

        monkeypatch.setattr(making, "make", make)
        for slow, refusal, makes in ([], "", True), (["disparity"], "", False), ([], "there is no law", False):
            worker(session).answers["plan"] = {"slow": slow, "refusal": refusal}
            made.clear()
            await making.foresee(session, apply=False)
            assert (tab.last("plan")["slow"], tab.last("plan")["refusal"], made) == (slow, refusal, [])
            await making.foresee(session, apply=True)
            assert len(made) == makes

    async def test_plan_of_an_earlier_text_is_not_sent(self, session: Session, tab: Heard) -> None:
        def edited_meanwhile(**_: Any) -> dict[str, Any]:
            session.document.digest = "later"
            return {"slow": [], "refusal": ""}

        session.document.digest = "now"
        worker(session).answers["plan"] = edited_meanwhile
        await making.foresee(session, apply=True)
        assert "plan" not in tab.names()
        assert "make" not in worker(session).jobs()

    @pytest.mark.parametrize(
        ("error", "newer", "outcome"),
        [
            (ConfigError("no law"), False, "failed"),
            (ConfigError("no law"), True, "failed"),
            (Stopped(), True, "stopped"),
            (WorkerKilled("killed"), True, "stopped"),
        ],
    )
    async def test_job_that_gave_way_is_told_as_stopped_and_a_failure_as_one(
        self, session: Session, tab: Heard, ask: Ask, error: TangibleError, newer: bool, outcome: str
    ) -> None:
        def fails(**_: Any) -> TangibleError:
            if newer:
                session.long_jobs.begin()
            return error

        worker(session).answers["make"] = fails
        if outcome == "failed":
            with pytest.raises(type(error)):
                await ask("make")
        else:
            assert await ask("make") is None
        told = tab.last("made")
        assert (told["outcome"], told["want"], told["why"], told["seconds"]) == (outcome, "touch", str(error), 0.0)


def test_loop_is_judged_by_enough_ticks() -> None:
    for ticks, judged in ((0, False), (999, False), (1000, True)):
        rows = np.zeros((ticks, len(TICK_COLUMNS)))
        rows[:, TICK_COLUMNS.index("late_s")] = 0.002
        ring = SimpleNamespace(since=lambda _, rows=rows: (rows, 0), header={PERIOD_NS: 500_000, SPINS: 1})
        running = Mock(Feeling, own_device={"use": "pointer"}, running=True, servo=SimpleNamespace(ring=ring))
        session: Any = Mock(Session, feeling=running)
        found = preflight._loop(session)  # pyright: ignore[reportPrivateUsage]
        assert found["own"] == 'device={"use": "pointer"}'
        assert (found["late"] is not None) == judged
    assert (found["late"].period_s, found["late"].real_time) == (0.0005, True)
    assert found["late"].late_s.tolist() == [0.002] * 1000


async def test_recordings_are_made_one_after_the_other(
    session: Session, tab: Heard, ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended: list[Any] = []

    class Recorder:
        def __init__(self, servo: Any, path: Path, about: Any, notify: Any) -> None:
            self.path, self.recording = path, True
            ended.append(notify)

    monkeypatch.setattr("tangible_ui.requests.feeling.Recorder", Recorder)
    felt = SimpleNamespace(law="penalty", device_name="mouse", materials="")
    session.feeling = Mock(Feeling, servo=SimpleNamespace(running=True), loop_input=felt)
    path = await ask("record")
    told = tab.last("recorder")
    assert (told["recording"], told["path"], told["ticks"], told["why"]) == (True, path, 0, "")
    with pytest.raises(ConfigError, match="is being recorded already"):
        await ask("record")
    ended[0](Path(path), 700, "stopped by hand")
    await tab.until("recorder", 2)
    told = tab.last("recorder")
    assert (told["recording"], told["ticks"], told["why"]) == (False, 700, "stopped by hand")
    recorder: Any = session.recorder
    recorder.recording = False
    await ask("record")
    assert len(ended) == 2

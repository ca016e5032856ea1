"""Requests of tabs, on a session whose worker and loop are fakes: what each asks for, tells, and leaves."""

import asyncio
from collections.abc import Callable, Coroutine
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from sessions import Heard, run_in_session
from tangible_core.data import TICK_COLUMNS
from tangible_core.errors import ConfigError, DeviceError, Stopped, TangibleError
from tangible_core.servo.ring import PERIOD_NS, SPINS
from tangible_ui.feeling.feeling import Feeling, LoopInput
from tangible_ui.requests import REQUESTS, devices, making, preflight
from tangible_ui.requests import document as asks_document
from tangible_ui.state.session import Session
from tangible_ui.state.texts import Text
from tangible_ui.worker.handle import WorkerKilled
from waiting import happened

Ask = Callable[..., Coroutine[Any, Any, Any]]
Check = Callable[[Session, Heard, Ask], Coroutine[Any, Any, None]]


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
def with_session(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[Check], None]:
    """Runs a test with a session, a tab, and a function that sends its requests."""
    monkeypatch.setattr("tangible_ui.state.session.Worker", Answers)
    monkeypatch.setenv("TANGIBLE_DATA_DIR", str(tmp_path / "data"))

    def run(check: Check) -> None:
        async def with_requests(session: Session, tab: Heard) -> None:
            session.path = tmp_path / "mine.yaml"

            async def ask(request: str, /, **told: Any) -> Any:
                return await REQUESTS[request](session, tab, **told)

            await check(session, tab, ask)

        run_in_session(tmp_path, with_requests)

    return run


def worker(session: Session) -> Any:
    return session.worker


async def settled(session: Session) -> None:
    """Wait for what runs in the background."""
    await happened(lambda: not session._tasks)  # pyright: ignore[reportPrivateUsage]


class TestDevices:
    def test_device_that_is_away_is_looked_for_less_and_less(
        self, with_session: Callable[[Check], None], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        pauses: list[float] = []
        whys = ["unplugged"] * 3 + ["in use"] * 2 + ["unplugged"]

        async def make(session: Session, tab: Any) -> None:
            if len(pauses) >= len(whys):
                session.feeling.stopped = True
                return
            raise DeviceError(whys[len(pauses)])

        async def rest(seconds: float) -> None:
            pauses.append(seconds)

        async def check(session: Session, tab: Heard, ask: Ask) -> None:
            monkeypatch.setattr(devices, "make", make)
            monkeypatch.setattr(devices, "asyncio", SimpleNamespace(sleep=rest))
            await devices._wait(session)  # pyright: ignore[reportPrivateUsage]
            assert pauses == [1.0, 2.0, 4.0, 8.0, 8.0, 8.0]
            told = [(each["why"], each["waiting"]) for each in tab.events if each["event"] == "loop"]
            assert told == [("unplugged", True), ("in use", True), ("unplugged", True)]

        with_session(check)

    def test_device_that_is_chosen_ends_a_stop_and_an_unsure_choice_changes_nothing(
        self, with_session: Callable[[Check], None], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        async def check(session: Session, tab: Heard, ask: Ask) -> None:
            async def make(session: Session, tab: Any) -> None:
                assert not session.feeling.stopped

            monkeypatch.setattr(devices, "make", make)
            worker(session).answers["about_device"] = {"simulated": False, "name": "falcon"}
            before, session.feeling.stopped = session.choice, True
            with pytest.raises(ConfigError, match="falcon has a motor"):
                await ask("choose_device", kind="other", name="falcon")
            assert (session.choice, session.feeling.stopped) == (before, True)
            await ask("choose_device", kind="other", name="falcon", sure=True)
            assert (session.choice.kind, session.choice.name, session.choice.sure) == ("other", "falcon", True)
            assert (tab.last("device")["kind"], tab.last("device")["name"]) == ("other", "falcon")

        with_session(check)

    def test_limits_are_counted_and_the_reach_is_the_document_s(self, with_session: Callable[[Check], None]) -> None:
        async def check(session: Session, tab: Heard, ask: Ask) -> None:
            assert await ask("limits") is None
            report = SimpleNamespace(ticks=5000, overruns=3, flagged={"force": 7})
            session.feeling = Mock(Feeling, servo=SimpleNamespace(report=lambda: report))
            assert await ask("limits") == {"ticks": 5000, "overruns": 3, "flagged": {"force": 7}}
            worker(session).answers["reach"] = {"device": "falcon"}
            session.sets = ["want=touch"]
            assert await ask("reach") == {"device": "falcon"}
            assert worker(session).asked[-1][1]["sets"] == ["want=touch"]

        with_session(check)


class TestDocument:
    def test_changes_of_the_command_line_become_text_once(self, with_session: Callable[[Check], None]) -> None:
        async def check(session: Session, tab: Heard, ask: Ask) -> None:
            session.sets = ["want=relief"]
            worker(session).answers["overridden"] = lambda text, path, sets: f"{text} with {sets[0]}"
            await ask("begin", files=["a.yaml"], make_it=False)
            assert (session.text, session.sets) == ("text of a.yaml with want=relief", [])
            assert worker(session).asked[-1][1]["sets"] == []

        with_session(check)

    def test_edit_is_kept_as_a_draft_until_it_is_saved(self, with_session: Callable[[Check], None]) -> None:
        async def check(session: Session, tab: Heard, ask: Ask) -> None:
            drafts = session.drafts._folder  # pyright: ignore[reportPrivateUsage]
            await ask("begin", files=["a.yaml"], make_it=False)
            await settled(session)
            assert not drafts.exists()
            await ask("edit", text="edited")
            await settled(session)
            assert len(list(drafts.iterdir())) == 1

        with_session(check)

    def test_document_is_saved_under_its_whole_name_and_over_no_other_file(
        self, with_session: Callable[[Check], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        async def check(session: Session, tab: Heard, ask: Ask) -> None:
            def saved_at() -> Path:
                return next(told["out"] for job, told in reversed(worker(session).asked) if job == "save")

            monkeypatch.chdir(tmp_path)
            for name in ("mine.yaml", "other.yml", "vase.yaml"):
                (tmp_path / name).touch()
            await ask("save", path="mine.yaml")  # its own file
            assert saved_at() == tmp_path / "mine.yaml"
            await ask("save", path="vase.2")
            assert saved_at() == session.path == tmp_path / "vase.2.yaml"
            for name in ("other.yml", "mine.yaml", "vase"):
                with pytest.raises(ConfigError, match="is there already"):
                    await ask("save", path=name)
            await ask("save", path=str(tmp_path / "other.yml"), replace=True)
            assert saved_at() == tmp_path / "other.yml"

        with_session(check)

    def test_draft_that_was_restored_is_offered_no_more(
        self, with_session: Callable[[Check], None], tmp_path: Path
    ) -> None:
        async def check(session: Session, tab: Heard, ask: Ask) -> None:
            with pytest.raises(ConfigError, match="no unsaved draft"):
                await ask("restore")
            file = tmp_path / "1.json"
            file.touch()
            session.drafts.left = SimpleNamespace(  # pyright: ignore[reportAttributeAccessIssue]
                file=file, text=Text("mine", tmp_path / "b.yaml"), at_s=3.0
            )
            worker(session).answers["make"] = Stopped()
            await ask("restore")
            assert (session.text, session.path) == ("mine", tmp_path / "b.yaml")
            assert (tab.last("restored")["path"], session.drafts.left, file.exists()) == ("", None, False)
            assert tab.last("restored")["edited_s"] == 0.0

        with_session(check)

    def test_draft_of_an_earlier_program_is_offered_with_its_time(
        self, with_session: Callable[[Check], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        async def check(session: Session, tab: Heard, ask: Ask) -> None:
            draft = SimpleNamespace(text=Text("mine", tmp_path / "b.yaml"), at_s=3.0)
            monkeypatch.setattr(session.drafts, "look", lambda: draft)
            await asks_document.offer(session)
            told = tab.last("restored")
            assert (told["path"], told["edited_s"]) == (str(tmp_path / "b.yaml"), 3.0)

        with_session(check)

    def test_folder_without_a_path_is_the_current_one(
        self, with_session: Callable[[Check], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        async def check(session: Session, tab: Heard, ask: Ask) -> None:
            (tmp_path / "here").mkdir()
            monkeypatch.chdir(tmp_path / "here")
            worker(session).answers["folder"] = lambda path: {"folder": str(path)}
            assert await ask("folder") == {"folder": str(tmp_path / "here")}
            assert await ask("folder", path="/a") == {"folder": "/a"}

        with_session(check)


class TestLaws:
    @pytest.fixture
    def compared(self, with_session: Callable[[Check], None], monkeypatch: pytest.MonkeyPatch) -> Any:
        """`compared(check)`: laws of a session are put under the hand one by one; `check` gets what was done."""
        done: list[tuple[str, Any]] = []

        def run(check: Callable[[Session, Ask, list[tuple[str, Any]]], Coroutine[Any, Any, None]]) -> None:
            def of(made: dict[str, Any], channel: str) -> Any:
                name = made["law"]
                touch = SimpleNamespace(name=name, discard=lambda: done.append(("discarded", name)))
                return SimpleNamespace(law=name, touch=touch, safety=None)

            async def put(self: Session, felt: Any) -> float | None:
                done.append(("felt", felt.law))
                return None if self.feeling.stopped else 0.1

            async def with_laws(session: Session, tab: Heard, ask: Ask) -> None:
                session.feeling = Mock(Feeling, running=True, stopped=False, channel="", own_device={})
                worker(session).answers |= {
                    "law_block": lambda use, options: {"use": use},
                    "laws": lambda text, path, sets, others: [{"law": "penalty"}, {"law": others[0]["use"]}],
                }
                comparison = session.laws.comparison
                monkeypatch.setattr(comparison, "feel", lambda touch, _: done.append(("beside", touch.name)))
                await check(session, ask, done)

            monkeypatch.setattr(LoopInput, "of", of)
            monkeypatch.setattr(Session, "put", put)
            with_session(with_laws)

        return run

    def test_other_law_is_computed_beside_the_one_that_acts(self, compared: Any) -> None:
        async def check(session: Session, ask: Ask, done: list[tuple[str, Any]]) -> None:
            await ask("compare_laws", use="proxy")
            assert done == [("felt", "penalty"), ("beside", "proxy"), ("discarded", "proxy")]
            done.clear()
            await ask("switch_law", to="b")
            assert done == [("felt", "proxy"), ("beside", "penalty"), ("discarded", "penalty")]
            assert session.laws.message() == {"state": "two", "named": ["penalty", "proxy"], "felt": 1}
            with pytest.raises(ConfigError, match="no other law"):
                await ask("switch_law", to="c")

        compared(check)

    def test_laws_of_one_name_are_told_apart(self, compared: Any) -> None:
        async def check(session: Session, ask: Ask, done: list[tuple[str, Any]]) -> None:
            await ask("compare_laws", use="penalty")
            assert session.laws.named == ("penalty (a)", "penalty (b)")

        compared(check)

    def test_law_that_is_not_felt_leaves_the_one_before(self, compared: Any) -> None:
        async def check(session: Session, ask: Ask, done: list[tuple[str, Any]]) -> None:
            session.feeling.stopped = True
            with pytest.raises(DeviceError, match="force was stopped"):
                await ask("compare_laws", use="proxy")
            assert session.laws.message() == {"state": "one"}
            assert done == [("felt", "penalty"), ("discarded", "proxy")]

        compared(check)

    def test_blind_trials_begin_with_the_law_that_is_named_first_and_end_with_the_document_s(
        self, compared: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
    ) -> None:
        async def check(session: Session, ask: Ask, done: list[tuple[str, Any]]) -> None:
            drawn = iter([1, 0, 1])
            monkeypatch.setattr("tangible_ui.state.laws.secrets.randbelow", lambda _: next(drawn))
            await ask("compare_laws", use="proxy")
            done.clear()
            await ask("begin_blind", question="?" * 300)
            assert session.laws.message()["question"] == "?" * 200
            await ask("choose_blind", choice=1)
            await ask("choose_blind", choice=0)
            found = await ask("end_blind")
            assert [law for did, law in done if did == "felt"] == ["proxy", "penalty", "proxy", "penalty"]
            assert found["trials"] == [["proxy", "penalty", "proxy"], ["penalty", "proxy", ""]]
            assert Path(found["path"]).is_file()
            assert session.laws.message() == {"state": "two", "named": ["penalty", "proxy"], "felt": 0}

        compared(check)

    def test_blind_comparison_without_trials_leaves_no_file(self, compared: Any, tmp_path: Path) -> None:
        async def check(session: Session, ask: Ask, done: list[tuple[str, Any]]) -> None:
            await ask("compare_laws", use="proxy")
            await ask("begin_blind")
            assert "path" not in await ask("end_blind")
            assert not (tmp_path / "data" / "comparisons").exists()

        compared(check)


class TestMaking:
    @pytest.mark.parametrize(
        ("plan", "makes"),
        [
            ({"slow": [], "refusal": ""}, True),
            ({"slow": ["disparity"], "refusal": ""}, False),
            ({"slow": [], "refusal": "there is no law"}, False),
        ],
    )
    def test_edit_is_applied_if_its_plan_is_quick_and_possible(
        self, with_session: Callable[[Check], None], monkeypatch: pytest.MonkeyPatch, plan: dict[str, Any], makes: bool
    ) -> None:
        made: list[str] = []

        async def make(session: Session, tab: Any) -> None:
            made.append(session.text)

        async def check(session: Session, tab: Heard, ask: Ask) -> None:
            monkeypatch.setattr(making, "make", make)
            worker(session).answers["plan"] = plan
            session.text = "edited"
            await making.foresee(session, apply=False)
            assert {key: tab.last("plan")[key] for key in plan} == plan
            assert made == []
            await making.foresee(session, apply=True)
            assert made == ["edited"] * makes

        with_session(check)

    def test_plan_of_an_earlier_text_is_not_sent(self, with_session: Callable[[Check], None]) -> None:
        async def check(session: Session, tab: Heard, ask: Ask) -> None:
            def edited_meanwhile(**_: Any) -> dict[str, Any]:
                session.digest = "later"
                return {"slow": [], "refusal": ""}

            session.digest = "now"
            worker(session).answers["plan"] = edited_meanwhile
            await making.foresee(session, apply=True)
            assert "plan" not in tab.names()
            assert "make" not in worker(session).jobs()

        with_session(check)

    @pytest.mark.parametrize(
        ("error", "newer", "outcome"),
        [
            (ConfigError("no law"), False, "failed"),
            (ConfigError("no law"), True, "failed"),
            (Stopped(), True, "stopped"),
            (WorkerKilled("killed"), True, "stopped"),
        ],
    )
    def test_job_that_gave_way_is_told_as_stopped_and_a_failure_as_one(
        self, with_session: Callable[[Check], None], error: TangibleError, newer: bool, outcome: str
    ) -> None:
        async def check(session: Session, tab: Heard, ask: Ask) -> None:
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

        with_session(check)

    @pytest.mark.parametrize("ends", [True, False])
    def test_worker_is_killed_only_for_jobs_that_do_not_end(
        self, with_session: Callable[[Check], None], monkeypatch: pytest.MonkeyPatch, ends: bool
    ) -> None:
        async def check(session: Session, tab: Heard, ask: Ask) -> None:
            monkeypatch.setattr(making, "PATIENCE_S", 0.0)
            old = session.long_jobs.begin()
            session.long_jobs.begin()
            if ends:
                session.long_jobs.running.discard(old)
            await making._insist(session, {old})  # pyright: ignore[reportPrivateUsage]
            assert (worker(session).kills, session.long_jobs.killed) == (int(not ends), not ends)

        with_session(check)


def test_request_that_says_only_what_it_must_has_the_defaults(with_session: Callable[[Check], None]) -> None:
    async def check(session: Session, tab: Heard, ask: Ask) -> None:
        worker(session).answers |= dict.fromkeys(("parts_propose", "legible", "texture_patch"))
        for name, said, rest in (
            ("parts_propose", {"points": [[1.0, 2.0]], "width_px": 3.0},
             {"kind": "grabcut", "within": None, "level": 0.5}),
            ("legible", {"medium": "swell"}, {"width_m": None}),
            ("texture_patch", {"digest": "x", "x_m": 0.1, "y_m": 0.2, "side_m": 0.01}, {"pixels": 192}),
        ):  # fmt: skip
            await ask(name, **said)
            job, told = worker(session).asked[-1]
            assert job == name
            assert told.items() >= {**said, **rest}.items()

    with_session(check)


def test_panel_has_an_address_and_the_folder_of_its_module(
    with_session: Callable[[Check], None], tmp_path: Path
) -> None:
    async def check(session: Session, tab: Heard, ask: Ask) -> None:
        worker(session).answers["panels"] = [{"name": "glove", "module": str(tmp_path / "glove" / "main.js")}]
        assert await ask("panels") == [{"name": "glove", "module": "/panels/glove/main.js"}]
        assert session.panel_folders == {"glove": tmp_path / "glove"}

    with_session(check)


@pytest.mark.parametrize("saved", [True, False])
def test_saved_parts_leave_no_upload_and_no_draft(
    with_session: Callable[[Check], None], tmp_path: Path, saved: bool
) -> None:
    async def check(session: Session, tab: Heard, ask: Ask) -> None:
        async def labels() -> Any:
            yield b"labels"

        batch = await ask("batch")
        await session.uploads.put(batch, "labels.gz", labels())
        found = {"text": "with parts", "moved": {"before": "moved"}, "file": tmp_path / "mine.yaml"}
        worker(session).answers["parts_save"] = found if saved else ConfigError("no")
        session.text = "before"
        session.drafts.remember_opened("before")
        if saved:
            assert await ask("parts_save", upload=batch, parts=[]) == {"file": str(tmp_path / "mine.yaml")}
            assert (session.text, session.path) == ("with parts", tmp_path / "mine.yaml")
            assert session.texts.before().text == "moved"
        else:
            with pytest.raises(ConfigError):
                await ask("parts_save", upload=batch, parts=[])
            assert session.text == "before"
        assert session.drafts.opened_text == session.text
        assert not list((tmp_path / "incoming").iterdir())

    with_session(check)


@pytest.mark.parametrize(("ticks", "judged"), [(0, False), (999, False), (1000, True)])
def test_loop_is_judged_by_enough_ticks(ticks: int, judged: bool) -> None:
    rows = np.zeros((ticks, len(TICK_COLUMNS)))
    rows[:, TICK_COLUMNS.index("late_s")] = 0.002
    header = {PERIOD_NS: 500_000, SPINS: 1}
    ring = SimpleNamespace(since=lambda _: (rows, 0), header=header)
    running = Mock(Feeling, own_device={"use": "pointer"}, running=True, servo=SimpleNamespace(ring=ring))
    session: Any = Mock(Session, feeling=running)
    found = preflight._loop(session)  # pyright: ignore[reportPrivateUsage]
    assert found["own"] == 'device={"use": "pointer"}'
    assert (found["late"] is not None) == judged
    if judged:
        assert (found["late"].period_s, found["late"].real_time) == (0.0005, True)
        assert found["late"].late_s.tolist() == [0.002] * ticks


def test_recordings_are_made_one_after_the_other(
    with_session: Callable[[Check], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    ended: list[Any] = []

    class Recorder:
        def __init__(self, servo: Any, path: Path, about: Any, notify: Any) -> None:
            self.path, self.recording = path, True
            ended.append(notify)

    async def check(session: Session, tab: Heard, ask: Ask) -> None:
        monkeypatch.setattr("tangible_ui.requests.records.Recorder", Recorder)
        felt = SimpleNamespace(law="penalty", device_name="mouse", materials="")
        session.feeling = Mock(Feeling, servo=SimpleNamespace(running=True), felt=felt)
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

    with_session(check)

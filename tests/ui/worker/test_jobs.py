"""The worker's state and jobs: otherwise an old picture is shown, or the page waits for ever."""

import asyncio
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from sessions import TEXT, Heard, small_scene
from tangible_core.errors import ConfigError
from tangible_ui.feeling.feeling import Feeling
from tangible_ui.prestart import _prestarted, prestart_worker, take_worker_process
from tangible_ui.requests import REQUESTS
from tangible_ui.state.session import Session
from tangible_ui.worker import handle
from tangible_ui.worker.handle import MAX_DEATHS, Worker, WorkerAbsent, WorkerKilled
from tangible_ui.worker.jobs import JOBS
from tangible_ui.worker.messages import Event
from tangible_ui.worker.state import WorkerState
from waiting import happened


def test_pipeline_file_counts_alone_and_two_are_refused(worker_state: WorkerState, tmp_path: Path) -> None:
    path = small_scene(tmp_path)
    path.write_text(TEXT)
    other = path.with_name("other.YML")
    begin = JOBS["begin"].do
    assert begin(worker_state, files=[tmp_path / "mine.png", path]) == {"text": TEXT, "path": path}
    with pytest.raises(ConfigError, match=r"^mine\.yaml, other\.YML: open one pipeline file at a time$"):
        begin(worker_state, files=[path, tmp_path / "mine.png", other])
    with pytest.raises(ConfigError, match=r"^mine\.txt: is not a picture, video"):
        begin(worker_state, files=[tmp_path / "mine.png", tmp_path / "mine.txt"])


def test_pictures_and_documents_are_read_again_where_they_changed(worker_state: WorkerState, tmp_path: Path) -> None:
    path = small_scene(tmp_path).with_name("mine.yaml")
    for number, grey in enumerate((10, 200)):
        Image.fromarray(np.full((24, 32), grey, np.uint8)).save(tmp_path / "mine.bmp")  # always of the same size
        text = TEXT.replace("mine.png", "mine.bmp")
        worker_state.pipeline = worker_state.make_pipeline(text, path, [])
        scene = worker_state.pipeline.scene
        assert scene.views is not None and scene.views.left[0, 0] == grey, number
        assert worker_state.make_pipeline(text.replace("400", "500"), path, []).scene is scene
    path = small_scene(tmp_path)
    for relief_m in (0.001, 0.002):
        config = worker_state.read_config(TEXT, path, [f"workspace.relief_m={relief_m}"])
        assert config.size.relief_m == relief_m
        assert worker_state.read_config(TEXT, path, [f"workspace.relief_m={relief_m}"]) is config


@pytest.mark.parametrize(("limit_n", "most_n"), [(None, 8.0), (2.0, 2.0), (100.0, 8.0)])
def test_device_presses_with_no_more_than_document_and_motor_allow(
    worker_state: WorkerState, tmp_path: Path, limit_n: float | None, most_n: float
) -> None:
    sets = ["device={use: mock}", *([] if limit_n is None else [f"safety.max_force_n={limit_n}"])]
    found = JOBS["about_device"].do(worker_state, text=TEXT, path=small_scene(tmp_path), sets=sets)
    assert (found["name"], found["simulated"], found["relief_m"]) == ("mock", True, 0.004)
    assert found["most_force_n"] == most_n


@pytest.mark.anyio
class TestHandle:
    @pytest.fixture
    def started(self, monkeypatch: pytest.MonkeyPatch) -> list[Worker]:
        """Starts of workers that have no process."""
        starts: list[Worker] = []

        def start(self: Worker) -> None:
            self._ready = self._was_killed = False  # pyright: ignore[reportPrivateUsage]
            starts.append(self)

        monkeypatch.setattr(handle.Worker, "_start", start)
        monkeypatch.setattr(handle.Worker, "_send", lambda self, message: None)
        return starts

    def die(self, worker: Worker, *, ready: bool = False, killed: bool = False) -> None:
        if ready:
            worker._take(Event("maker", {}))  # pyright: ignore[reportPrivateUsage]
        if killed:
            worker._process = SimpleNamespace(kill=lambda: None)  # pyright: ignore[reportPrivateUsage, reportAttributeAccessIssue]
            worker.kill()
        worker._handle_exit()  # pyright: ignore[reportPrivateUsage]

    @pytest.mark.parametrize("last", [{"ready": True}, {"killed": True}])
    async def test_worker_is_given_up_after_failed_starts_in_a_row_alone(
        self, started: list[Worker], tmp_path: Path, last: dict[str, bool]
    ) -> None:
        heard: list[Event] = []
        worker = Worker(tmp_path, heard.append)
        for _ in range(MAX_DEATHS - 1):
            self.die(worker)
        self.die(worker, **last)
        assert len(started) == MAX_DEATHS + 1
        for _ in range(MAX_DEATHS - 1 if "ready" in last else 0):
            self.die(worker)
        assert "maker_gone" not in [each.event for each in heard]
        self.die(worker)
        assert heard[-1] == Event("maker_gone", {"why": "the process that computes does not start: it printed nothing"})
        with pytest.raises(WorkerAbsent, match="does not start"):
            await worker.ask("schema")
        count = len(started)
        worker.try_again()
        assert len(started) == count + 1
        for _ in range(MAX_DEATHS - 1):
            self.die(worker)
        assert len(started) == count + MAX_DEATHS

    async def test_requests_of_a_killed_worker_are_told_and_quick_ones_repeated(
        self, started: list[Worker], tmp_path: Path
    ) -> None:
        worker = Worker(tmp_path, lambda event: None)
        asked = [asyncio.ensure_future(worker.ask("make")), asyncio.ensure_future(worker.quick("plan"))]
        while len(worker._waiting) < 2:  # pyright: ignore[reportPrivateUsage]
            await asyncio.sleep(0.01)
        self.die(worker, ready=True, killed=True)
        with pytest.raises(WorkerKilled):
            await asked[0]
        while not asked[1].done():  # the request that died may wait still, which an answer does not change
            for number in worker._waiting:  # pyright: ignore[reportPrivateUsage]
                worker._take(handle.JobResult(number, "the plan"))  # pyright: ignore[reportPrivateUsage]
            await asyncio.sleep(0.01)
        assert await asked[1] == "the plan"


@pytest.mark.anyio
async def test_job_for_pages_is_asked_with_the_document_and_the_arguments_of_the_page(small: Any) -> None:
    small.session.document.sets = ["device={use: mock}"]
    assert (await small.ask("reach"))["device"] == "mock"
    names = [
        each["name"] for each in (await small.ask("folder", path=str(small.session.document.path.parent)))["entries"]
    ]
    assert "mine.yaml" in names
    for name, said, why in (
        ("raech", {}, "no request .*raech.*did you mean .*reach"),
        ("make", {}, "no request"),  # which the server answers
        ("check", {"text": "", "path": "", "sets": []}, "no request"),
        ("reach", {"sets": []}, "reach: sets: Extra"),
        ("reach", {"state": 1}, "reach: state: Extra"),
        ("examine", {}, "name: Field required"),
        ("examine", {"name": 5}, "name: .*string"),
        ("parts_snap", {"points": [["a"]], "reach_px": 1.0}, "points.0.0: .*number"),
    ):
        with pytest.raises(ConfigError, match=why):
            await small.worker.quick("answer_page", request=name, arguments=said, **small.session.document.arguments())


SLOW = """\
scene: builtin/motorcycle
depth: {use: luminance}
render: {use: penalty}
"""


@pytest.mark.whole
@pytest.mark.anyio
async def test_stopped_job_ends_at_once_and_the_loop_goes_on(tmp_path: Path):
    session, tab = Session(tmp_path, Feeling("worker-process"), []), Heard()
    session.tabs.enter(tab)

    async def ask(name: str, **told: Any) -> Any:
        return await REQUESTS[name](session, tab, **told)

    try:
        await asyncio.to_thread(session.feeling.start)
        await ask("edit", text=SLOW)
        await ask("make")
        felt, servo = session.feeling.loop_input, session.feeling.servo
        assert felt is not None
        assert servo is not None
        await ask("set", changes={"depth.use": "ssd", "depth.window_px": 19})
        making = asyncio.ensure_future(ask("make"))
        await happened(lambda: any(event["event"] == "stage" and event["method"] == "ssd" for event in tab.events))
        assert not making.done()
        ticks, swapped = servo.ring.count, tab.names().count("touch")
        await ask("stop_making")
        await making
        assert tab.last("made")["outcome"] == "stopped"
        said = await ask("set", changes={"render.stiffness_n_per_m": 300})  # quick work waits for the new one
        assert said["complaints"] == []
        assert session.feeling.loop_input is felt
        assert session.feeling.running
        await happened(lambda: servo.ring.count - ticks > 100)
        assert tab.names().count("touch") == swapped
        await ask("undo")
        await ask("undo")
        await ask("make")
        assert tab.last("made")["outcome"] == "made"
        assert session.feeling.loop_input is not felt
    finally:
        await session.close()


def test_prestarted_worker_is_taken_once_or_killed():
    with prestart_worker():
        first = take_worker_process()
        second = take_worker_process()
        assert first.pid != second.pid
    assert first.poll() is None  # whoever took it ends it
    with prestart_worker():
        unused = _prestarted[0]
    assert unused.poll() is not None
    for each in (first, second):
        with each:
            each.kill()

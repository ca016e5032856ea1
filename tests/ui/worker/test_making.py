"""Making what the document says: otherwise an old surface is felt, or everything is computed again."""

import asyncio
import threading
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

import pytest

from sessions import TEXT, SmallSession
from tangible_authoring.fixing import AT_ONCE
from tangible_core.data.part_words import name_part
from tangible_core.errors import ConfigError, Stopped, TangibleError
from tangible_core.preflight import Loop
from tangible_depth.luminance import Luminance
from tangible_ui.requests import making as asks_making
from tangible_ui.worker.jobs import JOBS
from tangible_ui.worker.state import WorkerState
from waiting import LONGEST_S, happened

pytestmark = pytest.mark.anyio
DEVICE = ["device={use: mock}"]


@pytest.fixture
async def small(small: SmallSession) -> SmallSession:
    """The scene is felt."""
    await small.ask("make")
    await small.tab.until("touch")
    return small


def events(worker_state: Any, name: str) -> list[dict[str, Any]]:
    return [told for event, told in worker_state.heard if event == name]


def forget(worker_state: Any) -> None:
    worker_state.heard.clear()


def make(worker_state: WorkerState, text: str, path: Path, want: str = "touch", number: int = 1) -> Any:
    made = JOBS["make"].do(worker_state, number=number, text=text, path=path, sets=DEVICE, want=want)
    if made:
        Path(made["parcel"]).unlink()
    return made


def test_make_sends_plan_stages_and_outcome(worker_state: WorkerState, scene: Path):
    begun_s = perf_counter()
    assert make(worker_state, TEXT, scene)["law"] == "penalty"
    passed_s = perf_counter() - begun_s
    (plan,) = events(worker_state, "plan")
    assert [(each["product"], each["outcome"]) for each in plan["steps"]][:2] == [
        ("views", "given"), ("disparity", "ran"),
    ]  # fmt: skip
    assert plan["slow"] == ["disparity", "segments"]
    ended = [told["done"]["outcome"] for told in events(worker_state, "stage") if told["done"]]
    assert set(ended) == {"ran"}  # what is given stands in the plan
    assert all(
        {"why", "notes", "seconds"} <= told["done"].keys() for told in events(worker_state, "stage") if told["done"]
    )
    (made,) = events(worker_state, "made")
    assert made["outcome"] == "made"
    assert 0 <= made["seconds"] <= passed_s
    assert made["digest"] == plan["digest"]
    assert len(events(worker_state, "materials")[0]["segments"]) == 3


def test_make_with_another_law_makes_the_touch_alone(worker_state: WorkerState, scene: Path):
    make(worker_state, TEXT, scene)
    forget(worker_state)
    other = TEXT.replace("400", "500")
    plan = JOBS["plan"].do(worker_state, text=other, path=scene, sets=DEVICE, want="touch")
    assert (plan["slow"], plan["refusal"]) == ([], "")
    products = {each["product"]: each["outcome"] for each in plan["steps"]}
    assert list(products) == ["views", "disparity", "relief", "segments", "materials", "surface", "touch"]
    assert (products["views"], products["disparity"], products["touch"]) == ("given", "cached", "ran")
    make(worker_state, other, scene)
    assert {told["product"] for told in events(worker_state, "stage")} == {"touch"}
    assert not events(worker_state, "scene")


def test_make_without_a_law_shows_and_keeps_the_surface(worker_state: WorkerState, scene: Path):
    with pytest.raises(ConfigError, match="`render:` is missing"):
        make(worker_state, TEXT.replace("render:", "# render:"), scene)
    assert events(worker_state, "scene")
    forget(worker_state)
    make(worker_state, TEXT.replace("render: {use: penalty, stiffness_n_per_m: 400}", "render: proxy"), scene)
    assert {told["product"] for told in events(worker_state, "stage")} == {"touch"}


def test_make_of_depth_or_texture_alone_is_shown(worker_state: WorkerState, scene: Path):
    assert make(worker_state, TEXT, scene, "materials") is None
    (shown,) = events(worker_state, "scene")
    assert shown["height_m"] == [0.0, 0.0]  # no depth yet: flat
    (told,) = events(worker_state, "materials")
    assert len(told["segments"]) == 3
    assert sum(each["share"] for each in told["segments"]) == pytest.approx(1)
    assert all(each["why"].startswith(name_part(each["label"], noun="segment")) for each in told["segments"])
    assert {event["product"] for event in events(worker_state, "stage")} >= {"segments", "materials"}
    assert "disparity" not in {event["product"] for event in events(worker_state, "stage")}
    make(worker_state, TEXT, scene, "relief")
    low, high = events(worker_state, "scene")[-1]["height_m"]
    assert high > low
    make(worker_state, TEXT, scene, "materials")
    assert events(worker_state, "scene")[-1]["height_m"][1] > 0  # on the relief, which there is now


def test_make_that_fails_leaves_the_last_good_pipeline(worker_state: WorkerState, scene: Path):
    make(worker_state, TEXT, scene)
    good = worker_state.pipeline
    for wrong in (TEXT.replace("penalty", "penalti"), TEXT.replace("mine.png", "gone.png")):
        with pytest.raises(TangibleError):
            make(worker_state, wrong, scene)
        assert worker_state.pipeline is good
    refused = JOBS["plan"].do(
        worker_state, text=TEXT.replace("mine.png", "gone.png"), path=scene, sets=DEVICE, want="touch"
    )
    assert "gone.png" in refused["refusal"]
    forget(worker_state)
    make(worker_state, TEXT, scene)
    assert {told["product"] for told in events(worker_state, "stage")} == {"touch"}


@pytest.fixture
def depth(monkeypatch: pytest.MonkeyPatch) -> tuple[threading.Event, threading.Event]:
    """Events of a depth that is estimated: it has begun, and it may go on."""
    begun, go, estimate = threading.Event(), threading.Event(), Luminance.estimate

    def waits(self: Any, views: Any) -> Any:
        begun.set()
        assert go.wait(LONGEST_S)
        return estimate(self, views)

    monkeypatch.setattr(Luminance, "estimate", waits)
    return begun, go


@pytest.mark.parametrize(
    ("said", "instead", "at_once"),
    [("segments: 3", "segments: 4", False), ("luminance}", "luminance, smoothing_px: 4}", True)],
)
def test_newer_job_waits_only_for_a_stage_that_it_needs_too(
    worker_state: WorkerState, scene: Path, depth: Any, said: str, instead: str, at_once: bool
):
    begun, go = depth
    ended: list[BaseException | None] = []
    old = threading.Thread(target=_keep_error, args=(ended, lambda: make(worker_state, TEXT, scene, number=1)))
    old.start()
    assert begun.wait(LONGEST_S)
    newer = {"text": TEXT.replace(said, instead), "path": scene, "sets": DEVICE, "want": "touch"}
    assert JOBS["give_way"].do(worker_state, number=2, **newer) is at_once
    go.set()
    old.join(LONGEST_S)
    assert isinstance(ended[0], Stopped)
    assert [event["product"] for event in events(worker_state, "stage") if event["done"]] == ["disparity"]
    with pytest.raises(Stopped):  # nor does one begin that waited in the queue
        make(worker_state, TEXT, scene, number=1)
    forget(worker_state)
    assert make(worker_state, number=2, **{name: newer[name] for name in ("text", "path")})
    again = {event["product"]: event["done"]["outcome"] for event in events(worker_state, "stage") if event["done"]}
    assert again["disparity"] == ("ran" if at_once else "cached")


def _keep_error(ended: list[BaseException | None], do: Callable[[], Any]) -> None:
    try:
        do()
    except BaseException as error:  # noqa: BLE001
        ended.append(error)
    else:
        ended.append(None)


async def test_edit_during_a_job_is_applied_after_it(small: SmallSession, ask: Any, request: Any):
    begun, go = request.getfixturevalue("depth")  # not before the scene is felt
    await ask("set", changes={"depth.smoothing_px": 3})
    making = asyncio.ensure_future(ask("make"))
    assert await asyncio.to_thread(begun.wait, LONGEST_S)
    plans = small.tab.names().count("plan")
    await ask("set", changes={"render.stiffness_n_per_m": 900}, apply=True)
    plan = await small.tab.until("plan", plans + 1)
    assert plan["slow"] == ["disparity"]  # as it is not made yet
    go.set()
    await making
    await small.tab.until("touch", 3)
    assert small.tab.last("made")["digest"] == small.session.document.digest


async def test_stop_making_kills_the_worker_only_during_a_job(small: SmallSession, ask: Any, request: Any):
    await ask("stop_making")
    assert small.worker.kills == 0
    begun, go = request.getfixturevalue("depth")  # not before the scene is felt
    await ask("set", changes={"depth.smoothing_px": 3})
    making = asyncio.ensure_future(ask("make"))
    assert await asyncio.to_thread(begun.wait, LONGEST_S)
    await ask("stop_making")
    go.set()
    assert await making is None  # who stops is not told of an error
    assert (small.worker.kills, small.tab.last("made")["outcome"]) == (1, "stopped")
    assert "error" not in small.tab.names()
    await ask("make")
    assert small.tab.last("made")["outcome"] == "made"


async def test_job_that_does_not_give_way_is_killed_and_the_newest_repeated(
    small: SmallSession, ask: Any, request: Any, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(asks_making, "PATIENCE_S", 0.2)
    begun, go = request.getfixturevalue("depth")  # not before the scene is felt
    await ask("set", changes={"depth.smoothing_px": 3})
    old = asyncio.ensure_future(ask("make"))
    assert await asyncio.to_thread(begun.wait, LONGEST_S)
    await ask("set", changes={"depth.smoothing_px": 4})
    new = asyncio.ensure_future(ask("make"))
    await happened(lambda: small.worker.kills)
    go.set()
    assert await old is None
    await new
    assert small.tab.last("made")["digest"] == small.session.document.digest
    assert small.worker.kills == 1
    assert small.worker.asked.count("make") == 4  # the first, the old, the new twice


async def test_preflight_cures_change_the_document(small: SmallSession, ask: Any, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("tangible_ui.worker.jobs.preflight.Loop", lambda seconds=AT_ONCE: Loop(seconds=AT_ONCE))
    assert (await ask("preflight"))["device"] == ""  # the page's own hand
    steep = {"render.use": "penalty-gradient", "workspace.relief_m": 0.02, "workspace.smooth_m": 0}
    hard = {"materials.by": "rules", "materials.default": "brick", "materials.fit": "never"}
    await ask("set", changes={**steep, **hard, "device.use": "mock"})
    assert small.tab.last("preflight")["digest"] != small.session.document.digest
    found = await ask("preflight")
    assert (found["grade"], found["device"], found["of_loop"]) == ("unsafe", "mock", False)
    assert found["sentence"].startswith("Unsafe, because")
    assert found["digest"] == small.session.document.digest
    cures = [each["changes"][0] for each in found["verdicts"] if each["changes"]]
    assert {"key": "materials.fit", "value": "device", "towards": "is"} in cures
    assert all(each["stands"] for each in found["verdicts"])
    fixed = await ask("fix")
    assert fixed["safe"]
    assert small.session.document.text.startswith("# a photograph of mine\n")
    assert "# bright is near" in small.session.document.text
    assert "fit: device" in small.session.document.text
    now = small.tab.last("preflight")
    assert (now["grade"] != "unsafe", now["digest"]) == (True, small.session.document.digest)

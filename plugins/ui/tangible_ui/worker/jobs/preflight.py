"""Jobs that judge a document before a hand meets it, and correct what they can."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from tangible_authoring.fixing import AT_ONCE, cure
from tangible_core.pipeline import Feeling, Pipeline
from tangible_core.plugins import Medium
from tangible_core.preflight import Hand, Lateness, Loop, Preflight, judge
from tangible_core.runtime import stoppable

from ..messages import Late
from ..state import WorkerState
from .document import text_digest
from .making import announce
from .table import job


@job()
def preflight(
    state: WorkerState, number: int, text: str, path: Path, sets: list[str], own: str, late: Late | None
) -> dict[str, Any]:
    """Judge on the document's device, or on the page's hand `own`; late: of the loop, by default of a sample."""
    pipeline, is_own = _pipeline_to_judge(state, text, path, sets, own)
    with announce(state, number, pipeline, text, "preflight") as (work, report):
        pipeline.make("touch", report, work.stop)
        with stoppable(work.stop):
            flight = Feeling(pipeline).flight(loop=_loop(late))
        if late is not None:
            flight = replace(flight, lateness=Lateness(*late))
        verdicts = _verdict_data(judge(flight), text, pipeline, is_own, late)
        state.tell("preflight", **verdicts)
    return verdicts


@job()
def fix(
    state: WorkerState, number: int, text: str, path: Path, sets: list[str], own: str, late: Late | None
) -> dict[str, Any]:
    """Return the changes with which the document passes, by key, and the verdicts then. Raises: as `preflight`."""
    pipeline, is_own = _pipeline_to_judge(state, text, path, sets, own)
    with announce(state, number, pipeline, text, "preflight") as (work, report):
        pipeline.make("touch", report, work.stop)
        lateness = None if late is None else Lateness(*late)
        with stoppable(work.stop):
            cure_result = cure(text, path, pipeline, Hand(), _loop(late), [*sets, own] if is_own else sets, lateness)
    settings = {key: change.setting for key, change in cure_result.changes.items()}
    return {"changes": settings, "safe": cure_result.verdicts.safe, "sentence": cure_result.verdicts.sentence}


def _pipeline_to_judge(state: WorkerState, text: str, path: Path, sets: list[str], own: str) -> tuple[Pipeline, bool]:
    """Return the pipeline, and True if it uses the page's own hand."""
    pipeline = state.make_pipeline(text, path, sets)
    if pipeline.config.device is not None:
        return pipeline, False
    return state.make_pipeline(text, path, [*sets, own]), True


def _loop(late: Late | None) -> Loop:
    return Loop() if late is None else Loop(seconds=AT_ONCE)


def _verdict_data(
    verdicts: Preflight, text: str, pipeline: Pipeline, is_own: bool, late: Late | None
) -> dict[str, Any]:
    device, law = pipeline.config.device, pipeline.config.render
    return {
        "digest": text_digest(text),
        **verdicts.as_data(),
        "device": "" if is_own or device is None else device.name,
        "law": law.name if law else "",
        "of_loop": late is not None,
    }


@job()
def legible(
    state: WorkerState, number: int, text: str, path: Path, sets: list[str], medium: Medium, width_m: float | None
) -> dict[str, Any]:
    """Judge by the rules of one medium. width_m: of the whole picture there; by default as export draws it."""
    pipeline = state.make_pipeline(text, path, sets)
    with announce(state, number, pipeline, text, "legible") as (work, report):
        pipeline.make("parts", report, work.stop)
        with stoppable(work.stop):
            feeling = Feeling(pipeline)
            width_m = feeling.width_on(medium) if width_m is None else width_m
            verdicts, is_simplified = feeling.legible(medium, width_m), feeling.is_simplified_on(medium)
        arguments = {"medium": medium, "width_m": width_m, "simplified": is_simplified}
        message = {"digest": text_digest(text), **arguments, **verdicts.as_data()}
        state.tell("legible", **message)
    return message

"""Jobs that make products, show them on the way and pack the loop's input; and the plan of making."""

from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from threading import Event
from time import perf_counter
from typing import Any, cast

import numpy as np

from tangible_core.data import PRODUCTS, HapticSurface, Outcome, Plan
from tangible_core.errors import TangibleError
from tangible_core.mapping import over
from tangible_core.pipeline import Pipeline
from tangible_core.pipeline.config import PipelineConfig
from tangible_core.pipeline.engine import Progress, StageEvent
from tangible_core.plugins import Touch
from tangible_core.runtime import dumps
from tangible_core.servo import pack_touch
from tangible_core.session import materials_text

from ..state import Work, WorkerState
from ..view.files import show
from ..view.surface_view import SurfaceView, view_of
from .document import digest_of
from .surface import description_data
from .table import job


def loop_input_of(pipeline: Pipeline, report: Progress | None = None, stop: Event | None = None) -> dict[str, Any]:
    """Make the touch, and return the loop's input. Raises: ConfigError without a device; as `Pipeline.make`."""
    touch, config = pipeline.make("touch", report, stop), pipeline.config
    return parcel_of(touch, pipeline.make("surface"), config)


def parcel_of(touch: Touch, surface: HapticSurface, config: PipelineConfig) -> dict[str, Any]:
    """Pack a touch into the loop's input. Raises: ConfigError without a device; DeviceError if there is no room."""
    if config.device is None or config.felt_device is None:
        raise config.missing("device")
    device = over(config.felt_device, surface.extent_m)
    sent = pack_touch(touch, device.spec())
    return {
        "parcel": str(sent.parcel),
        "stiffness_n_per_m": sent.stiffness_n_per_m,
        "law": config.render.name if config.render else "",
        "device_name": config.device.name,
        "device": dumps(device),
        "mapping": dumps(config.mapping),
        "safety": dumps(config.safety),
        "materials": materials_text(surface),
    }


SLOW = ("disparity", "segments")
"""Products that take seconds: they are not made again at every edit, but on request."""


@job(quick=True)
def plan(state: WorkerState, text: str, path: Path, sets: list[str], want: str) -> dict[str, Any]:
    """Return the plan of making a product with its reasons; the refusal if it cannot be made."""
    try:
        return plan_data(state.pipeline_of(text, path, sets), text, want)
    except TangibleError as error:
        return {"digest": digest_of(text), "want": want, "steps": [], "slow": [], "refusal": str(error)}


def plan_data(pipeline: Pipeline, text: str, want: str) -> dict[str, Any]:
    """Return the plan as pages have it. Raises: as `Pipeline.plan`."""
    found = pipeline.plan(cast(Any, want))
    slow = [step.product for step in found.steps if step.outcome == "ran" and step.product in SLOW]
    steps = [asdict(step) for step in _all_steps(pipeline, found)]
    return {"digest": digest_of(text), "want": want, "steps": steps, "slow": slow, "refusal": found.refusal}


def _all_steps(pipeline: Pipeline, found: Plan) -> list[Outcome]:
    """Return the plan's steps, and the products inside a cached one, in the order of making."""
    steps = {step.product: step for step in found.steps}
    if not found.refusal:
        needed = pipeline.engine.inputs_of(found.want)
        for each in pipeline.outcomes:
            if each.product in needed and each.product not in steps:
                steps[each.product] = each if each.outcome == "given" else replace(each, outcome="cached", why="")
    order = ["views", *PRODUCTS]
    return sorted(steps.values(), key=lambda each: order.index(each.product))


@job()
def make(state: WorkerState, number: int, text: str, path: Path, sets: list[str], want: str) -> dict[str, Any] | None:
    """Make a product, and show it on the way; return the loop's input, if a touch was wanted."""
    pipeline = state.pipeline_of(text, path, sets)
    with announced(state, number, pipeline, text, want) as (work, report):
        state.tell("plan", **plan_data(pipeline, text, want))
        product = TO_SEE.get(want, want)
        pipeline.make(product, report, work.stop)
        _show(state, pipeline, product)
        work.worth = True
        return loop_input_of(pipeline, report, work.stop) if want == "touch" else None


@contextmanager
def announced(
    state: WorkerState, number: int, pipeline: Pipeline, text: str, want: str
) -> Generator[tuple[Work, Progress]]:
    """Send pages begin, stages and end of a long job. Yields: the job's progress, and who reports a stage to pages."""
    begun_s, digest = perf_counter(), digest_of(text)

    def report(stage: StageEvent) -> None:
        done = {} if stage.outcome is None else asdict(stage.outcome)
        state.tell("stage", product=stage.product, method=stage.method, done=done)
        work.follow(stage)

    with state.work(pipeline, number) as work:
        state.tell("making", want=want, digest=digest)
        yield work, report
    state.tell("made", want=want, digest=digest, outcome="made", why="", seconds=perf_counter() - begun_s)


@job(quick=True)
def give_way(state: WorkerState, number: int, text: str, path: Path, sets: list[str], want: str) -> bool:
    """End the running job for this newer document; return True if that was at once. Raises: ConfigError."""
    return state.give_way(number, state.pipeline_of(text, path, sets), want)


TO_SEE = {"touch": "surface", "disparity": "relief", "segments": "materials"}
"""The product that is shown for a product, if that is another one."""


def _show(state: WorkerState, pipeline: Pipeline, product: str) -> None:
    """Send pages the surface, which they draw while the touch is made."""
    if (seen := view_of(pipeline, product)).digest != state.shown:
        state.tell("scene", **show(seen, state.folder))
        state.shown = seen.digest
        state.described = pipeline, seen
        state.tell("described", **description_data(pipeline, seen))
    state.tell("materials", segments=_segments(pipeline, seen))


def _segments(pipeline: Pipeline, seen: SurfaceView) -> list[dict[str, Any]]:
    """Return for each segment its material, the reason, its share of the area, and its name if it is a part."""
    if seen.labels is None or not seen.materials:
        return []
    chosen = pipeline.make("materials")
    reasons = chosen.reasons if chosen is not None else ("",) * len(seen.materials)
    names = seen.names or ("",) * len(seen.materials)
    shares = np.bincount(seen.labels.ravel(), minlength=len(seen.materials)) / max(1, seen.labels.size)
    named = enumerate(zip(seen.materials, reasons, shares.tolist(), strict=False))
    return [
        {"label": label, "material": material.name, "why": why, "share": share, "name": names[label]}
        for label, (material, why, share) in named
    ]

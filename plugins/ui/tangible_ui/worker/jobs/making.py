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
from ..view.surface_view import SurfaceView, make_view
from .document import text_digest
from .surface import description_data
from .table import job


def make_loop_input(pipeline: Pipeline, report: Progress | None = None, stop: Event | None = None) -> dict[str, Any]:
    """Make the touch, and return the loop's input. Raises: ConfigError without a device; as `Pipeline.make`."""
    touch, config = pipeline.make("touch", report, stop), pipeline.config
    return pack_loop_input(touch, pipeline.make("surface"), config)


def pack_loop_input(touch: Touch, surface: HapticSurface, config: PipelineConfig) -> dict[str, Any]:
    """Pack a touch into the loop's input. Raises: ConfigError without a device; DeviceError if there is no room."""
    if config.device is None or config.felt_device is None:
        raise config.missing("device")
    device = over(config.felt_device, surface.extent_m)
    packed_touch = pack_touch(touch, device.spec())
    return {
        "parcel": str(packed_touch.parcel),
        "stiffness_n_per_m": packed_touch.stiffness_n_per_m,
        "law": config.render.name if config.render else "",
        "device_name": config.device.name,
        "device": dumps(device),
        "mapping": dumps(config.mapping),
        "safety": dumps(config.safety),
        "materials": materials_text(surface),
    }


# Products that take seconds: they are not made again at every edit, but on request.
SLOW = ("disparity", "segments")


@job(quick=True)
def plan(state: WorkerState, text: str, path: Path, sets: list[str], want: str) -> dict[str, Any]:
    """Return the plan of making a product with its reasons; the refusal if it cannot be made."""
    try:
        return plan_data(state.make_pipeline(text, path, sets), text, want)
    except TangibleError as error:
        return {"digest": text_digest(text), "want": want, "steps": [], "slow": [], "refusal": str(error)}


def plan_data(pipeline: Pipeline, text: str, want: str) -> dict[str, Any]:
    """Return the plan as pages have it. Raises: as `Pipeline.plan`."""
    plan = pipeline.plan(cast(Any, want))
    slow = [step.product for step in plan.steps if step.outcome == "ran" and step.product in SLOW]
    steps = [asdict(step) for step in _all_steps(pipeline, plan)]
    return {"digest": text_digest(text), "want": want, "steps": steps, "slow": slow, "refusal": plan.refusal}


def _all_steps(pipeline: Pipeline, plan: Plan) -> list[Outcome]:
    """Return the plan's steps, and the products inside a cached one, in the order of making."""
    steps = {step.product: step for step in plan.steps}
    if not plan.refusal:
        inputs = pipeline.engine.all_inputs(plan.want)
        for outcome in pipeline.outcomes:
            if outcome.product in inputs and outcome.product not in steps:
                steps[outcome.product] = (
                    outcome if outcome.outcome == "given" else replace(outcome, outcome="cached", why="")
                )
    order = ["views", *PRODUCTS]
    return sorted(steps.values(), key=lambda outcome: order.index(outcome.product))


@job()
def make(state: WorkerState, number: int, text: str, path: Path, sets: list[str], want: str) -> dict[str, Any] | None:
    """Make a product, and show it on the way; return the loop's input, if a touch was wanted."""
    pipeline = state.make_pipeline(text, path, sets)
    with announce(state, number, pipeline, text, want) as (work, report):
        state.tell("plan", **plan_data(pipeline, text, want))
        product = TO_SEE.get(want, want)
        pipeline.make(product, report, work.stop)
        _show(state, pipeline, product)
        work.worth = True
        return make_loop_input(pipeline, report, work.stop) if want == "touch" else None


@contextmanager
def announce(
    state: WorkerState, number: int, pipeline: Pipeline, text: str, want: str
) -> Generator[tuple[Work, Progress]]:
    """Send pages begin, stages and end of a long job. Yields: the job's progress, and who reports a stage to pages."""
    begun_s, digest = perf_counter(), text_digest(text)

    def report(stage: StageEvent) -> None:
        outcome = {} if stage.outcome is None else asdict(stage.outcome)
        state.tell("stage", product=stage.product, method=stage.method, done=outcome)
        work.follow(stage)

    with state.work(pipeline, number) as work:
        state.tell("making", want=want, digest=digest)
        yield work, report
    state.tell("made", want=want, digest=digest, outcome="made", why="", seconds=perf_counter() - begun_s)


@job(quick=True)
def give_way(state: WorkerState, number: int, text: str, path: Path, sets: list[str], want: str) -> bool:
    """End the running job for this newer document; return True if that was at once. Raises: ConfigError."""
    return state.give_way(number, state.make_pipeline(text, path, sets), want)


TO_SEE = {"touch": "surface", "disparity": "relief", "segments": "materials"}
"""The product that is shown for a product, if that is another one."""


def _show(state: WorkerState, pipeline: Pipeline, product: str) -> None:
    """Send pages the surface, which they draw while the touch is made."""
    if (view := make_view(pipeline, product)).digest != state.shown_digest:
        state.tell("scene", **show(view, state.folder))
        state.shown_digest = view.digest
        state.description = pipeline, view
        state.tell("described", **description_data(pipeline, view))
    state.tell("materials", segments=_segments(pipeline, view))


def _segments(pipeline: Pipeline, view: SurfaceView) -> list[dict[str, Any]]:
    """Return for each segment its material, the reason, its share of the area, and its name if it is a part."""
    if view.labels is None or not view.materials:
        return []
    materials = pipeline.make("materials")
    reasons = materials.reasons if materials is not None else ("",) * len(view.materials)
    names = view.names or ("",) * len(view.materials)
    shares = np.bincount(view.labels.ravel(), minlength=len(view.materials)) / max(1, view.labels.size)
    numbered = enumerate(zip(view.materials, reasons, shares.tolist(), strict=False))
    return [
        {"label": label, "material": material.name, "why": why, "share": share, "name": names[label]}
        for label, (material, why, share) in numbered
    ]

"""Jobs that make products, and say on the way what there is to see; and what making would do."""

from dataclasses import asdict
from pathlib import Path
from threading import Event
from time import perf_counter
from typing import Any, cast

import numpy as np

from tangible_core.data import HapticSurface
from tangible_core.errors import TangibleError
from tangible_core.mapping import over
from tangible_core.pipeline.engine import Progress, Stage
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.runtime.child_process import dumps
from tangible_core.scene.geometry import flat_relief
from tangible_core.servo import packed

from .bench import Bench, Job, Work
from .checking import digest_of
from .shown import show

SLOW = ("disparity", "segments")
"""Products that take seconds: who edits says when they are made."""


def plan(bench: Bench, text: str, path: Path, sets: list[str], want: str) -> dict[str, Any]:
    """What making a product would do, and why; what stands in the way where it cannot."""
    try:
        return planned(bench.pipeline_of(text, path, sets), text, want)
    except TangibleError as error:
        return {"digest": digest_of(text), "want": want, "steps": [], "slow": [], "refusal": str(error)}


def planned(pipeline: Pipeline, text: str, want: str) -> dict[str, Any]:
    """The plan as pages have it. Raises: as `Pipeline.plan`."""
    found = pipeline.plan(cast(Any, want))
    slow = [each.product for each in found.steps if each.outcome == "ran" and each.product in SLOW]
    steps = [asdict(each) for each in found.steps]
    return {"digest": digest_of(text), "want": want, "steps": steps, "slow": slow, "refusal": found.refusal}


def make(bench: Bench, number: int, text: str, path: Path, sets: list[str], want: str) -> dict[str, Any] | None:
    """Make a product; pages hear of every stage, and of the surface as soon as it can be drawn.

    Returns: what the force loop needs, where a touch was wanted.
    """
    begun_s = perf_counter()
    pipeline = bench.pipeline_of(text, path, sets)
    with bench.work(pipeline, number) as work:
        bench.tell("making", want=want, digest=digest_of(text))
        bench.tell("plan", **planned(pipeline, text, want))
        heard = telling(bench, work)
        if (surface := _seen(pipeline, want, heard, work.stop)) is not None:
            _show(bench, pipeline, surface)
        work.worth = True
        made = _touch(pipeline, heard, work.stop) if want == "touch" else None
    bench.tell("made", want=want, digest=digest_of(text), outcome="made", why="", seconds=perf_counter() - begun_s)
    return made


def telling(bench: Bench, work: Work) -> Progress:
    """Hears of stages, and tells pages."""

    def heard(stage: Stage) -> None:
        done = {} if stage.outcome is None else asdict(stage.outcome)
        bench.tell("stage", product=stage.product, method=stage.method, done=done)
        work.heard(stage)

    return heard


def give_way(bench: Bench, number: int, text: str, path: Path, sets: list[str], want: str) -> bool:
    """What is being made ends for this newer document; whether at once, as it needs nothing of what is at work.

    Raises: ConfigError if that makes no sense; then what is being made goes on.
    """
    return bench.give_way(number, bench.pipeline_of(text, path, sets), want)


def _seen(pipeline: Pipeline, want: str, heard: Progress, stop: Event) -> HapticSurface | None:
    """What can be seen of a product: depth without materials; materials on the relief, or flat before there is one."""
    if want in ("surface", "touch"):
        return pipeline.make("surface", heard, stop)
    if want in ("disparity", "relief"):
        pipeline.make(want, heard, stop)
        return HapticSurface(pipeline.make("relief", heard, stop))
    pipeline.make(want, heard, stop)
    chosen, segments = pipeline.make("materials", heard, stop), pipeline.engine.felt("segments")
    if chosen is None or segments is None:
        return None
    relief = flat_relief(segments.labels.shape, pipeline.config.size.width_m)
    if not any(
        each.outcome in ("ran", "refused") and each.product == "disparity" for each in pipeline.plan("relief").steps
    ):
        made = pipeline.make("relief", heard, stop)
        relief = made if made.height_m.shape == segments.labels.shape else relief
    return HapticSurface(relief, segments.labels, chosen.materials)


def _show(bench: Bench, pipeline: Pipeline, surface: HapticSurface) -> None:
    """Pages draw it while the touch is made."""
    if (digest := surface.digest()) != bench.shown:
        bench.tell("scene", **show(pipeline, surface, digest, bench.folder))
        bench.shown = digest
    bench.tell("materials", segments=_segments(pipeline, surface))


def _segments(pipeline: Pipeline, surface: HapticSurface) -> list[dict[str, Any]]:
    """Each segment with its material, why it has it, and its share of the area."""
    if surface.labels is None or surface.materials is None:
        return []
    chosen = pipeline.make("materials")
    reasons = chosen.reasons if chosen is not None else ("",) * len(surface.materials)
    shares = np.bincount(surface.labels.ravel(), minlength=len(surface.materials)) / max(1, surface.labels.size)
    named = enumerate(zip(surface.materials, reasons, shares.tolist(), strict=False))
    return [
        {"label": label, "material": material.name, "why": why, "share": share}
        for label, (material, why, share) in named
    ]


def _touch(pipeline: Pipeline, heard: Progress, stop: Event) -> dict[str, Any]:
    touch, config = pipeline.make("touch", heard, stop), pipeline.config
    if config.felt_device is None:
        raise config.missing("device")
    device = over(config.felt_device, pipeline.make("surface").extent_m)
    sent = packed(touch, device.spec())
    return {
        "parcel": str(sent.parcel),
        "stiffness_n_per_m": sent.stiffness_n_per_m,
        "law": config.render.name if config.render else "",
        "device_name": config.device.name,
        "device": dumps(device),
        "mapping": dumps(config.mapping),
        "safety": dumps(config.safety),
    }


JOBS = {"make": Job(make), "plan": Job(plan, quick=True), "give_way": Job(give_way, quick=True)}

"""The job that makes a product, and shows on the way what there is to see."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

from tangible_core.pipeline.engine import Stage
from tangible_core.runtime.child_process import dumps
from tangible_core.servo import packed

from .bench import Bench, Job
from .shown import show


def make(bench: Bench, text: str, path: Path, sets: list[str], want: str) -> dict[str, Any] | None:
    """Make a product; pages hear of every stage, and of the surface as soon as it can be drawn.

    Returns: what the force loop needs, where a touch was wanted.
    """
    pipeline = bench.pipeline_of(text, path, sets)

    def heard(stage: Stage) -> None:
        done = {} if stage.outcome is None else asdict(stage.outcome)
        bench.tell("stage", product=stage.product, method=stage.method, done=done)

    bench.tell("making", want=want)
    surface = pipeline.make("surface", heard)
    if (digest := surface.digest()) != bench.shown:  # pages draw it while the touch is made
        bench.tell("scene", **show(pipeline, surface, digest, bench.folder))
        bench.shown = digest
    if want != "touch":
        return None
    touch = pipeline.make("touch", heard)
    config = pipeline.config
    device = config.felt_device
    assert device is not None
    sent = packed(touch, device.spec())
    return {
        "parcel": str(sent.parcel),
        "stiffness_n_per_m": sent.stiffness_n_per_m,
        "law": config.render.name if config.render else "",
        "device_name": config.device.name if config.device else "",
        "device": dumps(device),
        "mapping": dumps(config.mapping),
        "safety": dumps(config.safety),
    }


JOBS = {"make": Job(make)}

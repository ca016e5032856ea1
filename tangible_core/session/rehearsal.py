"""What a pipeline will do after its depth, done in haste on a part of its picture, so that the kernels are compiled.

It runs in a process beside the one that makes the real thing; what it finds is thrown away. All that it must meet is
what kernels are compiled for, the types of arrays, and no value.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..compiled.beside import Beside, Work
from ..data import DisparityMap, SegmentMap, Views
from ..pipeline.config import PipelineConfig
from ..pipeline.engine import Pipeline
from ..pipeline.rules import rules
from ..scene.scene import Scene
from .loop import run

MOST_PX = 768
"""Rows and columns of the picture that are looked at."""
STRIPES = 6
"""Segments of a made-up map: enough for every material that a rule may choose."""
FELT = "felt"
SECONDS = 0.02


def rehearsal(pipeline: Pipeline) -> Beside:
    """For a block in which the pipeline makes what it wants: what it compiles later is compiled beside it."""
    return Beside(lambda: _work(pipeline))


def _work(pipeline: Pipeline) -> Work | None:
    views, begun = pipeline.scene.views, pipeline.begun
    from ..compiled.threads import thread_count  # imports numba, which is there by now

    if views is None or "touch" in begun or thread_count() < 2:
        return None
    rows, columns = (slice(max(0, (size - MOST_PX) // 2), (size + MOST_PX) // 2) for size in views.shape)
    part = Views(np.ascontiguousarray(views.left[rows, columns]))
    return rehearse, (pipeline.config, part, "segments" in pipeline.scene.given or "segments" in begun)


def rehearse(config: PipelineConfig, views: Views, segmented: bool) -> Iterator[str]:
    """Segment, make the touch of a made-up relief, feel it; after each it is named, as the pipeline's product is."""
    if config.texture is not None and not segmented:
        config.texture.method.segment(views.left)
        yield "segments"
    if config.want != "touch" or config.render is None:
        return
    columns = np.arange(views.shape[1])
    ramp, stripes = np.empty(views.shape, np.float32), np.empty(views.shape, np.int32)
    ramp[:], stripes[:] = columns + 1, columns * STRIPES // columns.size
    given = {"disparity": DisparityMap(ramp), "segments": SegmentMap(stripes)}
    table = rules(config, Scene("rehearsal", views, given))
    made: dict[str, Any] = {"views": views, **given}
    for product in ("relief", "materials", "surface", "touch"):
        if not table[product].skip:
            made[product] = table[product].make(made)
    yield "touch"
    device = config.felt_device
    if device is not None and device.spec().simulated:
        run(made["touch"], device, SECONDS, limits=config.safety)
    yield FELT

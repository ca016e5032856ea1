"""What a pipeline will do after its depth, done in haste on a part of its picture, so that the kernels are compiled.

It runs in a process beside the one that makes the real thing, and what it finds is thrown away. Only the types of
arrays must be what the pipeline will have, as kernels are compiled for those.
"""

from collections.abc import Iterator

import numpy as np

from ...compiled.background import BackgroundCompiler, Work
from ...data import DisparityMap, SegmentMap, Views
from ...plugins.registry import default_registry
from ...scene.scene import Scene
from ...session import run_simulated
from ..config.model import PipelineConfig
from .engine import Engine

MOST_PX = 768
"""Rows and columns of the picture that are looked at."""
STRIPES = 6
"""Segments of a made-up map: enough for every material that a rule may choose."""
FELT = "felt"
SECONDS = 0.02


def rehearsal(engine: Engine, want: str) -> BackgroundCompiler:
    """For a block in which the engine makes this product: what it compiles later is compiled beside it."""
    return BackgroundCompiler(lambda: _work(engine, want))


def _work(engine: Engine, want: str) -> Work | None:
    from ...compiled.threads import thread_count  # imports numba, which is there by now

    views, config = engine.scene.views, engine.config
    segments = config.texture is not None and "segments" not in {*engine.begun, *engine.brought}
    touch = want == "touch" and config.render is not None and "touch" not in engine.begun
    if views is None or min(thread_count(), engine.threads or 2) < 2 or not (segments or touch):
        return None
    rows, columns = (slice(max(0, (size - MOST_PX) // 2), (size + MOST_PX) // 2) for size in views.shape)
    part = Views(np.ascontiguousarray(views.left[rows, columns]))
    names = frozenset(["segments"] * segments + ["touch", FELT] * touch)
    said = config.with_values(scene=Scene("rehearsal", part), simplify=None)
    return Work(names, rehearse, (said, part, segments, touch))


def rehearse(config: PipelineConfig, views: Views, segments: bool, touch: bool) -> Iterator[str]:
    """Segment, make the touch of a made-up surface, feel it; after each it is named, as the pipeline's product is."""
    if segments and config.texture is not None:
        config.texture.method.segment(views.left)
        yield "segments"
    if not touch:
        return
    columns = np.arange(views.shape[1])
    ramp, stripes = np.empty(views.shape, np.float32), np.empty(views.shape, np.int32)
    ramp[:], stripes[:] = columns + 1, columns * STRIPES // columns.size
    scene = Scene("rehearsal", views, DisparityMap(ramp), SegmentMap(stripes))
    made = Engine(config.with_values(scene=scene), default_registry()).make("touch")
    yield "touch"
    device = config.felt_device
    if device is not None and device.spec().simulated:
        run_simulated(made, device, SECONDS, limits=config.safety)
    yield FELT

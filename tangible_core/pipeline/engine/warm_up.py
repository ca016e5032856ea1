"""The warm-up: the stages after the depth, run on a crop in the background to compile their kernels."""

from collections.abc import Iterator

import numpy as np

from ...compiled.background import LATE_STEPS, BackgroundCompiler, Work
from ...data import DisparityMap, SegmentMap, Views
from ...plugins.registry import default_registry
from ...scene.scene import Scene
from ...session import run_simulated
from ..config.model import PipelineConfig
from .engine import Engine

MAX_PX = 768
# Segments of the made-up map: enough for every material that a rule may choose.
STRIPES = 6
FELT = "felt"  # the name of the simulated session, the last step of the warm-up
# The length of the simulated session, s: some ticks are enough to compile its loop.
SECONDS = 0.02


def warm_up(engine: Engine, want: str) -> BackgroundCompiler:
    """Return a block in which the engine makes this product, while its later kernels are compiled in the background."""
    return BackgroundCompiler(lambda: _work(engine, want))


def _work(engine: Engine, want: str) -> Work | None:
    from ...compiled.threads import thread_count  # imports numba, which is there by now

    views, config = engine.scene.views, engine.config
    segments = config.texture is not None and "segments" not in {*engine.starts, *engine.scene_products}
    touch = want == "touch" and config.render is not None and "touch" not in engine.starts
    if views is None or min(thread_count(), engine.threads or 2) < 2 or not (segments or touch):
        return None
    rows, columns = (slice(max(0, (size - MAX_PX) // 2), (size + MAX_PX) // 2) for size in views.shape)
    part = Views(np.ascontiguousarray(views.left[rows, columns]))
    depth = config.depth is not None and "disparity" in engine.starts
    names = frozenset([LATE_STEPS] * depth + ["segments"] * segments + ["touch", FELT] * touch)
    crop_config = config.with_values(scene=Scene("rehearsal", part), simplify=None)
    return Work(names, run_stages, (crop_config, part, segments, touch, depth))


def run_stages(config: PipelineConfig, views: Views, segments: bool, touch: bool, depth: bool = False) -> Iterator[str]:
    """Rehearse depth, segment, make the touch of a made-up surface, run it; yield each step's name when it is done."""
    if depth and config.depth is not None:
        config.depth.method.rehearse()
        yield LATE_STEPS
    if segments and config.texture is not None:
        config.texture.method.segment(views.left)
        yield "segments"
    if not touch:
        return
    columns = np.arange(views.shape[1])
    ramp, stripes = np.empty(views.shape, np.float32), np.empty(views.shape, np.int32)
    ramp[:], stripes[:] = columns + 1, columns * STRIPES // columns.size
    scene = Scene("rehearsal", views, DisparityMap(ramp), SegmentMap(stripes))
    engine = Engine(config.with_values(scene=scene), default_registry()).make("touch")
    yield "touch"
    device = config.felt_device
    if device is not None and device.spec().simulated:
        run_simulated(engine, device, SECONDS, limits=config.safety)
    yield FELT

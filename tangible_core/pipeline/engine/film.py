"""Films: the stages of a pipeline, applied to each frame of a video."""

import logging
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import final

from ...data import DisparityMap, Relief, Views
from ...errors import BrokenMethod, ConfigError
from ...plugins.interfaces import DepthEstimator, Film, Filming, Following, HapticDevice
from ...plugins.notes import note
from ...plugins.registry import Registry
from ...relief import ReliefScale
from ...scene.scene import Scene
from ...session.film import FrameMaker, Reliefs
from ..config.model import PipelineConfig
from .engine import Engine
from .stage import Context
from .stages.disparity import DisparityStage
from .stages.relief import ReliefStage
from .stages.touch import fit_to_device

log: logging.Logger = logging.getLogger(__name__)


@final
class PipelineFrames(FrameMaker):
    """The frames of a video, each made by the stages that make its first frame.

    The first frame alone decides the geometry of the cameras, as far as the depth method keeps it (`Following`), and
    whether the views are exchanged.
    """

    def __init__(self, config: PipelineConfig, scene: Scene) -> None:
        """Prepare the stages. Raises: ConfigError without a depth method."""
        if config.depth is None:
            raise config.missing("depth")
        self._config, self._scene = config, scene
        self._method: DepthEstimator = config.depth.method
        self._estimate: Callable[[Views], DisparityMap] = self._method.estimate
        self._are_exchanged = False
        self._relief = ReliefStage(Context(config, scene))

    def begin(self, views: Views) -> DisparityMap:
        """Return the disparity of the first frame in pixels of the pictures, and keep its decisions for the others."""
        stage = self._stage(views)
        self._estimate = (
            self._method.follow(stage.matched_views) if isinstance(self._method, Following) else self._method.estimate
        )
        estimate = stage.estimate(self._estimate)
        order = stage.order(estimate, stage.views)
        if order is not None:
            self._are_exchanged = order.exchanged
        return stage.in_picture_pixels(estimate, self._are_exchanged)

    def disparity(self, views: Views) -> DisparityMap:
        """Return the disparity of a frame in pixels of the pictures."""
        stage = self._stage(views)
        return stage.in_picture_pixels(stage.estimate(self._estimate), self._are_exchanged)

    def scale(self, disparity: DisparityMap) -> ReliefScale:
        """Return the scale of the relief of a map alone."""
        return self._relief.scale(disparity)

    def relief(self, disparity: DisparityMap, scale: ReliefScale) -> Relief:
        """Return the relief of a map by a scale, made as that of a still scene."""
        return self._relief.from_disparity(disparity, scale)

    def _stage(self, views: Views) -> DisparityStage:
        return DisparityStage(Context(self._config, replace(self._scene, views=views)))


def make_reliefs(config: PipelineConfig, scene: Scene) -> Reliefs:
    """Return the frames of a video scene as reliefs. Raises: ConfigError for a scene that does not move."""
    if scene.frames is None:
        raise ConfigError(f"the scene {scene.name} does not move; give it a `video:`")
    if config.relief_kind in ("edges", "figure", "lines"):
        by = config.relief_kind
        why = f"the relief of a video is made from the depth of each frame, and not of {by}; leave `by: {by}` out"
        raise config.error_at((("relief", "by"), why))
    if config.heights is not None:
        raise config.error_at(
            (
                ("heights",),
                "the relief of a video is made from the depth of each frame, and not of parts; leave `heights:` out, "
                "or take one frame as a `photo:`",
            )
        )
    return Reliefs(scene.frames.open, PipelineFrames(config, scene))


def make_film(engine: Engine, device: HapticDevice | None, period_s: float) -> Film:
    """Return the force law as a film that begins at the first frame. device: limits the materials; None does not."""
    config, scene = engine.config, engine.scene
    law = _filming(config, engine.registry)
    make_reliefs(config, scene)
    assert scene.frames is not None
    surface = engine.make("surface")
    if device is not None:
        surface, limits = fit_to_device(surface, config, device)
        if limits:
            note(log, limits)
    return law.film(surface, period_s, 1 / scene.frames.fps)


def _filming(config: PipelineConfig, registry: Registry) -> Filming:
    """Return the configured force law. Raises: ConfigError for a law that cannot render a moving surface."""
    if config.render is None:
        raise config.missing("render")
    law = config.render.method
    if not isinstance(law, Filming):
        can = " or ".join(_laws_that_film(registry))
        why = f": {law.why_still}" if law.why_still else ""
        raise config.error_at(
            (
                ("render",),
                f"the scene is a video, and {config.render.name} does not support moving surfaces{why}; use {can}, or "
                "take one frame as a `photo:` or a pair",
            )
        )
    return law


def _laws_that_film(registry: Registry) -> list[str]:
    """Return the names of the force laws that can render a moving surface, without those that cannot be imported."""
    names: list[str] = []
    for name in registry.names("render"):
        with suppress(BrokenMethod):
            if issubclass(registry.load("render", name), Filming):
                names.append(name)
    return names

"""A pipeline's scene as a film: what its rules make of each frame of a video."""

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
from ...scene import geometry, view_order
from ...scene.geometry import ValueRange
from ...scene.scene import Scene
from ...scene.scene_files import SceneFiles
from ...session.film import FrameMaker, Reliefs
from ..config.methods import NamedMethod
from ..config.model import PipelineConfig
from .engine import Engine
from .rules import estimated, fitted, in_pictures_pixels, relief_of
from .working_grid import WorkingGrid

log = logging.getLogger(__name__)


@final
class PipelineFrames(FrameMaker):
    """Frames by the rules of a pipeline: each as its first one is made, but for what is found once.

    Found once a scene: what the depth method says of the cameras (`Following`), and whether the views are exchanged.
    """

    def __init__(self, config: PipelineConfig, scene: Scene) -> None:
        """Raises: ConfigError without a depth method."""
        if config.depth is None:
            raise config.missing("depth")
        self._config, self._scene = config, scene
        self._depth: NamedMethod[DepthEstimator] = config.depth
        self._estimate: Callable[[Views], DisparityMap] = config.depth.method.estimate
        self._exchanged = False
        self._still = WorkingGrid(scene, config.size)

    def begin(self, views: Views) -> DisparityMap:
        """Of the first frame, in pixels of the pictures; what is found once is found in it."""
        grid, method = self._grid(views), self._depth.method
        assert grid.views is not None
        self._estimate = method.follow(grid.views) if isinstance(method, Following) else method.estimate
        made = estimated(self._depth, self._estimate, grid.views)
        files, calibration = self._scene.files, views.calibration
        if views.right is not None and not (isinstance(files, SceneFiles) and files.order == "as-named"):
            offset_px = calibration.offset_px / grid.factor if calibration else 0.0
            self._exchanged = view_order.view_order(made, grid.views.left, offset_px).exchanged
        return self._put_right(made, grid)

    def disparity(self, views: Views) -> DisparityMap:
        """Of one frame, in pixels of the pictures."""
        grid = self._grid(views)
        assert grid.views is not None
        return self._put_right(estimated(self._depth, self._estimate, grid.views), grid)

    def _put_right(self, made: DisparityMap, grid: WorkingGrid) -> DisparityMap:
        return in_pictures_pixels(view_order.put_right(made) if self._exchanged else made, grid)

    def nearness(self, disparity: DisparityMap) -> ValueRange:
        """Of what is known of a map."""
        views = self._scene.views
        return geometry.nearness_range(disparity, views.calibration if views else None)

    def relief(self, disparity: DisparityMap, spans: ValueRange) -> Relief:
        """As the relief of a scene that stands still is made, within this range."""
        return relief_of(disparity, self._still, self._config.size, spans)

    def _grid(self, views: Views) -> WorkingGrid:
        return WorkingGrid(replace(self._scene, views=views), self._config.size)


def reliefs_of(config: PipelineConfig, scene: Scene) -> Reliefs:
    """The frames of a scene that is a video, as reliefs. Raises: ConfigError for a scene that does not move."""
    if scene.video is None:
        raise ConfigError(f"the scene {scene.name} does not move; give it a `video:`")
    if config.heights is not None:
        raise config.complained(
            (
                ("heights",),
                "the relief of a video is made anew of the depth in each frame, and not of parts; leave `heights:` "
                "out, or take one frame as a `photo:`",
            )
        )
    return Reliefs(scene.video.open, PipelineFrames(config, scene))


def film_of(engine: Engine, device: HapticDevice | None, period_s: float) -> Film:
    """The law on the surface of the first frame, which goes on from there. device: whose materials fit.

    Raises: ConfigError for a scene that does not move, or a law that feels no surface that does.
    """
    config, scene = engine.config, engine.scene
    law = _filming(config, engine.registry)
    reliefs_of(config, scene)
    assert scene.video is not None
    surface = engine.make("surface")
    if device is not None:
        surface, said = fitted(surface, config, device)
        if said:
            note(log, said)
    return law.film(surface, period_s, 1 / scene.video.fps)


def _filming(config: PipelineConfig, registry: Registry) -> Filming:
    """The force law. Raises: ConfigError for one that feels no surface that moves."""
    if config.render is None:
        raise config.missing("render")
    law = config.render.method
    if not isinstance(law, Filming):
        can = " or ".join(_laws_that_film(registry))
        why = f": {law.why_still}" if law.why_still else ""
        raise config.complained(
            (
                ("render",),
                f"the scene is a video, and {config.render.name} feels no surface that moves{why}; use {can}, or take "
                "one frame as a `photo:` or a pair",
            )
        )
    return law


def _laws_that_film(registry: Registry) -> list[str]:
    """By name; one that cannot be imported has no say."""
    found: list[str] = []
    for name in registry.names("render"):
        with suppress(BrokenMethod):
            if issubclass(registry.load("render", name), Filming):
                found.append(name)
    return found

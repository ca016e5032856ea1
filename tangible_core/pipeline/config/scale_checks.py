"""Checks of the scale of a map of heights, that need no map."""

from collections.abc import Iterator

from ...scene.scene import Scene
from ...scene.scene_files import SceneFiles
from ...scene.workspace import MAX_WIDTH_M, MIN_WIDTH_M, kind_of
from .model import PipelineConfig
from .part_names import Wrong


def wrong_of_scale(config: PipelineConfig) -> Iterator[Wrong]:
    """Find a scale, or a range of heights, that the scene cannot have."""
    workspace, scene = config.workspace, config.scene
    given = [name for name in ("scale", "low_m", "high_m") if getattr(workspace, name) is not None]
    if not given:
        return
    place, files = ("workspace", given[0]), scene.files if isinstance(scene, Scene) else scene
    if kind_of(scene) != "heights":
        yield place, "is for a map of heights, and the scene is not one; leave it out, or name the map with `height:`"
    elif isinstance(files, SceneFiles) and files.invert and given != ["scale"]:
        yield (
            ("workspace", given[-1]),
            "is a height of the file, and `invert` turns these over; leave one of them out",
        )
    elif workspace.times is None:
        return
    elif config.measured is None:
        yield (
            place,
            "the map does not state the size of its cells on the ground; write it under `scene:`, such as `cell_m: 30`",
        )
    elif isinstance(scene, SceneFiles | Scene) and scene.relief_m is not None:
        yield ("scene", "relief_m"), "`workspace: {scale: ...}` already gives the height of the relief; leave it out"
    elif not MIN_WIDTH_M <= config.size.width_m <= MAX_WIDTH_M:
        ground_m = config.measured.width_m
        yield (
            place,
            f"{ground_m:.4g} m on the ground are {config.size.width_m:.3g} m wide at this scale, and a surface is "
            f"{MIN_WIDTH_M:g} to {MAX_WIDTH_M:g} m wide; at 1:{ground_m / 0.1:.0f} it is 0.1 m",
        )

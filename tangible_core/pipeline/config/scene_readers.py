"""The scene readers that are installed, by entry points: names from metadata, classes on first use."""

from collections.abc import Mapping
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from ...errors import BrokenMethod, shown
from ...plugins.naming import origin
from ...runtime.failure_log import where_kept
from ...scene.scene_files import SceneReader

GROUP = "tangible.scene"


@cache
def scene_reader_points() -> Mapping[str, EntryPoint]:
    """Return the entry points of all scene readers by the key that marks their form; the first of a name wins."""
    points = sorted(entry_points().select(group=GROUP), key=lambda each: (each.name, str(origin(each.dist))))
    return {point.name: point for point in reversed(points)}


def find_scene_reader(block: Any) -> type[SceneReader] | None:
    """Find the reader of a block `scene:` by its keys; None for a block of files."""
    if not isinstance(block, dict):
        return None
    return next((_load(point) for key, point in scene_reader_points().items() if key in block), None)


def _load(point: EntryPoint) -> type[SceneReader]:
    what = f"scene reader {point.name!r} ({point.value}, from {origin(point.dist)})"
    try:
        reader: Any = point.load()
    except (Exception, SystemExit) as error:
        raise BrokenMethod(
            f"{what} cannot be loaded: {type(error).__name__}: {shown(str(error), 500)}; {where_kept(error)}"
        ) from error
    if not (isinstance(reader, type) and issubclass(reader, SceneReader)):
        raise BrokenMethod(f"{what} is not a SceneReader")
    return reader


def scene_readers(distribution: str | None = None) -> list[type[SceneReader]]:
    """Load the readers of a distribution, or of all that are installed, in the order of their keys."""
    points = sorted(scene_reader_points().items())
    return [
        _load(point) for _, point in points if distribution is None or (point.dist and point.dist.name == distribution)
    ]

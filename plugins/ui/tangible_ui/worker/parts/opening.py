"""Start of the parts editor: a scene's picture and parts, also as files."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import UInt8

from tangible_core.data import PartMap, SegmentMap, SegmentTree, border_pixels, digest_of, to_rgb8
from tangible_core.parts import PartChoice, find_parts, part_sizes
from tangible_core.pipeline import Pipeline
from tangible_core.pipeline.config import PipelineConfig
from tangible_core.pipeline.engine import config_heights, divide_segments, is_at_hand
from tangible_core.plugins import Hierarchical
from tangible_core.runtime import cv2
from tangible_core.scene import Scene

from ..state import WorkerState
from ..view.files import leave, sweep, write_whole

FOLDER = "parts-"
# The texture method whose regions are proposed, where the document's own makes no tree.
TREES = "hierarchy"
# Folders of the editor that are kept: tabs may still fetch from the one before.
KEPT = 3
MAX_LOOKED_AT = 400_000  # maximum number of pixels among which a place well inside a part is searched


class Opened(NamedTuple):
    """Input of the editor."""

    pipeline: Pipeline  # the last pipeline; the files that it read are not read again
    scene: Scene
    picture: UInt8[np.ndarray, "h w 3"]
    parts: PartMap


def edited_pipeline(state: WorkerState, text: str, path: Path, sets: list[str]) -> Pipeline:
    """Return the pipeline of a text, derived from that of the last quick job here. Raises: ConfigError."""
    config, before = state.read_config(text, path, sets), state.editor
    derived = state.after(before.pipeline, config) if before and before.pipeline.config.scene == config.scene else None
    return derived or state.make_pipeline(text, path, sets)


def editor_input(state: WorkerState, pipeline: Pipeline) -> Opened:
    """Return a scene's picture and parts; those of the last scene are kept. Raises: as `parts_open`."""
    before, scene = state.editor, pipeline.scene
    if before is None or before.scene is not scene:
        before = Opened(pipeline, scene, to_rgb8(_picture(scene)), _parts(pipeline))
    state.editor = before._replace(pipeline=pipeline)
    return before


def region_tree(state: WorkerState, input_: Opened) -> SegmentTree:
    """Return the tree of the picture's regions, by the document's texture method if that makes one; it is kept."""
    if state.tree is None or state.tree[0] is not input_.picture:
        texture = input_.pipeline.config.texture
        method = texture.method if texture else None
        if not isinstance(method, Hierarchical):
            method = state.registry.load("texture", TREES)()
        assert isinstance(method, Hierarchical)
        state.tree = input_.picture, method.tree(input_.picture)
    return state.tree[1]


def digest(parts: PartMap, config: PipelineConfig) -> str:
    """Return the digest of the parts and of the document's entries for them."""
    choices = tuple((number, repr(entry)) for number, entry in sorted((config.parts or {}).items()))
    return digest_of((parts.labels, choices, repr(config_heights(config))))


def part_entries(parts: PartMap, choices: Mapping[int, PartChoice]) -> list[dict[str, Any]]:
    """Return every part with its entry, by label, its number of pixels, and a pixel well inside it."""
    places = _places(parts)
    entries = [choices.get(number, PartChoice()).model_dump(mode="json") for number in range(parts.count)]
    sizes = part_sizes(parts).tolist()
    return [
        {"number": number, **entries[number], "pixels": sizes[number], "at": places[number]}
        for number in range(parts.count)
    ]


def _picture(scene: Scene) -> np.ndarray:
    """Return the left view, the photo, or the heights as grey values, higher being lighter."""
    if scene.views is not None:
        return scene.views.left
    height = scene.height
    assert height is not None
    valid_mask = np.isfinite(height)
    if not valid_mask.any():
        return np.zeros(height.shape, np.uint8)
    low, high = (float(limit) for limit in (height[valid_mask].min(), height[valid_mask].max()))
    return np.where(valid_mask, np.round(255 * ((height - low) / ((high - low) or 1))), 0).astype(np.uint8)


def _parts(pipeline: Pipeline) -> PartMap:
    """Return the parts of the scene's segments, or those that a document names; one part without any."""
    scene = pipeline.scene
    if scene.segments is not None:
        return divide_segments(scene.segments)
    is_made = pipeline.config.by_parts and is_at_hand(pipeline.engine, "parts")
    if is_made and (parts := pipeline.make("parts")) is not None:
        return parts
    return find_parts(SegmentMap(np.zeros(scene.shape, np.int32)))


def _places(parts: PartMap) -> list[tuple[int, int]]:
    """Return column and row of a pixel well inside each part: of a sample, the farthest from all borders."""
    step = max(1, round((parts.labels.size / MAX_LOOKED_AT) ** 0.5))
    labels = np.pad(parts.labels[::step, ::step], 1, constant_values=-1)
    inside = (~border_pixels(labels)).view(np.uint8)
    far = np.asarray(cv2.distanceTransform(inside, cv2.DIST_L2, 3)) + inside
    order = np.argsort(far, axis=None)
    best = np.full(parts.count + 1, -1, np.int64)
    best[labels.ravel()[order]] = order  # the last assignment stays: the farthest
    rows, columns = np.divmod(best[: parts.count], labels.shape[1])
    places = [(int(column), int(row)) for row, column in zip((rows - 1) * step, (columns - 1) * step, strict=True)]
    without_place = np.flatnonzero(best[: parts.count] < 0)  # parts between the sampled pixels
    if without_place.size:
        flat = parts.labels.ravel()
        first = np.empty(parts.count, np.int64)
        first[flat[::-1]] = np.arange(flat.size - 1, -1, -1)
        for number in without_place.tolist():
            row, column = divmod(int(first[number]), parts.labels.shape[1])
            places[number] = column, row
    return places


def leave_files(input_: Opened, at: Path) -> None:
    """Write the files that an editor fetches, atomically."""

    def write(part: Path) -> None:
        (part / "labels.u16").write_bytes(input_.parts.labels.astype("<u2").data)
        write_whole(input_.picture, part / "picture.jpg")

    leave(at, "the parts", write)
    (at / "labels.u16").touch()
    sweep(at.parent, f"{FOLDER}*/labels.u16", KEPT)

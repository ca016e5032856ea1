"""Jobs of the parts editor: open it, propose a part, follow edges, feel heights, save the parts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tangible_core.data import HapticSurface, SegmentMap, digest_of
from tangible_core.errors import ConfigError
from tangible_core.parts import find_parts
from tangible_core.pipeline import Pipeline
from tangible_core.pipeline.config import edit_text, parse_config, relocate_text
from tangible_core.pipeline.engine import (
    PartHeightPreview,
    check_parts,
    config_heights,
    preview_config,
    without_entries,
)

from ..parts import opening, saving
from ..parts.outlines import snap
from ..parts.proposals import Kind, as_points, propose, propose_region, runs
from ..parts.saving import as_png, unpack
from ..state import WorkerState
from ..view.files import show
from ..view.surface_view import SurfaceView, view_parts
from .making import pack_loop_input
from .table import job


@dataclass
class DrawnPreview:
    """Heights that are tried, and what pages were shown of them."""

    preview: PartHeightPreview
    pipeline: Pipeline
    view: SurfaceView | None = None  # the last view; `surface` is the current surface if that is a newer one
    surface: HapticSurface | None = None


@job(quick=True)
def parts_open(
    state: WorkerState, text: str, path: Path, sets: list[str], opened: str = "", uploads: Path = Path()
) -> dict[str, Any]:
    """Return what an editor begins with; write the picture, and the part of each pixel, into files."""
    pipeline = opening.edited_pipeline(state, text, path, sets)
    input_, config = opening.editor_input(state, pipeline), pipeline.config
    at = f"{opening.FOLDER}{digest_of((input_.picture, input_.parts))}"
    opening.leave_files(input_, state.folder / at)
    in_file, beside = saving.is_in_file(path, opened), saving.folder_of_photograph(config, uploads)
    by_parts = config.with_values(heights=config_heights(config))
    rows, columns = input_.parts.labels.shape
    return {
        "columns": columns,
        "rows": rows,
        "picture": f"{at}/picture.jpg",
        "labels": f"{at}/labels.u16",
        "digest": opening.digest(input_.parts, config),
        "parts": opening.part_entries(input_.parts, config.choices),
        "divided": input_.scene.segments is not None or input_.parts.count > 1,
        "heights": config_heights(config).model_dump(mode="json"),
        "top_m": max(0.0, by_parts.top_m),
        "widthM": by_parts.size.width_m,
        "file": str(path) if in_file else "",
        "beside": "" if in_file or beside is None else str(beside),
        "title": config.title,
        "language": config.language,
    }


@job(page=True)
def parts_first(state: WorkerState, text: str, path: Path, sets: list[str]) -> dict[str, Any]:
    """Propose all parts of an undivided picture: the file of each pixel's part, and the height of each part, m."""
    from tangible_authoring.first_parts import proposed_heights, proposed_parts, segments_for

    input_ = opening.editor_input(state, opening.edited_pipeline(state, text, path, sets))
    if input_.scene.views is None:
        return {"labels": "", "heights_m": []}
    method = opening.TREES if input_.scene.kind.likely == "photograph" else "flat"  # as a starter file has it
    texture = f"texture={{use: {method}, segments: {segments_for()}}}"
    pipeline = state.make_pipeline(text, path, [*sets, texture])
    parts, config = proposed_parts(pipeline), pipeline.config
    by_parts = config.with_values(heights=config_heights(config))
    heights = proposed_heights(pipeline, parts, max(0.0, by_parts.top_m))
    at = f"{opening.FOLDER}{digest_of((input_.picture, parts))}"
    opening.leave_files(input_._replace(parts=parts), state.folder / at)
    return {"labels": f"{at}/labels.u16", "heights_m": list(heights.heights_m)}


@job(quick=True)
def parts_propose(
    state: WorkerState,
    text: str,
    path: Path,
    sets: list[str],
    points: Sequence[Sequence[float]],
    width_px: float,
    kind: Kind,
    within: Sequence[float] | None,
    level: float,
) -> dict[str, Any]:
    """Propose the part under a stroke: its box, and run lengths of pixels outside and inside, row by row."""
    input_ = opening.editor_input(state, opening.edited_pipeline(state, text, path, sets))
    stroke = as_points(points, input_.picture.shape)
    if kind == "regions":
        box, mask = propose_region(opening.region_tree(state, input_), stroke, width_px, level, within)
    else:
        box, mask = propose(input_.picture, stroke, width_px, kind, within)
    return {"box": list(box), "runs": runs(mask)}


@job(page=True)
def parts_snap(
    state: WorkerState, text: str, path: Path, sets: list[str], points: list[list[float]], reach_px: float
) -> dict[str, Any]:
    """Move a closed outline to the strongest edges within reach. Raises: as `parts_propose`."""
    picture = opening.editor_input(state, opening.edited_pipeline(state, text, path, sets)).picture
    outline = as_points(points, picture.shape)
    return {"points": np.round(snap(picture, outline, reach_px), 2).tolist()}


@job(quick=True)
def parts_save(
    state: WorkerState,
    text: str,
    path: Path,
    sets: list[str],
    sent: Path,
    parts: Sequence[Mapping[str, Any]],
    heights: Mapping[str, Any] | None,
    words: Mapping[str, str | None],
    of: str,
    opened: str,
    store: Path,
    drawn: Path,
    beside: bool = False,
    earlier: Sequence[str] = (),
) -> dict[str, Any]:
    """Save labels that a page has uploaded, and the document with the entries of their parts, or change nothing."""
    pipeline = opening.edited_pipeline(state, text, path, sets)
    if of and of != opening.digest(opening.editor_input(state, pipeline).parts, pipeline.config):
        raise ConfigError("the parts were changed elsewhere meanwhile, as in another tab; open the editor again")
    labels = unpack(sent, pipeline.scene.shape)
    label_values, segments = saving.compact(labels)
    part_map = find_parts(SegmentMap(segments))
    choices, numbers = saving.number_parts(
        parts, [int(label_values[segment]) for segment in part_map.segments], part_map.labels
    )
    file = path if saving.is_in_file(path, opened) else saving.new_file(pipeline.config, path, drawn, beside)
    picture = as_png(saving.undo_framing(part_map.labels, pipeline.config), file.name)
    place = saving.place_next_to(file)
    relocated_text = relocate_text(text, path, parse_config(text, path, state.registry), file)
    new_text = saving.document_with_parts(relocated_text, file, place, choices, heights, words)
    if pipeline.config.materials.by == "roughness":
        new_text = edit_text(new_text, file, {("materials", "by"): "rules"})  # parts are of what they are said to be of
    config = parse_config(new_text, file, state.registry, sets)
    check_parts(config, part_map, labels.shape[1])
    new_texts = saving.keep_replaced(place, picture, store, [*earlier, text], path)
    saving.write(place, picture, file, new_text)
    saving.warn_of_numbers(config, opening.editor_input(state, pipeline), part_map)
    of = opening.digest(part_map, config)
    return {"text": new_text, "path": str(place), "file": file, "numbers": numbers, "digest": of, "moved": new_texts}


@job(quick=True)
def parts_heights(
    state: WorkerState,
    text: str,
    path: Path,
    sets: list[str],
    heights_m: Sequence[float | None],
    materials: Sequence[str | None] | None = None,
    heights: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Return the loop's input with other heights of parts, by number; None for what the recipe finds."""
    pipeline = opening.edited_pipeline(state, text, path, sets)
    opening.editor_input(state, pipeline)
    config = preview_config(pipeline.config, heights, pipeline.scene.shape)
    if pipeline.scene.segments is None and not pipeline.config.by_parts:
        raise ConfigError("no parts are saved yet; save what was drawn, and its heights can be felt")
    bare, before = Pipeline.from_config(without_entries(config), like=pipeline), state.preview
    if before is None or not before.preview.holds_for(bare.engine):
        state.preview = DrawnPreview(PartHeightPreview(bare.engine, before and before.preview), bare)
    by = (heights or {}).get("by", config_heights(pipeline.config).by)
    trial = state.preview.preview.try_heights(config, heights_m, by, materials)
    state.preview.surface = trial.surface
    return pack_loop_input(trial.touch, trial.felt, config)


@job(quick=True)
def parts_shown(state: WorkerState) -> None:
    """Send pages the surface that `parts_heights` made last."""
    current: DrawnPreview | None = state.preview
    if current is None or current.surface is None:
        return
    surface, current.surface = current.surface, None
    current.view = view_parts(current.pipeline, surface, current.view)
    if current.view.digest != state.shown_digest:
        state.tell("scene", **show(current.view, state.folder))
        state.shown_digest = current.view.digest

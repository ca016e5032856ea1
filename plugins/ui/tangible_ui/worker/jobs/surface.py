"""Jobs that describe the surface on the screen: in words, and a fine texture as heights."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32, Float64, Shaped

from tangible_core.data import Material, digest_of
from tangible_core.errors import GeometryError
from tangible_core.pipeline import Pipeline
from tangible_core.pipeline.engine import product_at_hand
from tangible_core.pipeline.output import export_title
from tangible_core.scene import kind_of
from tangible_legibility.words.languages import LANGUAGES, Language
from tangible_render.haptic_textures.table import waves
from tangible_report.description import describe, describe_at_length, facts, page_of
from tangible_report.description.at_length import tell

from ..state import WorkerState
from ..view.files import ABOUT
from ..view.surface_view import SurfaceView
from .table import job

KEPT = 8
MAX_PIXELS = 512
LARGEST_M = 0.1


@job(page=True)
def texture_patch(
    state: WorkerState, digest: str, x_m: float, y_m: float, side_m: float, pixels: int = 192
) -> dict[str, Any]:
    """Write the texture heights of a square around a place, metres, far row first. Raises: GeometryError."""
    at = state.folder / digest
    if not re.fullmatch("[0-9a-f]{32}", digest) or not (at / ABOUT).is_file():
        raise GeometryError("this surface is not kept any more; make it again")
    square = 0 < side_m <= LARGEST_M and 1 <= pixels <= MAX_PIXELS and np.isfinite(x_m + y_m)
    if not square:
        raise GeometryError(
            f"a texture is shown on up to {LARGEST_M} m and {MAX_PIXELS} pixels, not {side_m} m, {pixels}"
        )
    heights = patch(at, (x_m, y_m), side_m, pixels)
    name = f"texture-{digest_of((x_m, y_m, side_m, pixels))}.f32"
    (at / name).write_bytes(heights.astype("<f4").data)
    for old in sorted(at.glob("texture-*.f32"), key=lambda path: path.stat().st_mtime_ns)[:-KEPT]:
        old.unlink(missing_ok=True)
    return {"file": name, "x_m": x_m, "y_m": y_m, "side_m": side_m, "pixels": pixels}


def patch(at: Path, centre_m: tuple[float, float], side_m: float, pixels: int) -> Float32[np.ndarray, "n n"]:
    """Return heights of all materials' textures in a square, at pixel centres; 0 beyond the surface."""
    about = json.loads((at / ABOUT).read_text())
    steps_m = ((np.arange(pixels) + 0.5) / pixels - 0.5) * side_m
    x, y = np.meshgrid(centre_m[0] + steps_m, centre_m[1] - steps_m)
    heights = np.zeros((pixels, pixels))
    if not about["labels"] or not about["materials"]:
        return heights.astype(np.float32)
    width_m, length_m = about["extent_m"]
    inside = (np.abs(x) <= width_m / 2) & (np.abs(y) <= length_m / 2)
    kinds = np.fromfile(at / "materials.u16", "<u2")[_labels(at, about, x, y)]
    for kind in np.unique(kinds[inside]):
        here = inside & (kinds == kind)
        heights[here] = _heights(Material(**about["materials"][kind]), x[here], y[here])
    return heights.astype(np.float32)


def _labels(at: Path, about: dict[str, Any], x: np.ndarray, y: np.ndarray) -> Shaped[np.ndarray, "n n"]:
    """Return the label of the cell that contains each place, or is nearest to it."""
    rows, columns, (width_m, length_m) = about["rows"], about["columns"], about["extent_m"]
    labels = np.memmap(at / "labels-0.u", f"<u{about['label_bytes']}", "r", shape=(rows, columns))
    row = np.clip(((0.5 - y / length_m) * rows).astype(int), 0, rows - 1)
    column = np.clip(((x / width_m + 0.5) * columns).astype(int), 0, columns - 1)
    return labels[row, column]


def _heights(
    material: Material, x: Float64[np.ndarray, " n"], y: Float64[np.ndarray, " n"]
) -> Float64[np.ndarray, " n"]:
    total = np.zeros(x.shape)
    for fx, fy, amplitude_m, phase in zip(*waves(material), strict=True):
        total += amplitude_m * np.cos(2 * np.pi * (fx * x + fy * y + phase))
    return total


@job(page=True)
def description(state: WorkerState, language: Language) -> dict[str, Any] | None:
    """Describe the surface at length, as text and as an HTML page; None without a surface."""
    if state.description is None:
        return None
    pipeline, view = state.description
    config, kind = pipeline.config, kind_of(pipeline.scene)
    title, parts = export_title(config, pipeline.scene), facts(view.surface)
    people = _people(pipeline)
    texts = tell(view.surface, title, language, parts, kind, people)
    return {
        "digest": view.digest,
        "title": texts.title,
        "overview": " ".join(texts.overview),
        "heading": texts.heading,
        "parts": [{"label": part.label, "says": " ".join(part.sentences)} for part in texts.parts],
        "left_out": texts.left_out,
        "text": "\n".join(describe_at_length(view.surface, title, language, parts, kind, people)),
        "html": page_of(view.surface, title, language, parts, kind, people, named_in=config.language),
    }


def description_data(pipeline: Pipeline, view: SurfaceView) -> dict[str, Any]:
    """Return descriptions by language."""
    scene = pipeline.scene
    kind, people = kind_of(scene), _people(pipeline)
    return {
        "digest": view.digest,
        "says": {language: describe(view.surface, scene.name, language, kind, people) for language in LANGUAGES},
    }


def _people(pipeline: Pipeline) -> int:
    """Return the number of people known to be in front; 0 where the relief is not made of what networks see."""
    figure = product_at_hand(pipeline.engine, "figure") if pipeline.config.relief_kind == "figure" else None
    return 0 if figure is None else figure.people

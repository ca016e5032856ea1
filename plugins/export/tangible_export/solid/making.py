"""The solid of a relief, with its title and notes on how it will print, and its picture, lit from the upper left."""

import logging
from collections.abc import Mapping
from dataclasses import replace
from importlib.util import find_spec
from math import ceil
from typing import NamedTuple, cast

import cv2
import numpy as np
from jaxtyping import Float64, UInt8

from tangible_core.data import Record, Relief, Work
from tangible_core.errors import GeometryError, OutputError, quoted
from tangible_core.plugins import note
from tangible_core.runtime import plain_opencv

from ..braille import BrailleChoice, Cells, in_grade, title_in_braille, width_m, wrapped, written_by
from .closed import Solid, close_solid
from .plate import MIN_RIM_M, Layout, plate
from .triangles import Triangles, all_triangles, few_triangles, sample_nodes

log: logging.Logger = logging.getLogger(__name__)

INSTALL = "pip install pydelatin"
MAX_NODES = 24_000_000  # 5333 x 4500 nodes take a gibibyte
MAX_TRIANGLES = 2_000_000  # files of 100 MB, which slicers still read
MAX_IN_GRID = MAX_TRIANGLES // 2  # without pydelatin, each node takes two triangles
MIN_LINE_M = width_m((0,) * 3)  # a letter, its capital sign, and a hyphen
NARROWEST_M = 1e-4
MAX_LINES = 6  # nobody reads a longer text on a plate

THIN_BASE_M = 0.0008
"""Thinnest base that neither bends nor breaks; 0.0015 is better (Round Table, Guidelines for producing accessible 3D
prints)."""
LARGEST_BED_M = 0.25  # most printers for homes and schools. A convention of ours
NOZZLE_M, LAYER_M = 0.0004, 0.00015  # most printers. A convention of ours
MIN_AREA_M2, MIN_SHARE = 2.5e-7, 0.001
"""Smallest area of thin shapes and smallest share of steep pixels that are reported."""
STEEPEST_DEG = 45  # the largest overhang, from the upright, that plastic holds without support
ROWS_AT_ONCE = 256
COARSE_M = 2e-4  # less than a pixel
SHADED_NODES = 300
WIDTH_PX = 640
MARGIN_PX = 8
# Angle between the view and the plumb line: walls are seen, and nothing hides much behind them.
TILT = np.radians(35)
LIGHT = np.array([-0.5, 0.35, 0.8]) / np.linalg.norm([-0.5, 0.35, 0.8])
# Brightness of what lies lowest, as a share of what lies highest: steps between level faces are seen.
LOWEST = 0.72
DARKEST, LIGHTEST = 70, 250


class PlateOptions(NamedTuple):
    """The options of a `SolidExporter` that shape its plate."""

    error_m: float
    base_m: float
    rim_m: float
    corner_mark: bool
    braille: bool | BrailleChoice
    braille_language: str | None


def make_solid(options: PlateOptions, work: Work) -> tuple[Solid, Layout]:
    """Return a closed solid and its layout. Raises: GeometryError, BrailleError, OutputError as `write`."""
    relief = work.relief
    if (highest_m := float(relief.height_m.max())) <= options.error_m:
        raise GeometryError(
            f"the relief is {1000 * highest_m:.3g} mm high, and error_m is {1000 * options.error_m:.3g} mm: the print "
            "would be flat; take a picture that is not of one shade, or give its parts heights"
        )
    if few := find_spec("pydelatin") is not None:
        surface = sample_nodes(relief, MAX_NODES, "make the picture smaller")
    else:
        fault = (
            "pydelatin is not installed: the solid has two triangles for each pixel, some ten times as many as it needs"
        )
        note(log, f"{fault}; {INSTALL}", logging.WARNING)
        surface = sample_nodes(relief, MAX_IN_GRID, INSTALL)
    layout = _layout(options, work)
    note_print_problems(surface, layout.size_m, options.base_m)
    triangles = _few(surface, options.error_m) if few else all_triangles(surface.height_m)
    solid = close_solid(plate(surface, triangles, layout), options.base_m)
    size = " x ".join(f"{side:.1f}" for side in solid.vertices_mm.max(axis=0))
    note(log, f"the plate is {size} mm, of {len(solid.triangles):,} triangles")
    return solid, layout


def _few(surface: Relief, error_m: float) -> Triangles:
    triangles = few_triangles(surface.height_m, surface.pitch_m, error_m, MAX_TRIANGLES)
    if triangles.off_m > error_m:
        fault = f"the solid is off by up to {1000 * triangles.off_m:.2g} mm"
        why = f"it would take more than {MAX_TRIANGLES:,} triangles"
        cure = "smooth the relief with workspace.smooth_m, or make error_m larger"
        note(log, f"{fault}, as {why}; {cure}", logging.WARNING)
    return triangles


def _layout(options: PlateOptions, work: Work) -> Layout:
    picture_m = work.relief.extent_m
    rim_m = options.rim_m if options.rim_m >= NARROWEST_M else 0.0
    has_title = options.braille and bool(work.title.strip())
    items = [name for name, on in (("title", has_title), ("corner mark", options.corner_mark)) if on]
    if options.rim_m < MIN_RIM_M:
        if items:
            fault = f"a rim of {1000 * options.rim_m:.2g} mm has no room for the {' and the '.join(items)}"
            note(log, f"{fault}; make rim_m {1000 * MIN_RIM_M:.0f} mm or more", logging.WARNING)
        return Layout(picture_m, rim_m)
    return Layout(picture_m, rim_m, _title(options, work) if has_title else (), options.corner_mark)


def _title(options: PlateOptions, work: Work) -> tuple[Cells, ...]:
    grade = BrailleChoice.in_force(options.braille).grade
    language, room_m = in_grade(options.braille_language or work.language, grade), work.relief.extent_m[0]
    if room_m < MIN_LINE_M:
        raise OutputError(
            f"the picture is {1000 * room_m:.3g} mm wide, too narrow for its title in braille; make longer_side_m "
            "larger, or set braille: false"
        )
    if not (title := title_in_braille(work.title, language)):
        return ()
    lines = tuple(wrapped(title, language, room_m))
    if len(lines) > MAX_LINES:
        raise OutputError(
            f"the title {quoted(work.title)} takes {len(lines)} lines of braille of {1000 * room_m:.0f} mm; a plate "
            f"has {MAX_LINES}: shorten it, make longer_side_m larger, or set braille: false"
        )
    note(log, f"the title is in braille by {written_by(language)}, {len(lines)} line{'s' if len(lines) > 1 else ''}")
    return lines


def note_print_problems(picture: Relief, size_m: tuple[float, float], base_m: float) -> None:
    """Note shapes that are too thin, too large (a plate of `size_m`) or too steep to print."""
    if base_m < THIN_BASE_M:
        fault = f"a base of {1000 * base_m:.2g} mm bends and breaks"
        note(log, f"{fault}; make base_m {1000 * THIN_BASE_M:.1g} mm or more, better 1.5 mm", logging.WARNING)
    if (side_m := max(size_m)) > LARGEST_BED_M:
        fault = f"the plate is {1000 * side_m:.0f} mm long, more than the bed of most printers has room for"
        note(log, f"{fault}; for {1000 * LARGEST_BED_M:.0f} mm, make longer_side_m or rim_m smaller", logging.WARNING)
    _note_thin(picture)
    _note_steep(picture)


def _note_thin(picture: Relief) -> None:
    """Note shapes that an opening with a disc of a nozzle's size removes."""
    heights = picture.height_m
    size = tuple(max(1, ceil(NOZZLE_M / pitch - 1e-6)) for pitch in picture.pitch_m)
    middle = tuple((side - 1) // 2 for side in size)
    back = tuple(side - 1 - at for side, at in zip(size, middle, strict=True))  # an even side has no middle
    with plain_opencv():
        kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE if min(size) > 2 else cv2.MORPH_RECT, size)
        lost_m = heights - cv2.dilate(cv2.erode(heights, kernel, anchor=middle), kernel, anchor=back)
    area_m2 = np.count_nonzero(lost_m > LAYER_M) * picture.pitch_m[0] * picture.pitch_m[1]
    if area_m2 < MIN_AREA_M2:
        return
    fault = f"the printer may leave out shapes thinner than a nozzle of {1000 * NOZZLE_M:.1g} mm"
    where = f"{1e6 * area_m2:,.1f} square mm of the picture, up to {1000 * lost_m.max():.2g} mm high"
    note(log, f"{fault}: {where}; smooth the relief with workspace.smooth_m, or print it larger", logging.WARNING)


def _note_steep(picture: Relief) -> None:
    """Note steep slopes: they overhang when the plate is printed standing up, never when it lies flat."""
    heights = picture.height_m
    rows, columns = heights.shape
    limit = float(np.tan(np.radians(STEEPEST_DEG)))
    steep = 0
    for first in range(0, rows - 1, ROWS_AT_ONCE):
        strip = heights[first : first + ROWS_AT_ONCE + 1]
        right = np.diff(strip, axis=1)[:-1] / picture.pitch_m[0]
        down = np.diff(strip, axis=0)[:, :-1] / picture.pitch_m[1]
        steep += np.count_nonzero(np.hypot(right, down) > limit)
    share = steep / max(1, (rows - 1) * (columns - 1))
    if share >= MIN_SHARE:
        fault = f"{100 * share:.2g} % of the picture is steeper than {STEEPEST_DEG} degrees"
        note(log, f"{fault}: print the plate lying flat; standing up, it would need supports there")


def coarse_work(work: Work) -> Work:
    """Return the work with a relief of at most SHADED_NODES along each side."""
    relief = work.relief
    step = -(-max(relief.height_m.shape) // SHADED_NODES)
    coarse = Relief(np.ascontiguousarray(relief.height_m[::step, ::step]), relief.extent_m)
    return replace(work, products=cast("Mapping[str, Record | None]", {**work.products, "relief": coarse}))


def shaded(solid: Solid) -> UInt8[np.ndarray, "h w"]:
    """Return the solid on white; nearer triangles are painted over farther ones."""
    at = solid.vertices_mm[solid.triangles]
    normals = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    towards = np.array([0.0, -np.sin(TILT), np.cos(TILT)])
    visible = (_along(normals, towards) > 0) & (lengths > 0)
    at, normals = at[visible], normals[visible] / lengths[visible, None]
    places, (rows, columns) = _on_picture(at)
    high = at[..., 2].mean(axis=1)
    shares = np.clip((high - (low := np.percentile(high, 1))) / (high.max() - low + 1e-9), 0, 1)
    greys = (DARKEST + (LIGHTEST - DARKEST) * np.clip(_along(normals, LIGHT), 0, 1)) * (LOWEST + (1 - LOWEST) * shares)
    picture = np.full((rows, columns), 255, np.uint8)
    corners = np.rint(16 * places).astype(np.int32)
    for number in np.argsort(_along(at.mean(axis=1), towards)).tolist():
        cv2.fillConvexPoly(picture, corners[number], float(greys[number]), cv2.LINE_8, shift=4)
    return picture


def _along(vectors: Float64[np.ndarray, "m 3"], direction: Float64[np.ndarray, "3"]) -> Float64[np.ndarray, "m"]:
    return np.einsum("ij,j->i", vectors, direction)


def _on_picture(at_mm: Float64[np.ndarray, "m 3 3"]) -> tuple[Float64[np.ndarray, "m 3 2"], tuple[int, int]]:
    """Return the corners of triangles in pixels, x and y down, and the picture's rows and columns."""
    up = at_mm[..., 1] * np.cos(TILT) + at_mm[..., 2] * np.sin(TILT)
    flat = np.stack([at_mm[..., 0], -up], axis=-1)
    low = flat.min(axis=(0, 1))
    size_mm = flat.max(axis=(0, 1)) - low
    scale = (WIDTH_PX - 2 * MARGIN_PX) / size_mm.max()
    columns, rows = np.ceil(scale * size_mm).astype(int) + 2 * MARGIN_PX
    return scale * (flat - low) + MARGIN_PX, (int(rows), int(columns))

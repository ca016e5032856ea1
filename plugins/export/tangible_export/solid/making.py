"""The solid of a relief, with its title and notes on how it will print."""

import logging
from importlib.util import find_spec
from typing import NamedTuple

from tangible_core.data import Relief, Work
from tangible_core.errors import GeometryError, OutputError, quoted
from tangible_core.plugins import note

from ..braille import Cells, title_in_braille, width_m, wrapped, written_by
from .closed import Solid, close_solid
from .plate import LEAST_RIM_M, Layout, plate
from .printable import note_print_problems
from .triangles import Triangles, all_triangles, few_triangles, sample_nodes

log: logging.Logger = logging.getLogger(__name__)

INSTALL = "pip install pydelatin"
MOST_NODES = 24_000_000
"""Largest number of nodes: 5333 x 4500 take a gibibyte."""
MOST_TRIANGLES = 2_000_000
"""Largest number of triangles, in files of 100 MB, that slicers still read."""
MOST_IN_GRID = MOST_TRIANGLES // 2
"""Largest number of nodes without pydelatin: each takes two triangles."""
LEAST_LINE_M = width_m((0,) * 3)
"""Shortest line of braille: a letter, its capital sign, and a hyphen."""
NARROWEST_M = 1e-4
"""Narrowest rim; a narrower one is left out."""
MOST_LINES = 6
"""Largest number of lines of braille: nobody reads a longer text on a plate."""


class PlateOptions(NamedTuple):
    """The options of a `SolidExporter` that shape its plate."""

    error_m: float
    base_m: float
    rim_m: float
    corner_mark: bool
    braille: bool
    braille_language: str | None


def make_solid(options: PlateOptions, work: Work) -> tuple[Solid, Layout]:
    """Return a closed solid of the relief, and its layout.

    Raises: GeometryError if the relief has no height, BrailleError for a title that cannot be written, OutputError for
    a title that is too long for the plate.
    """
    relief = work.relief
    _check_height(relief, options.error_m)
    if few := find_spec("pydelatin") is not None:
        surface = sample_nodes(relief, MOST_NODES, "make the picture smaller")
    else:
        fault = (
            "pydelatin is not installed: the solid has two triangles for each pixel, some ten times as many as it needs"
        )
        note(log, f"{fault}; {INSTALL}", logging.WARNING)
        surface = sample_nodes(relief, MOST_IN_GRID, INSTALL)
    layout = _layout(options, work)
    note_print_problems(surface, layout.size_m, options.base_m)
    triangles = _few(surface, options.error_m) if few else all_triangles(surface.height_m)
    solid = close_solid(plate(surface, triangles, layout), options.base_m)
    size = " x ".join(f"{side:.1f}" for side in solid.vertices_mm.max(axis=0))
    note(log, f"the plate is {size} mm, of {len(solid.triangles):,} triangles")
    return solid, layout


def _few(surface: Relief, error_m: float) -> Triangles:
    triangles = few_triangles(surface.height_m, surface.pitch_m, error_m, MOST_TRIANGLES)
    if triangles.off_m > error_m:
        fault = f"the solid is off by up to {1000 * triangles.off_m:.2g} mm"
        why = f"it would take more than {MOST_TRIANGLES:,} triangles"
        cure = "smooth the relief with workspace.smooth_m, or make error_m larger"
        note(log, f"{fault}, as {why}; {cure}", logging.WARNING)
    return triangles


def _check_height(relief: Relief, error_m: float) -> None:
    highest_m = float(relief.height_m.max())
    if highest_m <= error_m:
        raise GeometryError(
            f"the relief is {1000 * highest_m:.3g} mm high, and error_m is {1000 * error_m:.3g} mm: the print would be "
            "flat; take a picture that is not of one shade, or give its parts heights"
        )


def _layout(options: PlateOptions, work: Work) -> Layout:
    picture_m = work.relief.extent_m
    rim_m = options.rim_m if options.rim_m >= NARROWEST_M else 0.0
    has_title = options.braille and bool(work.title.strip())
    wanted = [name for name, on in (("title", has_title), ("corner mark", options.corner_mark)) if on]
    if options.rim_m < LEAST_RIM_M:
        if wanted:
            fault = f"a rim of {1000 * options.rim_m:.2g} mm has no room for the {' and the '.join(wanted)}"
            note(log, f"{fault}; make rim_m {1000 * LEAST_RIM_M:.0f} mm or more", logging.WARNING)
        return Layout(picture_m, rim_m)
    return Layout(picture_m, rim_m, _title(options, work) if has_title else (), options.corner_mark)


def _title(options: PlateOptions, work: Work) -> tuple[Cells, ...]:
    """Return the title in lines of braille."""
    language, room_m = options.braille_language or work.language, work.relief.extent_m[0]
    if room_m < LEAST_LINE_M:
        raise OutputError(
            f"the picture is {1000 * room_m:.3g} mm wide, too narrow for its title in braille; make longer_side_m "
            "larger, or set braille: false"
        )
    if not (title := title_in_braille(work.title, language)):
        return ()
    lines = tuple(wrapped(title, language, room_m))
    if len(lines) > MOST_LINES:
        raise OutputError(
            f"the title {quoted(work.title)} takes {len(lines)} lines of braille of {1000 * room_m:.0f} mm; a plate "
            f"has {MOST_LINES}: shorten it, make longer_side_m larger, or set braille: false"
        )
    note(log, f"the title is in braille by {written_by(language)}, {len(lines)} line{'s' if len(lines) > 1 else ''}")
    return lines

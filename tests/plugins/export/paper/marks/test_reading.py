"""Marks read from a page: if a case fails, gaps are measured between other marks than are printed."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from tangible_core.errors import BrokenMethod
from tangible_export.paper.marks.reading import read
from tangible_export.paper.marks.rendering import black, save_pdf
from tangible_report.drawing.files import WRITERS


def page(shapes: str, box: str = "0 0 8 6"):
    return read(f'<svg xmlns="http://www.w3.org/2000/svg" width="8mm" height="6mm" viewBox="{box}">{shapes}</svg>')


@pytest.mark.parametrize("box", ["0 0 80 60", "1 0 8 6"])
def test_page_with_another_view_box_than_its_size_is_refused(box: str):
    with pytest.raises(BrokenMethod, match="view box"):
        page("", box)


def test_closed_line_ends_where_it_begins():
    [mark] = page('<path data-mark="outline" stroke="#000" stroke-width="1" d="M1 1L5 1L5 4Z"/>').marks
    assert np.asarray(mark.shape.vertices).tolist() == [[1, 1], [5, 1], [5, 4], [1, 1]]
    assert (np.asarray(mark.shape.codes).tolist(), mark.stroke_mm) == ([1, 2, 2, 79], 1)


def test_title_of_a_page_is_read_and_may_be_missing():
    assert [page(shapes).title for shapes in ("<title>Map</title>", "")] == ["Map", ""]


def test_pixel_is_black_that_ink_covers_by_half():
    ink = black(page('<path data-mark="fill" d="M1 2L2.03 2L2.03 2.97L1 2.97Z"/>'), 10)
    assert ink.shape == (60, 80)
    assert np.flatnonzero(ink.any(axis=0)).tolist() == list(range(10, 20))
    assert np.flatnonzero(ink.any(axis=1)).tolist() == list(range(20, 30))


def figure() -> Figure:
    """Return a page whose PDF is larger than the buffer of a file."""
    drawn = Figure()
    drawn.text(0, 0, "".join(map(chr, range(0x100, 0x180))))  # a font
    return drawn


def test_pdf_on_a_full_disk_reports_that() -> None:
    with pytest.raises(OSError, match="No space left"):
        save_pdf(Path("/dev/full"), "a page", [figure()])
    with pytest.raises(OSError, match="No space left"), Path("/dev/full").open("wb", buffering=0) as file:
        WRITERS[".pdf"](figure(), file, "a sheet", "what it shows")

"""PDF files on a disk that is full."""

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from tangible_export.paper.marks.rendering import save_pdf
from tangible_report.drawing.files import WRITERS


def figure() -> Figure:
    """Return a page whose PDF is larger than the buffer of a file."""
    drawn = Figure()
    drawn.text(0, 0, "".join(map(chr, range(0x100, 0x180))))  # a font
    return drawn


def test_pdf_of_pages_reports_a_full_disk_as_that() -> None:
    with pytest.raises(OSError, match="No space left"):
        save_pdf(Path("/dev/full"), "a page", [figure()])


def test_pdf_of_a_sheet_reports_a_full_disk_as_that() -> None:
    with pytest.raises(OSError, match="No space left"), Path("/dev/full").open("wb", buffering=0) as file:
        WRITERS[".pdf"](figure(), file, "a sheet", "what it shows")

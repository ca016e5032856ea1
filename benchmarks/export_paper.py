"""Swell paper: how long a page takes, and how near its marks are to each other."""

import logging
import tempfile
from pathlib import Path
from statistics import median
from time import process_time
from xml.etree import ElementTree

import numpy as np
from scipy import ndimage

from tangible_export import Swell

from .figures import Figure, judged, part, table
from .tests_path import exported_pictures

RUNS, MAX_S = 5, 2.2
GAP_MM, PER_MM = 3.2, 10


def section() -> str:
    """Return the section as Markdown."""
    logging.getLogger("tangible_export").addHandler(logging.NullHandler())  # what it says of each page
    pages, figures = part("pages", _pages)
    head = (
        "Parts drawn by hand, simplified for the file. Seconds of one processor from the simplified parts to the files "
        f"of a page and its key on A4, copies in ink among them, median of {RUNS}. Nearest: between any two marks to "
        "feel but the dots of one text, on the page as librsvg draws it at 254 dpi."
    )
    return "\n".join([head, "", *pages, "", *judged(figures)])


def _pages() -> tuple[list[str], list[Figure]]:
    rows, figures = list[tuple[str, ...]](), list[Figure]()
    for name in exported_pictures.PICTURES:
        work, swell = exported_pictures.work_of(name, Swell()), Swell()
        with tempfile.TemporaryDirectory() as folder:
            seconds, files = list[float](), tuple[Path, ...]()
            for _ in range(RUNS):
                start = process_time()
                files = swell.write(work, Path(folder) / name)
                seconds.append(process_time() - start)
            raised = [path for path in files if not path.stem.endswith("-ink")]
            pages = [path for path in raised if path.suffix == ".svg"]
            nearest = min(map(nearest_mm, pages))
            sizes = [f"{sum(path.stat().st_size for path in raised if path.suffix == end) / 1024:.0f}"
                     for end in (".svg", ".pdf")]  # fmt: skip
        count = len(np.unique(work.simplified.labels)) if work.simplified else 0
        took = median(seconds)
        rows.append((name, f"{count}", f"{len(pages)}", f"{took:.2f}", f"{nearest:.2f}", *sizes))
        figures += [
            Figure(f"{name}: page and key, s", f"<= {MAX_S:g}", f"{took:.2f}", took <= MAX_S),
            Figure(f"{name}: nearest marks, mm", f">= {GAP_MM}", f"{nearest:.2f}", nearest >= GAP_MM - 1e-9),
        ]
    return table(("page", "parts", "pages", "s", "nearest mm", "SVG KiB", "PDF KiB"), rows), figures


def nearest_mm(svg: Path) -> float:
    """Return the least gap between two blots of ink, but for the dots of one text and within the net of outlines."""
    root = ElementTree.parse(svg).getroot()
    ink = exported_pictures.pixels(svg, 25.4 * PER_MM) < 128
    blots, count = ndimage.label(ink, np.ones((3, 3)))
    text = np.zeros(count + 1, np.int64)
    for number, group in enumerate(root.iterfind(".//*[@data-mark='braille']"), 1):
        for dot in group:
            text[blots[int(PER_MM * float(dot.get("cy", 0))), int(PER_MM * float(dot.get("cx", 0)))]] = number
    reach, least = int(2 * GAP_MM * PER_MM), np.inf
    net = int(np.argmax(np.bincount(blots.ravel())[1:])) + 1
    for number, box in enumerate(ndimage.find_objects(blots), 1):
        if number == net:
            continue  # each of the others is measured to it
        window = tuple(slice(max(0, each.start - reach), each.stop + reach) for each in box)
        here = blots[window]
        others = (here > 0) & (here != number) & ((text[here] != text[number]) | (text[number] == 0))
        if others.any():
            least = min(least, (float(ndimage.distance_transform_edt(~others)[here == number].min()) - 1) / PER_MM)
    return least

"""Swell paper and pins: how long a page takes, how near its marks are to each other, and which borders pins keep."""

import json
import logging
import tempfile
from pathlib import Path
from statistics import median
from time import process_time
from xml.etree import ElementTree

import cv2
import numpy as np
from scipy import ndimage

from tangible_export import Pins, Swell

from .figures import Figure, MissedError, judged, part, table
from .tests_path import exported_pictures

RUNS, MOST_S = 5, 2.2
GAP_MM, PER_MM = 3.2, 10
LEAST_KEPT = 0.99
DISPLAYS = {"monarch": 1, "graphiti": 4, "dotpad": 1}


def section() -> str:
    """Return the section as Markdown. Raises: MissedError, with it, if a bound is missed."""
    logging.getLogger("tangible_export").addHandler(logging.NullHandler())  # what it says of each page
    pages, figures = part("pages", _pages)
    pins, kept = part("pins", _pins)
    figures += kept
    head = (
        "Parts drawn by hand, simplified for the file. Seconds of one processor from the simplified parts to the files "
        f"of a page and its key on A4, copies in ink among them, median of {RUNS}. Nearest: between any two marks to "
        "feel but the dots of one text, on the page as librsvg draws it at 254 dpi."
    )
    text = "\n".join([head, "", *pages, "", *pins, "", *judged(figures)])
    if not all(each.met for each in figures):
        raise MissedError(text)
    return text


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
            Figure(f"{name}: page and key, s", f"<= {MOST_S:g}", f"{took:.2f}", took <= MOST_S),
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


def _pins() -> tuple[list[str], list[Figure]]:
    rows, figures = list[tuple[str, ...]](), list[Figure]()
    for name in exported_pictures.PICTURES:
        for display, top in DISPLAYS.items():
            pins = Pins.model_validate({"display": display})
            work = exported_pictures.work_of(name, pins)
            with tempfile.TemporaryDirectory() as folder:
                start = process_time()
                files = pins.write(work, Path(folder) / name)
                took = process_time() - start
                heights = np.array(json.loads(files[1].read_text())["heights"])
            assert work.simplified is not None
            kept, false = _shares(heights == top, _borders(work.simplified.labels, *heights.shape))
            rows.append((name, display, f"{kept:.3f}", f"{false:.3f}", f"{(heights == top).mean():.2f}", f"{took:.3f}"))
            met = kept >= LEAST_KEPT and false == 0
            what = f"{name} on {display}: borders kept within a pin, and false ones"
            figures.append(Figure(what, f">= {LEAST_KEPT}, 0", f"{kept:.3f}, {false:.3f}", met))
    return table(("pins", "display", "kept", "false", "share of pins that are borders", "s"), rows), figures


def _borders(labels: np.ndarray, rows: int, columns: int) -> np.ndarray:
    """Return the pins on which a side between two pixels of two parts lies."""
    height, width = labels.shape
    scale = min(columns / width, rows / height)
    wide, long = max(1, round(width * scale)), max(1, round(height * scale))
    left, top = (columns - wide) // 2, (rows - long) // 2
    found = np.zeros((rows, columns), bool)
    for axis, (down, right) in enumerate(((0, 1), (1, 0))):
        row, column = np.nonzero(np.diff(labels, axis=1 - axis))
        at = (2 * row + 1 + down) * long // (2 * height), (2 * column + 1 + right) * wide // (2 * width)
        found[top + np.minimum(long - 1, at[0]), left + np.minimum(wide - 1, at[1])] = True
    return found


def _shares(up: np.ndarray, want: np.ndarray) -> tuple[float, float]:
    near_up, near_want = (cv2.dilate(each.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0 for each in (up, want))
    return float((want & near_up).sum() / want.sum()), float((up & ~near_want).sum() / up.sum())

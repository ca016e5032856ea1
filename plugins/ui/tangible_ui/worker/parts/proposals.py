"""Proposal of a part from a stroke: what resembles the stroke's surroundings, up to the picture's edges."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, UInt8

from tangible_core.data import SegmentTree
from tangible_core.errors import ConfigError
from tangible_core.runtime import cv2

Kind = Literal["regions", "grabcut", "watershed"]
MAX_POINTS = 2000
# Maximum number of cells of the reduced window: GrabCut takes a tenth of a second for these.
MAX_CELLS = 16_000
AROUND = 0.4  # reach of the window beyond the stroke, as a share of the stroke's length
NEAR = 2.0
"""Distance from the stroke within which a pixel is first taken for the part's, in widths of the stroke."""
ROUNDS = 3
# Side of the blocks that are refined at the picture's own size, in cells; only those that the border crosses.
BLOCK = 12
SMALL_HOLE = 0.01  # greatest hole that is filled, as a share of the part's area
# Least pixels of a stroke in a region that counts, as a share of those in the region that holds the most.
MIN_UNDER = 0.3
RIM = 2
OUTSIDE, PART = 2, 1


class Window(NamedTuple):
    """A window of the picture: first column and row, numbers of columns and rows."""

    x: int
    y: int
    columns: int
    rows: int

    def of(self, picture: np.ndarray) -> np.ndarray:
        """Return the picture's pixels in the window."""
        return picture[self.y : self.y + self.rows, self.x : self.x + self.columns]


def propose(
    picture: UInt8[np.ndarray, "h w 3"],
    points: Float64[np.ndarray, "n 2"],
    width_px: float,
    kind: Kind,
    within: Sequence[float] | None = None,
) -> tuple[Window, Bool[np.ndarray, "r c"]]:
    """Return a part by GrabCut (Rother et al. 2004) or a watershed (Meyer 1992), as its bounding box and mask there."""
    width_px = float(np.clip(width_px, 1, max(picture.shape)))
    window = _window(picture.shape, points, width_px, within)
    whole = window.of(picture)
    factor = min(1.0, (MAX_CELLS / (window.rows * window.columns)) ** 0.5)
    size = max(1, round(window.columns * factor)), max(1, round(window.rows * factor))
    small = np.ascontiguousarray(cv2.resize(whole, size, interpolation=cv2.INTER_AREA) if factor < 1 else whole)
    stroke = _draw_stroke(points, width_px, window, size)
    mask = _keep_connected(
        _segment(small, stroke, _rim(window, stroke, picture.shape), width_px * factor, kind), stroke
    )
    if factor < 1:
        mask = _refine_border(whole, mask)
    mask |= _draw_stroke(points, width_px, window, (window.columns, window.rows))
    return _crop_to_box(mask, window)


def propose_region(
    tree: SegmentTree,
    points: Float64[np.ndarray, "n 2"],
    width_px: float,
    level: float,
    within: Sequence[float] | None = None,
) -> tuple[Window, Bool[np.ndarray, "r c"]]:
    """Return the regions under the stroke, as `propose`; a lower level of borders gives smaller ones."""
    labels = tree.cut(len(tree.joins) + 1, level).labels
    whole = Window(0, 0, labels.shape[1], labels.shape[0])
    stroke = _draw_stroke(points, float(np.clip(width_px, 1, max(labels.shape))), whole, labels.shape[::-1])
    under = np.bincount(labels[stroke], minlength=int(labels.max()) + 1)
    mask = (under >= max(1.0, MIN_UNDER * under.max()))[labels]
    if within is not None:
        x0, y0, x1, y1 = np.clip(within, 0, [*labels.shape[::-1], *labels.shape[::-1]]).astype(int).tolist()
        inside = np.zeros(labels.shape, np.bool_)
        inside[y0:y1, x0:x1] = True
        mask &= inside
    return _crop_to_box(_keep_connected(mask, stroke) | stroke, whole)


def as_points(points: Sequence[Sequence[float]], shape: tuple[int, ...]) -> Float64[np.ndarray, "n 2"]:
    """Return points in the picture, columns and rows, at most MAX_POINTS. Raises: ConfigError for anything else."""
    array = np.array([list(point) for point in points if len(point) == 2], np.float64).reshape(-1, 2)
    if not 0 < len(array) == len(points) or not np.isfinite(array).all():
        raise ConfigError("points: are [[column, row], ...] in pixels of the picture, at least one")
    if len(array) > MAX_POINTS:
        array = array[np.linspace(0, len(array) - 1, MAX_POINTS).round().astype(int)]
    return np.clip(array, 0, [shape[1] - 1, shape[0] - 1])


def runs(mask: Bool[np.ndarray, "r c"]) -> list[int]:
    """Return run lengths of pixels outside, then inside, then outside again, row by row.

    >>> runs(np.array([[False, True], [True, False]]))
    [1, 2, 1]
    """
    flat = mask.ravel()
    ends = np.flatnonzero(flat[1:] != flat[:-1]) + 1
    lengths = np.diff(ends, prepend=0, append=flat.size).tolist()
    return [0, *lengths] if flat[0] else lengths


def _window(shape: tuple[int, ...], points: np.ndarray, width_px: float, within: Sequence[float] | None) -> Window:
    low, high = points.min(0) - width_px / 2, points.max(0) + width_px / 2
    reach = AROUND * float(max(high - low)) + 2 * width_px
    bounds = np.array([0, 0, shape[1], shape[0]], np.float64)
    if within is not None and len(within) == 4 and np.isfinite(within).all():
        inner = np.clip(within, [0, 0, 0, 0], bounds[[2, 3, 2, 3]])
        over = inner[:2].max() >= 0 and bool((points >= inner[:2]).all() and (points < inner[2:]).all())
        bounds = inner if over else bounds  # a stroke that leaves the box is not bounded by it
    x0, y0 = np.maximum(np.floor(low - reach), bounds[:2]).astype(int).tolist()
    x1, y1 = np.minimum(np.ceil(high + reach), bounds[2:]).astype(int).tolist()
    return Window(x0, y0, max(1, x1 - x0), max(1, y1 - y0))


def _draw_stroke(points: np.ndarray, width_px: float, window: Window, size: tuple[int, int]) -> Bool[np.ndarray, "r c"]:
    """Draw the stroke on a grid of this size over the window."""
    scale = np.array(size) / [window.columns, window.rows]
    places = np.floor((points - [window.x, window.y] + 0.5) * scale).astype(np.int32)
    canvas = np.zeros(size[::-1], np.uint8)
    cv2.polylines(canvas, [np.concatenate([places, places[-1:]])], False, 1, max(1, round(width_px * float(scale[0]))))
    return canvas.astype(np.bool_)


def _rim(window: Window, stroke: np.ndarray, shape: tuple[int, ...]) -> Bool[np.ndarray, "r c"]:
    """Return the rim of the window where the picture goes on: it is outside the part."""
    rim = np.zeros(stroke.shape, np.bool_)
    rim[:RIM] |= window.y > 0
    rim[:, :RIM] |= window.x > 0
    rim[-RIM:] |= window.y + window.rows < shape[0]
    rim[:, -RIM:] |= window.x + window.columns < shape[1]
    return rim & ~stroke


def _segment(small: np.ndarray, stroke: np.ndarray, rim: np.ndarray, width: float, kind: Kind) -> np.ndarray:
    if stroke.all():
        return stroke
    if kind == "watershed":
        return _watershed(cv2.bilateralFilter(small, 7, 30, 5), stroke, rim) if rim.any() else ~rim
    state = np.full(stroke.shape, cv2.GC_PR_BGD, np.uint8)
    far = cv2.distanceTransform((~stroke).astype(np.uint8), cv2.DIST_L2, 3)
    state[far <= max(NEAR * width, 1)] = cv2.GC_PR_FGD
    state[rim], state[stroke] = cv2.GC_BGD, cv2.GC_FGD
    if (state == cv2.GC_PR_FGD).sum() + stroke.sum() == state.size:
        return state != cv2.GC_BGD  # all pixels are near: nothing tells what is outside
    cv2.setRNGSeed(0)
    lab = cv2.cvtColor(small, cv2.COLOR_RGB2Lab)
    cv2.grabCut(lab, state, (0, 0, 0, 0), np.zeros((1, 65)), np.zeros((1, 65)), ROUNDS, cv2.GC_INIT_WITH_MASK)
    return (state == cv2.GC_FGD) | (state == cv2.GC_PR_FGD)


def _watershed(picture: np.ndarray, inside: np.ndarray, outside: np.ndarray) -> Bool[np.ndarray, "r c"]:
    """Return what is nearer to the inside than to the outside, the picture's edges being steep."""
    markers = np.zeros(inside.shape, np.int32)
    markers[outside], markers[inside] = OUTSIDE, PART
    wider = (cv2.copyMakeBorder(array, 1, 1, 1, 1, cv2.BORDER_REPLICATE) for array in (picture, markers))
    return np.asarray(cv2.watershed(*wider))[1:-1, 1:-1] == PART  # OpenCV takes the outermost pixels for a border


def _keep_connected(mask: Bool[np.ndarray, "r c"], stroke: Bool[np.ndarray, "r c"]) -> Bool[np.ndarray, "r c"]:
    """Keep what is connected to the stroke, without specks at its border and small holes."""
    smooth = np.asarray(cv2.medianBlur(mask.astype(np.uint8), 3)).astype(np.bool_) | stroke
    _, pieces = cv2.connectedComponents(smooth.astype(np.uint8), connectivity=4)
    part = np.isin(pieces, np.unique(pieces[stroke]))
    _, holes, stats, _ = cv2.connectedComponentsWithStats((~part).astype(np.uint8), connectivity=4)
    small = stats[:, cv2.CC_STAT_AREA] < SMALL_HOLE * part.sum()
    return part | small[holes]


def _refine_border(whole: np.ndarray, mask: Bool[np.ndarray, "r c"]) -> Bool[np.ndarray, "h w"]:
    """Return the mask at the picture's own size: a watershed along its border, between sure inside and sure outside."""
    rows, columns = whole.shape[:2]
    cells = mask.astype(np.uint8)
    sure, ring = cv2.erode(cells, np.ones((3, 3), np.uint8)), cv2.dilate(cells, np.ones((3, 3), np.uint8))
    state = np.where(sure == 1, PART, np.where(ring == 0, OUTSIDE, 0)).astype(np.uint8)
    fine = np.asarray(cv2.resize(cells, (columns, rows), interpolation=cv2.INTER_NEAREST)).astype(np.bool_)
    row_ends, column_ends = (
        np.round(np.arange(n + 1) * (full / n)).astype(int) for n, full in zip(mask.shape, (rows, columns), strict=True)
    )
    for top in range(0, mask.shape[0], BLOCK):
        for left in range(0, mask.shape[1], BLOCK):
            if (state[top : top + BLOCK, left : left + BLOCK] == 0).any():
                _refine_block(whole, state, fine, (row_ends, column_ends), (top, left))
    return fine


def _refine_block(
    whole: np.ndarray, state: np.ndarray, fine: np.ndarray, ends: tuple[np.ndarray, np.ndarray], block: tuple[int, int]
) -> None:
    """Refine one block, with a rim of cells around it so that blocks fit together."""
    inner = [(at, min(at + BLOCK, n)) for at, n in zip(block, state.shape, strict=True)]
    outer = [(max(0, low - 2), min(n, high + 2)) for (low, high), n in zip(inner, state.shape, strict=True)]
    (y0, y1), (x0, x1) = ((int(e[low]), int(e[high])) for e, (low, high) in zip(ends, outer, strict=True))
    (v0, v1), (u0, u1) = ((int(e[low]), int(e[high])) for e, (low, high) in zip(ends, inner, strict=True))
    near = state[outer[0][0] : outer[0][1], outer[1][0] : outer[1][1]]
    markers = np.asarray(cv2.resize(near, (x1 - x0, y1 - y0), interpolation=cv2.INTER_NEAREST))
    if (markers == PART).any() and (markers == OUTSIDE).any():
        part = _watershed(cv2.GaussianBlur(whole[y0:y1, x0:x1], (0, 0), 1.0), markers == PART, markers == OUTSIDE)
        fine[v0:v1, u0:u1] = part[v0 - y0 : v1 - y0, u0 - x0 : u1 - x0]


def _crop_to_box(mask: Bool[np.ndarray, "r c"], window: Window) -> tuple[Window, Bool[np.ndarray, "R C"]]:
    (y0, y1), (x0, x1) = (np.flatnonzero(mask.any(axis))[[0, -1]].tolist() for axis in (1, 0))
    return Window(window.x + x0, window.y + y0, x1 + 1 - x0, y1 + 1 - y0), mask[y0 : y1 + 1, x0 : x1 + 1]

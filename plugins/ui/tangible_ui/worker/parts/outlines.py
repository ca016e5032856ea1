"""Outlines that follow the picture's edges."""

import numpy as np
from jaxtyping import Float32, Float64, Int, UInt8

from tangible_core.runtime import cv2

MAX_PLACES = 1500
MAX_STEPS = 24  # maximum number of steps to either side of it
MAX_REACH_PX = 400.0
FAR = 0.15  # cost of a shift by the whole reach; a place without any edge costs 1
BEND = 0.12  # cost of a shift that is one step farther than that of the place before
TURN = 2  # maximum number of steps by which neighbours may differ


def snap(
    picture: UInt8[np.ndarray, "h w 3"], outline: Float64[np.ndarray, "n 2"], reach_px: float
) -> Float64[np.ndarray, "m 2"]:
    """Return the closed outline of least cost within reach, by dynamic programming (Amini, Weymouth and Jain 1990)."""
    places = _resample(outline)
    if len(places) < 4 or not 0 < reach_px < np.inf:
        return outline
    steps = int(np.clip(round(reach_px), 1, MAX_STEPS))
    away = np.linspace(-1, 1, 2 * steps + 1) * min(reach_px, MAX_REACH_PX)
    normals = _normals(places)
    cost = 1 - _edges(picture, places, normals, away) + FAR * np.abs(np.linspace(-1, 1, away.size, dtype=np.float32))
    new_places = places + normals * away[_cheapest(cost)][:, None]
    return np.clip(new_places, 0, [picture.shape[1] - 1, picture.shape[0] - 1])


def _resample(outline: Float64[np.ndarray, "n 2"]) -> Float64[np.ndarray, "m 2"]:
    """Return places along the closed outline, a pixel or more apart."""
    ring = np.concatenate([outline, outline[:1]])
    lengths = np.hypot(*np.diff(ring, axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(lengths)])
    count = int(min(MAX_PLACES, along[-1]))
    targets = np.arange(count) * (along[-1] / max(1, count))
    return np.stack([np.interp(targets, along, ring[:, axis]) for axis in (0, 1)], axis=1)


def _normals(places: Float64[np.ndarray, "m 2"]) -> Float64[np.ndarray, "m 2"]:
    """Return normals of the outline, smoothed so that those of neighbours do not cross at every corner."""
    smooth = np.mean([np.roll(places, shift, 0) for shift in range(-2, 3)], axis=0)
    tangents = np.roll(smooth, -1, 0) - np.roll(smooth, 1, 0)
    lengths = np.maximum(np.hypot(*tangents.T), 1e-9)[:, None]
    return np.stack([-tangents[:, 1], tangents[:, 0]], axis=1) / lengths


def _edges(
    picture: np.ndarray, places: np.ndarray, normals: np.ndarray, away: np.ndarray
) -> Float32[np.ndarray, "m k"]:
    """Return the gradient across the outline, at each place and distance; 1 is the steepest here."""
    step = float(away[1] - away[0])
    wide = np.concatenate([[away[0] - step], away, [away[-1] + step]])
    grid = (places[:, None] + normals[:, None] * wide[None, :, None]).astype(np.float32)
    strip = cv2.remap(picture, grid, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)  # type: ignore[call-overload]
    lab = np.asarray(cv2.cvtColor(strip, cv2.COLOR_RGB2Lab)).astype(np.float32)
    lab = np.asarray(cv2.GaussianBlur(lab, (0, 0), sigmaX=0.8, sigmaY=1.5, borderType=cv2.BORDER_REPLICATE))
    steep = np.sqrt(((lab[:, 2:] - lab[:, :-2]) ** 2).sum(-1))
    most = float(np.percentile(steep.max(axis=1), 75))
    return np.minimum(steep / max(most, 4.0), 1).astype(np.float32)


def _cheapest(cost: Float32[np.ndarray, "m k"]) -> Int[np.ndarray, " m"]:
    """Return the column of each row with the least sum, neighbours at most TURN apart, round and round."""
    rows, columns = cost.shape
    turns = np.arange(-TURN, TURN + 1)
    price = (BEND * np.abs(turns)).astype(np.float32)[:, None]
    came = np.empty((2 * rows, columns), np.int8)
    total = np.zeros(columns, np.float32)
    with_margin = np.full(columns + 2 * TURN, np.inf, np.float32)
    windows = np.lib.stride_tricks.sliding_window_view(with_margin, columns)
    for row in range(2 * rows):
        with_margin[TURN : TURN + columns] = total
        sums = windows + price
        came[row] = best = np.argmin(sums, axis=0)
        total = sums[best, np.arange(columns)] + cost[row % rows]
    path = np.empty(2 * rows, np.int64)
    path[-1] = int(np.argmin(total))
    for row in range(2 * rows - 1, 0, -1):
        path[row - 1] = path[row] + turns[came[row, path[row]]]
    half = rows // 2  # both ends of the path lack a neighbour
    return np.roll(path[half : half + rows], half)

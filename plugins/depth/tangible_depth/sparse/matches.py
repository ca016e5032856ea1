"""Matches between two raw pictures: by SIFT, by Harris corners and correlation, by optical flow."""

from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Float64, Int64, UInt8

from tangible_core.runtime import plain_opencv

from .harris import corners, harris_response, least_response

MAX_PIXELS = 2_000_000
"""Largest picture for SIFT, in pixels; larger ones are reduced, as it needs about 300 bytes a pixel."""
FLOW_PIXELS = 60_000
# Smallest norm of a window minus its mean, white being 1: a smaller one is rounding error.
FLAT = 1e-4
# Steps per unit to which normalised windows are rounded before they are correlated all against all.
STEPS = 2.0**24
WINDOW_PX = 7
MAX_CORNERS = 1000
MIN_ALIKE = 0.7  # lowest correlation of windows at the same place that lie on the plane
MIN_SCORE = 0.85
SMALLEST_SIDE = 16


class Matches(NamedTuple):
    """Matching points of two pictures, (column, row) in pixels, best first if they are ranked."""

    left_px: Float64[np.ndarray, "n 2"]
    right_px: Float64[np.ndarray, "n 2"]

    def select(self, which: slice | np.ndarray) -> "Matches":
        """Return the matches of a mask, of indices or of a slice."""
        return Matches(self.left_px[which], self.right_px[which])


NO_MATCHES = Matches(np.empty((0, 2)), np.empty((0, 2)))


def stretch8(grey: Float32[np.ndarray, "h w"]) -> UInt8[np.ndarray, "h w"]:
    """Stretch a picture from its darkest to its lightest value to eight bits, so that a dim one keeps its detail."""
    low, high = float(grey.min()), float(grey.max())
    return np.rint((grey - low) * (255 / max(high - low, 1e-6))).astype(np.uint8)


def sift_matches(left: Float32[np.ndarray, "h w"], right: Float32[np.ndarray, "h w"], ratio: float = 0.8) -> Matches:
    """Match SIFT features that are mutual best and pass the ratio test (Lowe, IJCV 2004, sec. 7.1)."""
    if min(left.shape) < SMALLEST_SIDE:
        return NO_MATCHES
    scale = min(1.0, (MAX_PIXELS / left.size) ** 0.5)
    detector = cv2.SIFT.create(4000)
    full = stretch8(left), stretch8(right)
    with plain_opencv():
        (left_points, left_codes), (right_points, right_codes) = (
            detector.detectAndCompute(_reduce(grey, scale), None) for grey in full
        )
    if left_codes is None or right_codes is None or min(len(left_points), len(right_points)) < 2:
        return NO_MATCHES
    distance = _distances(left_codes, right_codes)
    pairs = _mutual_best(-distance)
    nearest, second = np.partition(distance, 1, axis=1)[:, :2].T
    pairs = pairs[nearest[pairs[:, 0]] < ratio * second[pairs[:, 0]]]
    at = [_to_full_size(np.array([point.pt for point in points]), scale) for points in (left_points, right_points)]
    matches = Matches(at[0][pairs[:, 0]], at[1][pairs[:, 1]])
    return matches if scale == 1 else _track_at_full_size(matches, full)


def _reduce(picture: UInt8[np.ndarray, "h w"], scale: float) -> UInt8[np.ndarray, "small_h small_w"]:
    return picture if scale == 1 else cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)


def _distances(left_codes: np.ndarray, right_codes: np.ndarray) -> Float32[np.ndarray, "n m"]:
    # Codes are whole numbers under 256, whose products and sums are exact in any order.
    squares = (left_codes**2).sum(axis=1)[:, None] + (right_codes**2).sum(axis=1) - 2 * left_codes @ right_codes.T
    return np.sqrt(np.maximum(squares, 0))


def _mutual_best(score: np.ndarray) -> Int64[np.ndarray, "n 2"]:
    best = score.argmax(axis=1)
    back = score.argmax(axis=0)
    mine = np.arange(len(best))
    is_mutual = back[best] == mine
    return np.column_stack([mine[is_mutual], best[is_mutual]])


def corner_matches(
    left: Float32[np.ndarray, "h w"],
    right: Float32[np.ndarray, "h w"],
    left_corners: Int64[np.ndarray, "n 2"],
    right_corners: Int64[np.ndarray, "m 2"],
    window_px: int = 11,
    least_score: float = 0.8,
) -> Matches:
    """Match mutual best corners by the correlation of their windows, the right ones to sub-pixel; n x m scores."""
    if not len(left_corners) or not len(right_corners):
        return NO_MATCHES
    half = window_px // 2
    patches = normalised_windows(left, left_corners, half)
    score = correlations(patches, normalised_windows(right, right_corners, half))
    pairs = _mutual_best(score)
    pairs = pairs[score[pairs[:, 0], pairs[:, 1]] >= least_score]
    if not len(pairs):
        return NO_MATCHES
    right_px = _refine_peaks(patches[pairs[:, 0]], right, right_corners[pairs[:, 1]], half)
    return Matches(left_corners[pairs[:, 0]].astype(np.float64), right_px)


def correlations(left: Float32[np.ndarray, "n k"], right: Float32[np.ndarray, "m k"]) -> Float64[np.ndarray, "n m"]:
    """Return the correlations of normalised windows, each left one with each right one."""
    # Whole numbers of 1 / STEPS, whose sums stay under 2^53: exact in any order.
    whole, others = (np.rint(STEPS * windows.astype(np.float64)) for windows in (left, right))
    return whole @ others.T * STEPS**-2


def inverse_lengths(grey: Float32[np.ndarray, "h w"], half: int) -> Float32[np.ndarray, "h w"]:
    """Return 1 / norm of each pixel's window minus its mean; 0 for a flat one. Edges are repeated outwards."""
    side = (2 * half + 1, 2 * half + 1)
    # A difference of two large sums: in float32 it is negative for a quarter of the windows.
    exact = grey.astype(np.float64)
    with plain_opencv():
        mean = cv2.boxFilter(exact, -1, side, borderType=cv2.BORDER_REPLICATE)
        square = cv2.sqrBoxFilter(exact, cv2.CV_64F, side, borderType=cv2.BORDER_REPLICATE)
    length = np.sqrt(np.maximum(square - mean**2, 0) * side[0] * side[1])
    return np.where(length > FLAT, 1 / np.maximum(length, FLAT), 0).astype(np.float32)


def normalised_windows(
    grey: Float32[np.ndarray, "h w"], points: Int64[np.ndarray, "n 2"], half: int
) -> Float32[np.ndarray, "n k"]:
    """Return the windows round some points, minus their mean, divided by their norm; zero for a flat window."""
    frame = np.pad(grey, half, mode="edge")
    side = 2 * half + 1
    windows = np.lib.stride_tricks.sliding_window_view(frame, (side, side))
    flat = windows[points[:, 1], points[:, 0]].reshape(len(points), side * side)
    deviations = flat - flat.mean(axis=1, keepdims=True)
    length = np.linalg.norm(deviations, axis=1, keepdims=True)
    return np.where(length > FLAT, deviations / np.maximum(length, FLAT), 0).astype(np.float32)


def _refine_peaks(
    patches: Float32[np.ndarray, "n k"], right: np.ndarray, points: Int64[np.ndarray, "n 2"], half: int, reach: int = 3
) -> Float64[np.ndarray, "n 2"]:
    """Refine each right point to the peak of the correlation near it, by a parabola along each axis."""
    steps = np.arange(-reach, reach + 1)
    rows, columns = right.shape
    offsets = np.array([(x, y) for y in steps for x in steps])
    near = np.clip(points[:, None] + offsets, 0, [columns - 1, rows - 1])
    score = np.stack(
        [np.einsum("nk,nk->n", patches, normalised_windows(right, near[:, i], half)) for i in range(len(offsets))],
        axis=1,
    ).reshape(-1, len(steps), len(steps))
    inner = score[:, 1:-1, 1:-1].reshape(len(points), -1).argmax(axis=1)
    y, x = np.unravel_index(inner, (len(steps) - 2, len(steps) - 2))
    n, y, x = np.arange(len(points)), y + 1, x + 1
    along_x = parabola(score[n, y, x - 1], score[n, y, x], score[n, y, x + 1])
    along_y = parabola(score[n, y - 1, x], score[n, y, x], score[n, y + 1, x])
    return points + np.column_stack([x - reach + along_x, y - reach + along_y])


def parabola(before: np.ndarray, at: np.ndarray, after: np.ndarray) -> Float64[np.ndarray, "n"]:
    """Return the peak of the parabola through three equidistant scores, -0.5..0.5 from the middle; 0 without a peak."""
    before, at, after = (np.asarray(part, np.float64) for part in (before, at, after))
    bend = 2 * at - before - after
    return np.where(bend > 0, np.clip(0.5 * (after - before) / np.where(bend > 0, bend, 1), -0.5, 0.5), 0.0)


@plain_opencv()
def flow_matches(left: Float32[np.ndarray, "h w"], right: Float32[np.ndarray, "h w"], most: int = 150) -> Matches:
    """Match strong corners by tracking them into the right picture and back (Lucas-Kanade), to a tenth of a pixel."""
    if min(left.shape) < SMALLEST_SIDE:
        return NO_MATCHES
    # Optical flow assumes constant brightness; equal histograms allow another exposure or gamma.
    full = cv2.equalizeHist(stretch8(left)), cv2.equalizeHist(stretch8(right))
    scale = min(1.0, (FLOW_PIXELS / left.size) ** 0.5)
    small = [_reduce(grey, scale) for grey in full]
    start = cv2.goodFeaturesToTrack(small[0], most, 0.01, 8)
    if start is None:
        return NO_MATCHES
    # Cheap, as corners are tracked in small pictures and only refined in the full ones; one that does not come back to
    # within half a small pixel is most likely a wrong match.
    there = track(small[0], small[1], start, start, levels=5)
    returns = np.linalg.norm(track(small[1], small[0], there, there, levels=5) - start, axis=2).ravel() < 0.5
    matches = Matches(*(_to_full_size(points[returns].reshape(-1, 2), scale) for points in (start, there)))
    return matches if scale == 1 else _track_at_full_size(matches, full)


def track(
    first: np.ndarray, second: np.ndarray, start: np.ndarray, guess: np.ndarray, levels: int, window_px: int = 15
) -> np.ndarray:
    """Track `start` into the second picture from `guess` (pyramidal Lucas-Kanade); NaN for a lost point."""
    flags = cv2.OPTFLOW_USE_INITIAL_FLOW
    there, status, _ = cv2.calcOpticalFlowPyrLK(
        first, second, start, guess.copy(), winSize=(window_px, window_px), maxLevel=levels, flags=flags
    )
    return np.where(status[..., None] > 0, there, np.float32(np.nan))


def _track_at_full_size(matches: Matches, pictures: tuple[np.ndarray, np.ndarray]) -> Matches:
    """Track matches of reduced pictures again in the full ones; matches lost there are dropped."""
    if not len(matches.left_px):
        return matches
    start, guess = (points.astype(np.float32)[:, None] for points in matches)
    there = track(*pictures, start, guess, levels=2)[:, 0]
    finite = np.isfinite(there).all(axis=1)
    return Matches(matches.left_px[finite], there[finite].astype(np.float64))


def _to_full_size(points_px: np.ndarray, scale: float) -> Float64[np.ndarray, "n 2"]:
    """Convert points of a reduced picture to the full one; centres are whole numbers, so (0, 0) moves too."""
    return (points_px.astype(np.float64) + 0.5) / scale - 0.5


def match_off_plane(
    left: Float32[np.ndarray, "h w"], right: Float32[np.ndarray, "h w"], homography: np.ndarray
) -> Matches:
    """Match corners that a homography, right to left, does not explain; right points are mapped by it."""
    size = left.shape[::-1]
    with plain_opencv():
        warped_right = cv2.warpPerspective(right, homography, size)
        inside = cv2.warpPerspective(np.ones_like(right), homography, size, flags=cv2.INTER_NEAREST) > 0
    off = inside & ~_correlating(left, warped_right)
    corner_points = [
        corners(np.where(off, harris_response(grey), 0), least_response(0.005), MAX_CORNERS)
        for grey in (left, warped_right)
    ]
    return corner_matches(left, warped_right, corner_points[0], corner_points[1], WINDOW_PX, MIN_SCORE)


def _correlating(one: Float32[np.ndarray, "h w"], other: Float32[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    side, half = (WINDOW_PX, WINDOW_PX), WINDOW_PX // 2
    with plain_opencv():
        mean, its, both = (
            cv2.boxFilter(grey, cv2.CV_64F, side, borderType=cv2.BORDER_REPLICATE) for grey in (one, other, one * other)
        )
    spread = (both - mean * its) * WINDOW_PX**2
    return spread * inverse_lengths(one, half) * inverse_lengths(other, half) >= MIN_ALIKE

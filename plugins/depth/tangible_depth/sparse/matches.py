"""Matches between two raw pictures: by SIFT, by Harris corners and correlation, by optical flow.

Points are (column, row) in pixels, centres at whole numbers.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64, Int64, UInt8

from tangible_core.runtime.opencv import plain_opencv

MOST_PIXELS = 2_000_000
"""SIFT looks at pictures reduced to this: it needs about 300 bytes a pixel."""
FLOW_PIXELS = 60_000
"""Optical flow finds its corners in pictures reduced to this."""
FLAT = 1e-4
"""Length of a window less its mean, white being 1, below which it holds nothing but rounding."""
STEPS = 2.0**24
"""To the unit, of normalised windows that are compared all against all."""
SMALLEST_SIDE = 16
"""Pictures narrower than this hold no window worth following."""


class Matches(NamedTuple):
    """Points seen in both pictures, best first where the maker can tell."""

    left_px: Float64[np.ndarray, "n 2"]
    right_px: Float64[np.ndarray, "n 2"]

    @property
    def row_offset_px(self) -> Float64[np.ndarray, "n"]:
        """How far each right point lies below its left one; all zero in a rectified pair."""
        return self.right_px[:, 1] - self.left_px[:, 1]


NO_MATCHES = Matches(np.empty((0, 2)), np.empty((0, 2)))


def stretch8(grey: Float32[np.ndarray, "h w"]) -> UInt8[np.ndarray, "h w"]:
    """Eight bits from the darkest to the lightest value, so that a dim picture keeps its detail."""
    low, high = float(grey.min()), float(grey.max())
    return np.rint((grey - low) * (255 / max(high - low, 1e-6))).astype(np.uint8)


def sift_matches(left: Float32[np.ndarray, "h w"], right: Float32[np.ndarray, "h w"], ratio: float = 0.8) -> Matches:
    """SIFT features that choose each other and beat their second choice by the ratio (Lowe, IJCV 2004, sec. 7.1)."""
    import cv2

    if min(left.shape) < SMALLEST_SIDE:
        return NO_MATCHES
    scale = min(1.0, (MOST_PIXELS / left.size) ** 0.5)
    detector = cv2.SIFT.create(4000)
    full = stretch8(left), stretch8(right)
    with plain_opencv():
        (left_points, left_codes), (right_points, right_codes) = (
            detector.detectAndCompute(_reduced(grey, scale), None) for grey in full
        )
    if left_codes is None or right_codes is None or min(len(left_points), len(right_points)) < 2:
        return NO_MATCHES
    distance = _distances(left_codes, right_codes)
    chosen = _mutual(-distance)
    nearest, second = np.partition(distance, 1, axis=1)[:, :2].T
    chosen = chosen[nearest[chosen[:, 0]] < ratio * second[chosen[:, 0]]]
    at = [_enlarged(np.array([point.pt for point in points]), scale) for points in (left_points, right_points)]
    found = Matches(at[0][chosen[:, 0]], at[1][chosen[:, 1]])
    return found if scale == 1 else _sharpened(found, full)


def _reduced(picture: UInt8[np.ndarray, "h w"], scale: float) -> UInt8[np.ndarray, "small_h small_w"]:
    import cv2

    return picture if scale == 1 else cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)


def _distances(left_codes: np.ndarray, right_codes: np.ndarray) -> Float32[np.ndarray, "n m"]:
    # Codes are whole numbers under 256, whose products and sums are exact in whatever order they are added.
    squares = (left_codes**2).sum(axis=1)[:, None] + (right_codes**2).sum(axis=1) - 2 * left_codes @ right_codes.T
    return np.sqrt(np.maximum(squares, 0))


def _mutual(score: np.ndarray) -> Int64[np.ndarray, "n 2"]:
    """Pairs (i, j) of which each is the other's best."""
    best = score.argmax(axis=1)
    back = score.argmax(axis=0)
    mine = np.arange(len(best))
    kept = back[best] == mine
    return np.column_stack([mine[kept], best[kept]])


def corner_matches(
    left: Float32[np.ndarray, "h w"],
    right: Float32[np.ndarray, "h w"],
    left_corners: Int64[np.ndarray, "n 2"],
    right_corners: Int64[np.ndarray, "m 2"],
    window_px: int = 11,
    least_score: float = 0.8,
) -> Matches:
    """Corners that choose each other by normalised cross-correlation of their windows, the right ones to sub-pixel.

    Windows over `least_score` only; a flat window correlates with nothing. Memory: n x m scores.
    """
    if not len(left_corners) or not len(right_corners):
        return NO_MATCHES
    half = window_px // 2
    patches = normalised_windows(left, left_corners, half)
    score = correlations(patches, normalised_windows(right, right_corners, half))
    chosen = _mutual(score)
    chosen = chosen[score[chosen[:, 0], chosen[:, 1]] >= least_score]
    if not len(chosen):
        return NO_MATCHES
    refined = _refined(patches[chosen[:, 0]], right, right_corners[chosen[:, 1]], half)
    return Matches(left_corners[chosen[:, 0]].astype(np.float64), refined)


def correlations(left: Float32[np.ndarray, "n k"], right: Float32[np.ndarray, "m k"]) -> Float64[np.ndarray, "n m"]:
    """Products of normalised windows.

    The windows are rounded to whole numbers of 1 / STEPS, whose sums stay under 2^53: exact in any order.
    """
    whole, others = (np.rint(STEPS * each.astype(np.float64)) for each in (left, right))
    return whole @ others.T * STEPS**-2


def inverse_lengths(grey: Float32[np.ndarray, "h w"], half: int) -> Float32[np.ndarray, "h w"]:
    """One over the length of each pixel's window less its mean; 0 where it is flat. Edges repeat outwards."""
    import cv2

    side = (2 * half + 1, 2 * half + 1)
    # The difference of two large sums: in float32 it comes out negative in a quarter of the windows.
    exact = grey.astype(np.float64)
    with plain_opencv():
        mean = cv2.boxFilter(exact, -1, side, borderType=cv2.BORDER_REPLICATE)
        square = cv2.sqrBoxFilter(exact, cv2.CV_64F, side, borderType=cv2.BORDER_REPLICATE)
    length = np.sqrt(np.maximum(square - mean**2, 0) * side[0] * side[1])
    return np.where(length > FLAT, 1 / np.maximum(length, FLAT), 0).astype(np.float32)


def normalised_windows(
    grey: Float32[np.ndarray, "h w"], points: Int64[np.ndarray, "n 2"], half: int
) -> Float32[np.ndarray, "n k"]:
    """The windows round some points less their mean and over their length; zero where a window is flat."""
    padded = np.pad(grey, half, mode="edge")
    side = 2 * half + 1
    windows = np.lib.stride_tricks.sliding_window_view(padded, (side, side))
    flat = windows[points[:, 1], points[:, 0]].reshape(len(points), side * side)
    centred = flat - flat.mean(axis=1, keepdims=True)
    length = np.linalg.norm(centred, axis=1, keepdims=True)
    return np.where(length > FLAT, centred / np.maximum(length, FLAT), 0).astype(np.float32)


def _refined(
    patches: Float32[np.ndarray, "n k"], right: np.ndarray, points: Int64[np.ndarray, "n 2"], half: int, reach: int = 3
) -> Float64[np.ndarray, "n 2"]:
    """The correlation's peak near each right point, by a parabola along each axis."""
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
    """Where the parabola through three equidistant scores peaks, -0.5..0.5 from the middle one; 0 if it has no peak."""
    before, at, after = (np.asarray(part, np.float64) for part in (before, at, after))
    bend = 2 * at - before - after
    return np.where(bend > 0, np.clip(0.5 * (after - before) / np.where(bend > 0, bend, 1), -0.5, 0.5), 0.0)


@plain_opencv()
def flow_matches(left: Float32[np.ndarray, "h w"], right: Float32[np.ndarray, "h w"], most: int = 150) -> Matches:
    """Strong corners followed into the right picture and back (pyramidal Lucas-Kanade): to a tenth of a pixel.

    Cheap, because they are found and followed in small pictures and only placed in the full ones. What does not come
    back to within half a small pixel is left out, which removes most wrong ones.
    """
    import cv2

    if min(left.shape) < SMALLEST_SIDE:
        return NO_MATCHES
    # Flow takes brightness for constant; equal histograms forgive another exposure or gamma.
    full = cv2.equalizeHist(stretch8(left)), cv2.equalizeHist(stretch8(right))
    scale = min(1.0, (FLOW_PIXELS / left.size) ** 0.5)
    small = [_reduced(grey, scale) for grey in full]
    start = cv2.goodFeaturesToTrack(small[0], most, 0.01, 8)
    if start is None:
        return NO_MATCHES
    there = _follow(small[0], small[1], start, start, levels=5)
    kept = np.linalg.norm(_follow(small[1], small[0], there, there, levels=5) - start, axis=2).ravel() < 0.5
    found = Matches(*(_enlarged(points[kept].reshape(-1, 2), scale) for points in (start, there)))
    return found if scale == 1 else _sharpened(found, full)


def _follow(first: np.ndarray, second: np.ndarray, start: np.ndarray, guess: np.ndarray, levels: int) -> np.ndarray:
    """Lucas-Kanade from `start` in the first picture to near `guess` in the second; NaN where it loses the point."""
    import cv2

    flags = cv2.OPTFLOW_USE_INITIAL_FLOW
    there, seen, _ = cv2.calcOpticalFlowPyrLK(
        first, second, start, guess.copy(), winSize=(15, 15), maxLevel=levels, flags=flags
    )
    return np.where(seen[..., None] > 0, there, np.nan)


def _sharpened(matches: Matches, pictures: tuple[np.ndarray, np.ndarray]) -> Matches:
    """Matches found in reduced pictures, followed once more in the full ones; those lost there are left out."""
    if not len(matches.left_px):
        return matches
    start, guess = (points.astype(np.float32)[:, None] for points in matches)
    there = _follow(*pictures, start, guess, levels=2)[:, 0]
    kept = np.isfinite(there).all(axis=1)
    return Matches(matches.left_px[kept], there[kept].astype(np.float64))


def _enlarged(points_px: np.ndarray, scale: float) -> Float64[np.ndarray, "n 2"]:
    """Points of a reduced picture in the full one; centres are whole numbers, so (0, 0) does not stay where it is."""
    return (points_px.astype(np.float64) + 0.5) / scale - 0.5

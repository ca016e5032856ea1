"""The row-alignment test by corners: do a few corners, tracked into the right view, stay on their rows?"""

import numpy as np
from jaxtyping import Float, Float32, Float64, UInt8

from tangible_core.runtime.opencv import plain_opencv

from ..search.pairs import Pair

Points = Float32[np.ndarray, "n 1 2"]

LOOK_PX = 160
"""Longer side, in pixels, of the copies in which corners are detected and tracked."""
POINTS, APART_PX = 32, 6
"""Largest number of corners, and their smallest distance in pixels of the copy."""
PATCH_PX = 48
"""Side, in pixels, of the full-size patches in which corners are tracked again."""
FINE_ENOUGH = 1 / 3
"""Scale of the copies from which a tenth of their pixel is precise enough, without tracking at full size."""
FEWEST = 12
"""Fewest corners that decide; with fewer, the pair is taken as rectified."""
TOLERANCE_PX = 0.5
"""Largest median vertical offset of a pair whose rows correspond, in pixels; at least 1/4000 of the longer side."""


def corners_correspond(pair: Pair, most_row_offset_px: float = 0.0) -> bool:
    """Test whether half of the corners, tracked into the right view, stay within TOLERANCE_PX of their rows.

    most_row_offset_px: largest common offset, up or down, that is accepted.
    Returns: True with too few corners to decide; False if over half of them get lost, as when a camera was rotated far:
    the whole picture must decide then.
    """
    longer = max(pair.left.shape)
    scale = min(1.0, LOOK_PX / longer)
    if min(pair.left.shape) * scale < PATCH_PX / 2:
        return True
    row_offsets_px = _row_offsets(pair, scale)
    if row_offsets_px is None:
        return True
    if len(row_offsets_px) < FEWEST:
        return False
    corrected_px = float(np.clip(np.median(row_offsets_px), -most_row_offset_px, most_row_offset_px))
    return float(np.median(np.abs(row_offsets_px - corrected_px))) <= max(TOLERANCE_PX, longer / 4000)


@plain_opencv()
def _row_offsets(pair: Pair, scale: float) -> Float64[np.ndarray, "n"] | None:
    """Return the row offsets of tracked corners, in pixels; empty if over half got lost; None with too few corners."""
    import cv2

    small = [cv2.resize(each, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA) for each in pair]
    # Optical flow assumes constant brightness; equal histograms allow another exposure or gamma.
    small = [cv2.equalizeHist(each) for each in small]
    start = cv2.goodFeaturesToTrack(small[0], POINTS, 0.02, APART_PX)
    if start is None or len(start) < FEWEST:
        return None
    there = _track(small[0], small[1], start, start, 3)
    # A corner that is not tracked back to its start was lost or occluded.
    kept = np.linalg.norm(_track(small[1], small[0], there, start, 3) - start, axis=2)[:, 0] < 0.5
    if np.count_nonzero(kept) < len(start) / 2:
        return np.empty(0)
    start, there = ((each[kept] + 0.5) / scale - 0.5 for each in (start, there))
    row_offsets_px = (there - start if scale >= FINE_ENOUGH else _track_at_full_size(pair, start, there))[:, 0, 1]
    return row_offsets_px[np.isfinite(row_offsets_px)].astype(np.float64)


def _track(
    left: UInt8[np.ndarray, "h w"], right: UInt8[np.ndarray, "h w"], start: Points, guess: Points, levels: int
) -> Points:
    """Track points into the right picture, from a guess (pyramidal Lucas-Kanade); NaN for lost ones."""
    import cv2

    found, seen, _ = cv2.calcOpticalFlowPyrLK(
        left, right, start, guess.copy(), winSize=(11, 11), maxLevel=levels, flags=cv2.OPTFLOW_USE_INITIAL_FLOW
    )
    return np.where(seen[..., None] > 0, found, np.float32(np.nan))


def _track_at_full_size(pair: Pair, start: Points, guess: Points) -> Float[np.ndarray, "inside 1 2"]:
    """Return shifts (x, y) of points tracked again at full size, in a column of patches instead of large pyramids."""
    import cv2

    at = [np.rint(each[:, 0]).astype(int) - PATCH_PX // 2 for each in (start, guess)]
    most = np.array(pair.left.shape[::-1]) - PATCH_PX
    inside = np.all([((each >= 0) & (each <= most)).all(axis=1) for each in at], axis=0)
    if not inside.any():
        return start[:0]
    at = [each[inside] for each in at]
    patches = [
        cv2.equalizeHist(np.vstack([view[y : y + PATCH_PX, x : x + PATCH_PX] for x, y in corners]))
        for view, corners in zip(pair, at, strict=True)
    ]
    down = PATCH_PX * np.arange(len(at[0]))[:, None] * [0, 1]
    local = (start[inside][:, 0] - at[0] + down).astype(np.float32)[:, None]
    return _track(patches[0], patches[1], local, local, 2) - local + (at[1] - at[0])[:, None]

"""A look at a few corners of a pair, followed into the right view: whether they lie on their rows."""

import numpy as np
from jaxtyping import Float, Float32, Float64, UInt8

from tangible_core.runtime.opencv import plain_opencv

from ..search.pairs import Pair

Points = Float32[np.ndarray, "n 1 2"]

LOOK_PX = 160
"""Longer side of the copies in which corners are found and followed."""
POINTS, APART_PX = 32, 6
"""How many corners, and how far apart in the copy."""
PATCH_PX = 48
"""Side of the patches of the full pictures in which they are followed once more."""
FINE_ENOUGH = 1 / 3
"""Size of the copies, in sizes of the picture, from which a tenth of their pixel is fine enough."""
FEWEST = 12
"""Corners below which nothing is said about a pair: it is taken as it is."""
TOLERANCE_PX = 0.5
"""Median vertical offset up to which rows correspond; in large pictures 1/4000 of the longer side."""


def corners_correspond(pair: Pair, most_row_offset_px: float = 0.0) -> bool:
    """Whether a few corners, followed into the right view, lie on their rows: half of them within TOLERANCE_PX.

    most_row_offset_px: how far they may all lie off together, up or down.
    True where there are too few corners to tell. False where there are some and over half of them get lost, as when a
    camera was turned far: a longer look is due then.
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
    put_right_px = float(np.clip(np.median(row_offsets_px), -most_row_offset_px, most_row_offset_px))
    return float(np.median(np.abs(row_offsets_px - put_right_px))) <= max(TOLERANCE_PX, longer / 4000)


@plain_opencv()
def _row_offsets(pair: Pair, scale: float) -> Float64[np.ndarray, "n"] | None:
    """In pixels, of the corners that could be followed, none if over half got lost; None where there are no corners."""
    import cv2

    small = [cv2.resize(each, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA) for each in pair]
    # Flow takes brightness for constant; equal histograms forgive another exposure or gamma.
    small = [cv2.equalizeHist(each) for each in small]
    start = cv2.goodFeaturesToTrack(small[0], POINTS, 0.02, APART_PX)
    if start is None or len(start) < FEWEST:
        return None
    there = _followed(small[0], small[1], start, start, 3)
    # What does not come back was lost, on the way or behind something.
    kept = np.linalg.norm(_followed(small[1], small[0], there, start, 3) - start, axis=2)[:, 0] < 0.5
    if np.count_nonzero(kept) < len(start) / 2:
        return np.empty(0)
    start, there = ((each[kept] + 0.5) / scale - 0.5 for each in (start, there))
    row_offsets_px = (there - start if scale >= FINE_ENOUGH else _sharpened(pair, start, there))[:, 0, 1]
    return row_offsets_px[np.isfinite(row_offsets_px)].astype(np.float64)


def _followed(
    left: UInt8[np.ndarray, "h w"], right: UInt8[np.ndarray, "h w"], start: Points, guess: Points, levels: int
) -> Points:
    """Where points are in the right picture, near a guess (pyramidal Lucas-Kanade); NaN where they get lost."""
    import cv2

    found, seen, _ = cv2.calcOpticalFlowPyrLK(
        left, right, start, guess.copy(), winSize=(11, 11), maxLevel=levels, flags=cv2.OPTFLOW_USE_INITIAL_FLOW
    )
    return np.where(seen[..., None] > 0, found, np.float32(np.nan))


def _sharpened(pair: Pair, start: Points, guess: Points) -> Float[np.ndarray, "inside 1 2"]:
    """Shifts (x, y) of points followed once more at full size: in patches set side by side, not in large pyramids."""
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
    return _followed(patches[0], patches[1], local, local, 2) - local + (at[1] - at[0])[:, None]

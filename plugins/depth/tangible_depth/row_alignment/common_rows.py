"""The decision whether the rows of a pair correspond: the entry to this room."""

import logging

import cv2
import numpy as np
from jaxtyping import Bool, Float, Float32, Float64, UInt8

from tangible_core.plugins import note
from tangible_core.runtime import plain_opencv

from ..dense.span import UNKNOWN
from ..search.bands import Bands
from ..search.pairs import Pair
from ..sparse.matches import track
from .row_offset import CELL_PX, MIN_ROW_OFFSET_PX, MIN_VOTES, row_votes

Points = Float32[np.ndarray, "n 1 2"]

LOOK_PX = 160  # longer side, in pixels, of the copies in which corners are detected and tracked
POINTS, APART_PX = 32, 6  # largest number of corners, and their smallest distance in pixels of the copy
WINDOW_PX = 11
PATCH_PX = 48
# Scale of the copies from which a tenth of their pixel is precise enough, without tracking at full size.
FINE_ENOUGH = 1 / 3
FEWEST = 12  # fewest corners that decide; with fewer, the pair is taken as rectified
# Largest median vertical offset of a pair whose rows correspond, in pixels; at least 1/4000 of the longer side.
TOLERANCE_PX = 0.5


def corners_correspond(pair: Pair, most_row_offset_px: float = 0.0) -> bool:
    """Test whether half of the corners, tracked into the right view, stay within TOLERANCE_PX of their rows."""
    longer = max(pair.left.shape)
    scale = min(1.0, LOOK_PX / longer)
    if min(pair.left.shape) * scale < PATCH_PX / 2:
        return True
    row_offsets_px = _row_offsets(pair, scale)
    # Too few corners decide nothing; if over half get lost, as when a camera was rotated far, the whole picture
    # decides.
    if row_offsets_px is None:
        return True
    if len(row_offsets_px) < FEWEST:
        return False
    corrected_px = float(np.clip(np.median(row_offsets_px), -most_row_offset_px, most_row_offset_px))
    return float(np.median(np.abs(row_offsets_px - corrected_px))) <= max(TOLERANCE_PX, longer / 4000)


@plain_opencv()
def _row_offsets(pair: Pair, scale: float) -> Float64[np.ndarray, "n"] | None:
    """Return the row offsets of tracked corners, in pixels; empty if over half got lost; None with too few corners."""
    small = [cv2.resize(view, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA) for view in pair]
    # Optical flow assumes constant brightness; equal histograms allow another exposure or gamma.
    small = [cv2.equalizeHist(view) for view in small]
    start = cv2.goodFeaturesToTrack(small[0], POINTS, 0.02, APART_PX)
    if start is None or len(start) < FEWEST:
        return None
    there = track(small[0], small[1], start, start, 3, WINDOW_PX)
    # A corner that is not tracked back to its start was lost or occluded.
    returns = np.linalg.norm(track(small[1], small[0], there, start, 3, WINDOW_PX) - start, axis=2)[:, 0] < 0.5
    if np.count_nonzero(returns) < len(start) / 2:
        return np.empty(0)
    start, there = ((points[returns] + 0.5) / scale - 0.5 for points in (start, there))
    row_offsets_px = (there - start if scale >= FINE_ENOUGH else _track_at_full_size(pair, start, there))[:, 0, 1]
    return row_offsets_px[np.isfinite(row_offsets_px)].astype(np.float64)


def _track_at_full_size(pair: Pair, start: Points, guess: Points) -> Float[np.ndarray, "inside 1 2"]:
    """Return shifts (x, y) of points tracked again at full size, in a column of patches instead of large pyramids."""
    at = [np.rint(points[:, 0]).astype(int) - PATCH_PX // 2 for points in (start, guess)]
    most = np.array(pair.left.shape[::-1]) - PATCH_PX
    inside = np.all([((corner >= 0) & (corner <= most)).all(axis=1) for corner in at], axis=0)
    if not inside.any():
        return start[:0]
    at = [corner[inside] for corner in at]
    patches = [
        cv2.equalizeHist(np.vstack([view[y : y + PATCH_PX, x : x + PATCH_PX] for x, y in corners]))
        for view, corners in zip(pair, at, strict=True)
    ]
    down = PATCH_PX * np.arange(len(at[0]))[:, None] * [0, 1]
    local = (start[inside][:, 0] - at[0] + down).astype(np.float32)[:, None]
    return track(patches[0], patches[1], local, local, 2, WINDOW_PX) - local + (at[1] - at[0])[:, None]


REACH = 1 / 6  # largest shift tried up and down, as a share of the picture's height
# Largest accepted shift, as a share of the picture's height and at least 2 px: other tests correct it.
NEAR = 1 / 200
MIN_BETTER = 0.05  # smallest gain in correlation of another height that fails the test
# Share of the unexplained part at the own height below which another height fails the test too: courses repeat.
LESS_LEFT = 0.6
NO_BETTER = 0.995
# Wavelength, as a share of the height, from which changes of grey are ignored: light, and the views' borders.
SLOW = 1 / 8


def rows_match_elsewhere(pair: Pair) -> bool:
    """Test whether the rows as a whole correlate better with rows at another height of the right view."""
    # Matching along rows may take one course of bricks for the next; their profiles lie at different heights.
    height = pair.left.shape[0]
    reach, near = int(REACH * height), max(2, round(NEAR * height))
    if reach <= near:
        return False
    left, right = (_profile(view) for view in pair)
    scores = _correlations(left, right, reach)
    best, own = float(scores.max()), float(scores[reach - near : reach + near + 1].max())
    return own < NO_BETTER and (best > own + MIN_BETTER or 1 - best < LESS_LEFT * (1 - own))


def _profile(view: UInt8[np.ndarray, "h w"]) -> Float64[np.ndarray, "h"]:
    means = cv2.reduce(view, 1, cv2.REDUCE_SUM, dtype=cv2.CV_32S)[:, 0] / view.shape[1]
    half = max(3, int(SLOW * len(means)))
    sums = np.concatenate([[0.0], np.cumsum(np.pad(means, half, mode="edge"))])
    return means - (sums[2 * half + 1 :] - sums[: -2 * half - 1]) / (2 * half + 1)


def _correlations(
    left: Float64[np.ndarray, "h"], right: Float64[np.ndarray, "h"], reach: int
) -> Float64[np.ndarray, "shifts"]:
    """Correlate the left profile with the right one -reach to reach rows further down, over their common rows."""
    nothing = np.zeros(reach)
    windows = np.lib.stride_tricks.sliding_window_view(np.concatenate([nothing, right, nothing]), len(left))
    both = np.einsum("sh,h->s", windows, left)
    # Downwards the lowest left rows and the uppermost right rows have no partner; upwards it is the other way round.
    ours, theirs = (np.cumsum(profile**2) for profile in (left, right))
    steps = np.arange(1, reach + 1)
    down = ours[-1 - steps] * (theirs[-1] - theirs[steps - 1])
    up = theirs[-1 - steps] * (ours[-1] - ours[steps - 1])
    energy = np.concatenate([up[::-1], [ours[-1] * theirs[-1]], down])
    return both / np.sqrt(np.maximum(energy, np.finfo(np.float64).tiny))


log: logging.Logger = logging.getLogger(__name__)

MIN_AGREED = 0.45  # lowest share of the edges with a row offset in a pair whose rows correspond
# Largest median deviation of these offsets, in pixels. Damaged pairs reach 0.21; a roll of 0.3 degrees has 0.47.
MAX_SPREAD_PX = 0.3
# Sigma of the Gaussian that averages noise away before a whole map is tested; bands are averages already.
SMOOTHING_PX = 1.2
# The same for a whole map: with noise of sd 5 to 15 two thirds agree, of rows that lie two lower a quarter.
MIN_AGREED_OF_MAP, MAX_SPREAD_OF_MAP_PX = 0.5, 0.4
MAX_OFF_PX = 0.5


def align_rows(pair: Pair, bands: Bands, most_row_offset_px: float) -> Pair | None:
    """Return the pair, its right view shifted by a constant row offset; None if its rows do not correspond."""
    # Bands compare along the rows only and are not trusted alone: repetitive rows match at a wrong height too.
    if rows_match_elsewhere(pair):
        return None
    row_offset_px = common_row_offset(pair, bands)
    if row_offset_px is None:
        return pair if corners_correspond(pair, most_row_offset_px) else None
    # A method that corrects an offset itself gets the pair as it is.
    if most_row_offset_px > 0 or abs(row_offset_px) <= MIN_ROW_OFFSET_PX:
        return pair
    note(log, f"rows realigned by {row_offset_px:.2f} px")
    return shift_rows(pair, row_offset_px)


def shift_rows(pair: Pair, row_offset_px: float) -> Pair:
    """Move the right view up by `row_offset_px`, so that rows correspond; cubic between rows."""
    nearest = round(row_offset_px)
    moved_px = nearest if abs(row_offset_px - nearest) < 0.15 else row_offset_px
    move = np.array([[1, 0, 0], [0, 1, -moved_px]], np.float32)
    with plain_opencv():
        right = cv2.warpAffine(
            pair.right, move, pair.right.shape[::-1], flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE
        )
    return Pair.of(pair.left, right)


def common_row_offset(pair: Pair, bands: Bands) -> float | None:
    """Measure by how many pixels the right rows lie below the left ones, 1.5 at most; None if it varies."""
    return _agreed_offset_px(row_votes(pair, bands.rows, bands.disparity, bands.factor), MIN_AGREED, MAX_SPREAD_PX)


def rows_correspond(pair: Pair, disparity_px: Float32[np.ndarray, "h w"], valid_mask: Bool[np.ndarray, "h w"]) -> bool:
    """Test whether `matched` pixels of a map correlate best in their own row: then noise prevented other matches."""
    rows = np.arange(CELL_PX // 2, len(valid_mask), CELL_PX)
    sixteenths = np.where(valid_mask[rows], np.rint(16 * disparity_px[rows]), UNKNOWN).astype(np.int16)
    with plain_opencv():
        left, right = (cv2.GaussianBlur(view, (0, 0), SMOOTHING_PX) for view in pair)
    votes = row_votes(Pair.of(left, right), rows, sixteenths)
    row_offset_px = _agreed_offset_px(votes, MIN_AGREED_OF_MAP, MAX_SPREAD_OF_MAP_PX)
    return row_offset_px is not None and abs(row_offset_px) <= MAX_OFF_PX


def _agreed_offset_px(votes: Float32[np.ndarray, "votes"], least_agreed: float, most_spread_px: float) -> float | None:
    """Return the median of `row_votes`; None if there are too few, or their deviation is too large."""
    offsets_px = votes[np.isfinite(votes)]
    if offsets_px.size < max(MIN_VOTES, least_agreed * votes.size):
        return None
    row_offset_px = float(np.median(offsets_px))
    return row_offset_px if np.median(np.abs(offsets_px - row_offset_px)) <= most_spread_px else None

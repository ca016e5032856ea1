"""The fundamental matrix from matches, left^T F right = 0: normalised eight-point, robust estimation, degeneracy."""

from collections.abc import Callable
from math import lgamma, log
from typing import Literal, NamedTuple

import cv2
import numpy as np
from jaxtyping import Bool, Float64

from tangible_core.errors import GeometryError

from ..sparse.matches import Matches
from .projective import Plane, homogeneous, product, transform

Degeneracy = Literal["not finite", "too few", "duplicate", "collinear", "homography", "outliers"]
# An estimator of F: matches, a weight for each match's equation -> F, as `eight_point`.
Fit = Callable[[Matches, np.ndarray | None], Float64[np.ndarray, "3 3"]]
CHANCE_SCENES = 1000  # scenes of which chance may produce a parallax in one
CELL_PX = 6  # side of the cells, in pixels, in which matches off a plane count once
MAX_SAMPLED = 100  # largest number of matches off a plane whose pairs are tried for an epipole
FEWEST = 8


class DegenerateMatches(GeometryError):
    """An error for matches that determine no fundamental matrix; `reason` names the case."""

    def __init__(self, reason: Degeneracy, message: str) -> None:
        self.reason: Degeneracy = reason
        super().__init__(f"no fundamental matrix: {message}")


class Fundamental(NamedTuple):
    """A robust estimate: the matrix (3, 3) of unit norm and rank 2, and which matches it explains."""

    matrix: Float64[np.ndarray, "3 3"]
    inliers: Bool[np.ndarray, "n"]


def check_matches(matches: Matches) -> None:
    """Check that matches can determine F. Raises: DegenerateMatches: not finite, too few, duplicate or collinear."""
    left_px, right_px = matches
    if left_px.shape != right_px.shape or left_px.ndim != 2 or left_px.shape[1] != 2:
        raise GeometryError(
            f"matches must be two arrays (n, 2) of equal length, not {left_px.shape} and {right_px.shape}"
        )
    pairs = np.hstack(matches)
    if not np.isfinite(pairs).all():
        count = np.count_nonzero(~np.isfinite(pairs).all(axis=1))
        raise DegenerateMatches("not finite", f"{count} of {len(pairs)} matches are NaN or infinite; leave them out")
    if len(pairs) < FEWEST:
        raise DegenerateMatches(
            "too few", f"{len(pairs)} matches, but {FEWEST} are needed; take pictures with more detail"
        )
    if (different := min(len(np.unique(points, axis=0)) for points in matches)) < FEWEST:
        raise DegenerateMatches(
            "duplicate", f"{different} different points in {len(pairs)} matches, but {FEWEST} are needed"
        )
    for side, points in zip(("left", "right"), matches, strict=True):
        along, across = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
        if across < 0.005 * along:  # noise then hides any geometry
            raise DegenerateMatches("collinear", f"the {side} points are collinear; add matches off that line")


def normalise(points_px: np.ndarray) -> tuple[Float64[np.ndarray, "n 3"], Float64[np.ndarray, "3 3"]]:
    """Move points to their centroid and scale them to a mean distance of sqrt(2) (Hartley 1997); return T too."""
    centre = points_px.mean(axis=0)
    spread = np.linalg.norm(points_px - centre, axis=1).mean()
    scale = np.sqrt(2) / spread
    transform = np.array([[scale, 0, -scale * centre[0]], [0, scale, -scale * centre[1]], [0, 0, 1.0]])
    return product(homogeneous(points_px), transform.T), transform


def eight_point(matches: Matches, weights: np.ndarray | None = None) -> Float64[np.ndarray, "3 3"]:
    """Estimate F, of unit norm and rank 2, from eight or more trusted matches. Raises: DegenerateMatches."""
    check_matches(matches)
    (left, to_left), (right, to_right) = map(normalise, matches)
    rows = np.einsum("ni,nj->nij", left, right).reshape(-1, 9)
    if weights is not None:
        rows = rows * (weights / weights.max())[:, None]
    # Hartley & Zisserman, 2nd ed., alg. 11.1. A second solution: the points are on a plane, or the camera only rotated.
    _, singular, basis = np.linalg.svd(np.vstack([rows, np.zeros((1, 9))]), full_matrices=False)
    if singular[7] < 1e-9 * singular[0]:
        raise DegenerateMatches("homography", _NO_PARALLAX)
    u, s, vt = np.linalg.svd(basis[8].reshape(3, 3))
    matrix = product(product(product(to_left.T, u * [s[0], s[1], 0]), vt), to_right)
    return matrix / np.linalg.norm(matrix)


_NO_PARALLAX = "one homography explains the matches (a flat scene, or a camera that only rotated)"


def robust_fundamental(matches: Matches, threshold_px: float = 1.0, fit: Fit = eight_point) -> Fundamental:
    """Estimate F from matches of which some are wrong: MAGSAC (OpenCV), then reweighted eight-point on its inliers."""
    # Deterministic. An object before a flat scene is enough to determine F. Sources: Barath et al., MAGSAC++, CVPR
    # 2020; Moisan & Stival, IJCV 2004, for the share that chance explains.
    check_matches(matches)
    first = _magsac(matches, threshold_px)
    plane = best_plane(matches, threshold_px)
    flat = np.zeros(len(matches.left_px), np.bool_) if plane is None else plane.near
    if plane is not None and 2 * np.count_nonzero(flat) > len(flat):
        first = _better_off_plane(plane, first, matches, threshold_px)
        if first is None:
            raise DegenerateMatches("homography", _NO_PARALLAX)
    if first is None or _false_alarms(matches, first.inliers, threshold_px) > 0:
        raise DegenerateMatches(
            "outliers",
            f"no epipolar geometry explains more of the {len(matches.left_px)} matches than chance would; "
            "do both pictures show the same scene?",
        )
    if _parallax_false_alarms(matches, first.inliers, flat, threshold_px) > -log(CHANCE_SCENES):
        raise DegenerateMatches("homography", _NO_PARALLAX)
    return _refine(first, matches, threshold_px, fit)


def _magsac(matches: Matches, threshold_px: float) -> Fundamental | None:
    # OpenCV's convention is second^T F first = 0.
    try:
        left_px, right_px = matches
        matrix, _ = cv2.findFundamentalMat(right_px, left_px, cv2.USAC_MAGSAC, threshold_px, 0.9999, 10_000)
    except cv2.error:  # an internal assertion fails if one plane explains nearly all matches
        return None
    if matrix is None or matrix.shape != (3, 3) or not np.isfinite(matrix).all() or not matrix.any():
        return None
    return _with_inliers(matrix, matches, threshold_px)


def sampson_distance(fundamental: np.ndarray, matches: Matches) -> Float64[np.ndarray, "n"]:
    """Return the first-order distance in pixels of each match from the nearest pair that obeys F."""
    # The root of Hartley & Zisserman, 2nd ed., eq. 11.9.
    left, right = map(homogeneous, matches)
    in_left, in_right = product(right, fundamental.T), product(left, fundamental)
    value = np.einsum("ni,ni->n", left, in_left)
    normals = [np.einsum("ni,ni->n", line[:, :2], line[:, :2]) for line in (in_left, in_right)]
    return np.abs(value) / np.sqrt(np.maximum(normals[0] + normals[1], np.finfo(np.float64).tiny))


def _with_inliers(matrix: np.ndarray, matches: Matches, threshold_px: float) -> Fundamental:
    matrix = matrix / np.linalg.norm(matrix)
    return Fundamental(matrix, sampson_distance(matrix, matches) <= threshold_px)


def best_plane(matches: Matches, threshold_px: float) -> Plane | None:
    """Find the homography that explains most matches; None without one."""
    matrix, _ = cv2.findHomography(matches.right_px, matches.left_px, cv2.USAC_MAGSAC, 2 * threshold_px)
    if matrix is None:
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        away = np.linalg.norm(transform(matrix, matches.right_px) - matches.left_px, axis=1)
    return Plane(matrix, away <= 3 * threshold_px)


def _better_off_plane(
    plane: Plane, first: Fundamental | None, matches: Matches, threshold_px: float
) -> Fundamental | None:
    if first is not None and 2 * np.count_nonzero(first.inliers & ~plane.near) > np.count_nonzero(~plane.near):
        return first
    # A second estimate is made only if the first leaves most of these unexplained.
    matrix = fundamental_from_plane(plane, matches, threshold_px)
    other = None if matrix is None else _with_inliers(matrix, matches, threshold_px)
    estimates = [estimate for estimate in (first, other) if estimate is not None]
    return max(estimates, key=lambda estimate: np.count_nonzero(estimate.inliers & ~plane.near), default=None)


def fundamental_from_plane(plane: Plane, matches: Matches, threshold_px: float) -> Float64[np.ndarray, "3 3"] | None:
    """Return F = [e]x H with the epipole e of most matches off the plane; None with fewer than two of them."""
    # Two matches off the plane determine an epipole; a sample of seven would seldom contain two of a small object.
    # Source: Chum, Werner & Matas, Two-View Geometry Estimation Unaffected by a Dominant Plane, CVPR 2005.
    off = matches.select(~plane.near)
    left, right = homogeneous(off.left_px), homogeneous(transform(plane.matrix, off.right_px))
    lines = np.cross(right, left)
    some = np.arange(len(left))[:: 1 + len(left) // MAX_SAMPLED]
    one, other = (some[indices] for indices in np.triu_indices(len(some), 1))
    epipoles = np.cross(lines[one], lines[other])
    length = np.linalg.norm(epipoles, axis=1)
    epipoles = epipoles[length > 0] / length[length > 0, None]
    if not len(epipoles):
        return None
    across = [epipoles[:, i, None] * right[:, 2] - epipoles[:, 2, None] * right[:, i] for i in (0, 1)]
    agreeing = np.abs(product(epipoles, lines.T)) <= threshold_px * np.hypot(*across)
    x, y, w = epipoles[np.count_nonzero(agreeing, axis=1).argmax()]
    return product(np.array([[0, -w, y], [w, 0, -x], [-y, x, 0]]), plane.matrix)


def _false_alarms(matches: Matches, inliers: np.ndarray, threshold_px: float) -> float:
    """Return the log number of geometries with as many inliers expected by chance (Moisan & Stival 2004, eq. 8)."""
    count, inlier_count = len(inliers), int(np.count_nonzero(inliers))
    if inlier_count < FEWEST:
        return np.inf
    tries = log(3 * (count - 7)) + _log_choose(count, inlier_count) + _log_choose(inlier_count, 7)
    return tries + (inlier_count - 7) * _log_chance(matches, threshold_px)


def _parallax_false_alarms(matches: Matches, inliers: np.ndarray, flat: np.ndarray, threshold_px: float) -> float:
    """Return the same for inliers of F off the homography: given a homography, two matches determine F."""
    # Neighbouring matches are wrong together, so those of one cell count once.
    count, inlier_count = (
        len(np.unique(matches.left_px[mask] // CELL_PX, axis=0)) for mask in (~flat, inliers & ~flat)
    )
    if inlier_count < 3:
        return np.inf
    tries = log(count) + _log_choose(count, inlier_count) + _log_choose(inlier_count, 2)
    return tries + (inlier_count - 2) * _log_chance(matches, threshold_px)


def _log_chance(matches: Matches, threshold_px: float) -> float:
    """Return the log probability that a random point lies near a random line: the line's strip over the picture."""
    width, height = np.minimum(*(np.ptp(points, axis=0) for points in matches))
    strip = 2 * threshold_px * float(np.hypot(width, height))
    return log(strip / (width * height)) if strip < width * height else 0.0


def _log_choose(n: int, k: int) -> float:
    return lgamma(n + 1) - lgamma(k + 1) - lgamma(n - k + 1)


def _refine(first: Fundamental, matches: Matches, threshold_px: float, fit: Fit) -> Fundamental:
    best = first
    for _ in range(5):
        inlier_matches = matches.select(best.inliers)
        doubt = 1 / np.hypot(1, sampson_distance(best.matrix, inlier_matches) / threshold_px)
        matrix = fit(inlier_matches, doubt * pixel_weights(best.matrix, inlier_matches))
        inliers = sampson_distance(matrix, matches) <= threshold_px
        if np.count_nonzero(inliers) < np.count_nonzero(best.inliers):
            break
        best = Fundamental(matrix, inliers)
    return best


def pixel_weights(fundamental: np.ndarray, matches: Matches) -> Float64[np.ndarray, "n"]:
    """Return weights that turn the algebraic residual of `eight_point` into the Sampson distance (n,), largest 1."""
    left, right = map(homogeneous, matches)
    in_left, in_right = product(right, fundamental.T)[:, :2], product(left, fundamental)[:, :2]
    weights = 1 / np.sqrt((in_left**2).sum(axis=1) + (in_right**2).sum(axis=1) + np.finfo(np.float64).tiny)
    return weights / weights.max()

"""Pairs as people take them: rows far apart, cameras verged, zoomed, rolled, lenses that distort, walls that repeat."""

from collections.abc import Iterator
from typing import NamedTuple

import cv2
import numpy as np

from tangible_core.data import Views
from tangible_core.plugins.notes import collected
from tangible_core.testing.synthetic.stereo_scenes import synthetic_pair
from tangible_depth.rectify.projective import camera_matrix, distort, inverse, rotation, transform, undistort
from tangible_depth.rectify.rectification import rectify
from tangible_depth.semi_global import SemiGlobal

from .figures import Figure

# Of the pairs, and what is cut off at each side: warping leaves no picture there.
SHAPE, CUT = (720, 960), 0.12
COURSE_PX = 24  # height of a course of bricks


class Taken(NamedTuple):
    """How a camera took its picture: turned about the middle, moved down, and through what lens."""

    roll_degrees: float = 0.0
    tilt: tuple[float, float] = (0.0, 0.0)
    zoom: float = 1.0
    rows_lower: float = 0.0
    radial: float = 0.0

    def homography(self) -> np.ndarray:
        """From a rectified picture to this one, before the lens."""
        middle = camera_matrix(1, SHAPE)
        turned = rotation(0, 0, np.radians(self.roll_degrees))
        turned[:2] *= self.zoom
        turned[2, :2] = self.tilt
        turned[1, 2] = self.rows_lower
        return middle @ turned @ np.linalg.inv(middle)

    def place_px(self, points_px: np.ndarray) -> np.ndarray:
        """Where this picture shows points (n, 2) of the rectified one."""
        return distort(transform(self.homography(), points_px), self.radial, SHAPE)

    def source_px(self) -> np.ndarray:
        """Which point of the rectified picture each pixel shows, (h w, 2)."""
        return transform(inverse(self.homography()), undistort(_pixels(), self.radial, SHAPE))


CAMERAS = {
    "10 rows lower": (Taken(), Taken(rows_lower=10)),
    "100 rows lower": (Taken(), Taken(rows_lower=100)),
    "a course lower": (Taken(), Taken(rows_lower=COURSE_PX)),
    "verged": (Taken(tilt=(1e-4, 0)), Taken(tilt=(-1e-4, 2e-5), rows_lower=6)),
    "zoomed": (Taken(), Taken(zoom=1.08, rows_lower=8)),
    "rolled": (Taken(roll_degrees=1), Taken(roll_degrees=-3, rows_lower=12)),
    "lenses": (Taken(radial=-0.1), Taken(radial=-0.1, roll_degrees=1, rows_lower=25)),
}


def figures() -> list[Figure]:
    """Share of the true matches that are found, and whether all pairs were noticed."""
    shares, noticed = {}, 0
    for name, views, truth_px in pairs():
        with collected() as notes:
            SemiGlobal().estimate(views)
        noticed += any(note.startswith("rectified: ") for note in notes)
        shares[name] = found_share(views, truth_px)
    worst = min(shares, key=shares.__getitem__)
    measured = (
        f"{shares[worst]:.1f} % at least ({worst}), {np.mean(list(shares.values())):.1f} % on the mean of "
        f"{len(shares)}; {noticed} of {len(shares)} rectified"
    )
    bound = ">= 93 % of what both views show within 2 px, every pair rectified"
    passed = shares[worst] >= 93 and noticed == len(shares)
    return [Figure("raw pairs: offset, verged, zoomed, rolled, distorted, repeating", bound, measured, passed)]


def pairs() -> Iterator[tuple[str, Views, np.ndarray]]:
    """Name, views, and where the right view shows each left pixel (h, w, 2), NaN where it does not."""
    height, width = SHAPE
    planes = synthetic_pair("planes", width, height)
    assert planes.views.right is not None
    known = np.where(planes.visible, planes.truth_px, np.float32(np.nan))
    scenes = {"planes": (planes.views.left, planes.views.right, known), "bricks": _bricks()}
    for scene, given in scenes.items():
        for name, cameras in CAMERAS.items():
            yield f"{scene}, {name}", *_taken(*given, *cameras)


def found_share(views: Views, truth_px: np.ndarray) -> float:
    """Percent of the true matches within 2 px of the place that the map leads to."""
    rectified = rectify(views, quick=False)
    found = rectified.to_original(SemiGlobal(rectify="never").estimate(rectified.views))
    away = np.linalg.norm(rectified.right_px(found.disparity_px) - truth_px, axis=2)
    return 100 * float(np.mean(away[np.isfinite(truth_px[..., 0])] <= 2))


def _taken(
    left: np.ndarray, right: np.ndarray, disparity_px: np.ndarray, one: Taken, other: Taken
) -> tuple[Views, np.ndarray]:
    source = one.source_px()
    columns, rows = np.rint(source).astype(int).T
    inside = (columns >= 0) & (columns < SHAPE[1]) & (rows >= 0) & (rows < SHAPE[0])
    shift = np.full(len(source), np.nan)
    shift[inside] = disparity_px[rows[inside], columns[inside]]
    truth = other.place_px(np.column_stack([source[:, 0] - shift, source[:, 1]])).reshape(*SHAPE, 2)
    top, side = (round(CUT * size) for size in SHAPE)
    kept = slice(top, -top), slice(side, -side)
    truth = truth[kept] - [side, top]
    last = [truth.shape[1] - 1, truth.shape[0] - 1]
    seen = np.all((truth >= 0) & (truth <= last), axis=2, keepdims=True)
    views = Views(_warped(left, one)[kept], _warped(right, other)[kept])
    return views, np.where(seen, truth, np.nan)


def _warped(picture: np.ndarray, camera: Taken) -> np.ndarray:
    columns, rows = camera.source_px().astype(np.float32).T.reshape(2, *SHAPE)
    return cv2.remap(picture, columns, rows, cv2.INTER_CUBIC)


def _bricks() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    y, x = np.indices(SHAPE)
    wall_px, pillar_px = 20, 52

    def pillar(columns: np.ndarray) -> np.ndarray:
        return (abs(columns - 0.55 * SHAPE[1]) < 0.15 * SHAPE[1]) & (abs(y - 0.55 * SHAPE[0]) < 0.25 * SHAPE[0])

    left = np.where(pillar(x), _wall(y, x, 1), _wall(y, x, 0))
    right = np.where(pillar(x + pillar_px), _wall(y, x + pillar_px, 1), _wall(y, x + wall_px, 0))
    disparity = np.where(pillar(x), pillar_px, wall_px).astype(np.float32)
    hidden = ~pillar(x) & pillar(x - wall_px + pillar_px)
    return left, right, np.where(hidden, np.float32(np.nan), disparity)


def _wall(rows: np.ndarray, columns: np.ndarray, seed: int) -> np.ndarray:
    random = np.random.default_rng(seed)
    tones = random.integers(90, 140, (SHAPE[0] // COURSE_PX + 1, SHAPE[1] // 24))
    grain = cv2.GaussianBlur(random.normal(0, 20, (SHAPE[0], 2 * SHAPE[1])), (0, 0), 1.2)
    course = rows // COURSE_PX
    along = columns + course % 2 * COURSE_PX
    mortar = (rows % COURSE_PX < 3) | (along % (2 * COURSE_PX) < 3)
    grey = np.where(mortar, 200, tones[course, along // (2 * COURSE_PX)]) + grain[rows, columns]
    return np.clip(np.rint(grey), 0, 255).astype(np.uint8)


def _pixels() -> np.ndarray:
    rows, columns = np.indices(SHAPE, np.float64)
    return np.column_stack([columns.ravel(), rows.ravel()])

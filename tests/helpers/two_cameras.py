"""Two cameras that look at points, and rendered pairs whose every pixel is known."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from tangible_depth.rectify.projective import camera_matrix, homogeneous, rotation, transform
from tangible_depth.sparse.matches import Matches

WIDTH, HEIGHT = 1000, 750


def seen_points(
    turn=(0.02, -0.05, 0.01), move_m=(-0.3, 0.02, 0.05), count=300, width=WIDTH, flat=False, noise_px=0.0, seed=0
):
    """Left and right pixels of random points; `turn` is pitch, yaw, roll, and X_right = rotation X_left + move."""
    random = np.random.default_rng(seed)
    height = width * 3 // 4
    camera = camera_matrix(0.9 * width, (height, width))
    rays = np.column_stack([random.uniform(0, [width, height], (count, 2)), np.ones(count)]) @ np.linalg.inv(camera).T
    depth = 5 / (1 + rays @ [0.2, 0.1, 0]) if flat else random.uniform(3, 8, count)
    points = rays * depth[:, None]
    left, right = points @ camera.T, (points @ rotation(*turn).T + move_m) @ camera.T
    pixels = [seen[:, :2] / seen[:, 2:] for seen in (left, right)]
    return Matches(*(pixel + random.normal(0, noise_px, pixel.shape) for pixel in pixels))


def some_wrong(left, right, share, seed=1):
    """The same matches with the first ones, a share of all, replaced by chance."""
    random = np.random.default_rng(seed)
    right = right.copy()
    wrong = round(share * len(right))
    right[:wrong] = random.uniform(0, right.max(axis=0), (wrong, 2))
    return Matches(left, right)


@dataclass(frozen=True)
class Scene:
    """A wall and a box before it, each with a texture that is a function of place: nothing is resampled."""

    shape: tuple[int, int] = (150, 200)
    wall_px: float = 6.0
    box_px: float = 14.0
    seed: int = 0
    slope: tuple[float, float] = (0.0, 0.0)
    """By how much the wall's disparity grows with each column and row."""
    box: tuple[float, float] = (0.2, 0.25)
    """Half the size of the box, as shares of the picture's."""

    def left(self, warp=None):
        """As the left camera sees it, then moved by a homography."""
        return _draw(self, False, _plain(warp)).copy()

    def right(self, warp=None):
        """As the right camera sees it, then moved by a homography."""
        return _draw(self, True, _plain(warp)).copy()

    def disparity_px(self):
        x, y = self._grid()
        wall = self.wall_px + self.slope[0] * x + self.slope[1] * y
        return np.where(self._in_box(x, y), self.box_px, wall)

    def in_box(self):
        """Left pixels that show the box."""
        return self._in_box(*self._grid())

    def visible(self):
        """Left pixels that the unmoved right camera sees too."""
        x, y = self._grid()
        hidden = ~self._in_box(x, y) & self._in_box(x - self.wall_px + self.box_px, y)
        return ~hidden & (x - self.disparity_px() >= 0)

    def matches(self, left_warp, right_warp):
        """Where both pictures, moved by these homographies, show each left pixel: two arrays (n, 2)."""
        left = np.column_stack([each.ravel() for each in self._grid()])
        shift = np.column_stack([self.disparity_px().ravel(), np.zeros(len(left))])
        return transform(left_warp, left), transform(right_warp, left - shift)

    def _grid(self, warp=None):
        rows, columns = np.indices(self.shape, np.float64)
        if warp is None:
            return columns, rows
        return transform(np.linalg.inv(warp), np.column_stack([columns.ravel(), rows.ravel()])).T.reshape(
            2, *self.shape
        )

    def _in_box(self, x, y):
        rows, columns = self.shape
        across, down = self.box
        return (abs(x - 0.55 * columns) < across * columns) & (abs(y - 0.5 * rows) < down * rows)


def _plain(warp):
    """Return the numbers of a homography, by which a view is kept."""
    return None if warp is None else tuple(np.ravel(warp).tolist())


@lru_cache(64)
def _draw(scene, right, warp):
    """Draw a view once for all tests that look at it."""
    x, y = scene._grid(None if warp is None else np.reshape(warp, (3, 3)))
    box = scene._in_box(x + scene.box_px if right else x, y)
    if right:
        across, down = scene.slope
        x = np.where(box, x + scene.box_px, (x + scene.wall_px + down * y) / (1 - across))
    random = np.random.default_rng(scene.seed)
    waves = random.uniform(-0.2, 0.2, (2, 80, 2)) * 2 * np.pi
    phases = random.uniform(0, 2 * np.pi, (2, 80))
    total = np.zeros(scene.shape)
    for shown, *layer in zip((~box, box), waves, phases, strict=True):
        columns, rows, sums = x[shown], y[shown], np.zeros(np.count_nonzero(shown))
        for (u, v), phase in zip(*layer, strict=True):
            sums += np.cos(u * columns + v * rows + phase)
        total[shown] = sums
    return np.clip(0.5 + 0.04 * total, 0, 1).astype(np.float32)


def roll_and_tilt(shape, degrees=2.0, tilt=(2e-5, -3e-5)):
    """A homography about the middle of a picture: a roll, and the perspective of a slight turn."""
    to_middle = camera_matrix(1, shape)
    turned = rotation(0, 0, np.radians(degrees))
    turned[2, :2] = tilt
    return to_middle @ turned @ np.linalg.inv(to_middle)


def symmetric_epipolar_distance(fundamental: np.ndarray, left_px: np.ndarray, right_px: np.ndarray) -> np.ndarray:
    """Root of the summed squares of the two distances of each match's points from their lines, pixels.

    Source: the root of Hartley & Zisserman, Multiple View Geometry, 2nd ed., eq. 11.10.
    """
    left, right = homogeneous(left_px), homogeneous(right_px)
    to_left, to_right = right @ fundamental.T, left @ fundamental
    value = np.einsum("ni,ni->n", left, to_left)
    return np.hypot(value / np.hypot(*to_left[:, :2].T), value / np.hypot(*to_right[:, :2].T))

"""Two cameras that look at points, and rendered pairs whose every pixel is known."""

import numpy as np

from tangible_depth.rectify.epipolar import homogeneous, lines_in_left
from tangible_depth.rectify.homographies import camera_matrix, rotation, transform

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
    return tuple(pixel + random.normal(0, noise_px, pixel.shape) for pixel in pixels)


def some_wrong(left, right, share, seed=1):
    """The same matches with the first ones, a share of all, replaced by chance."""
    random = np.random.default_rng(seed)
    right = right.copy()
    wrong = round(share * len(right))
    right[:wrong] = random.uniform(0, right.max(axis=0), (wrong, 2))
    return left, right


class Scene:
    """A wall and a box before it, each with a texture that is a function of place: nothing is resampled.

    slope: by how much the wall's disparity grows with each column and row; box: half its size, as shares of the
    picture's.
    """

    def __init__(self, shape=(150, 200), wall_px=6.0, box_px=14.0, seed=0, slope=(0.0, 0.0), box=(0.2, 0.25)):
        self.shape, self.wall_px, self.box_px, self.slope, self.box = shape, wall_px, box_px, slope, box
        random = np.random.default_rng(seed)
        self._waves = random.uniform(-0.2, 0.2, (2, 80, 2)) * 2 * np.pi
        self._phases = random.uniform(0, 2 * np.pi, (2, 80))

    def left(self, warp=None):
        """As the left camera sees it, then moved by a homography."""
        x, y = self._grid(warp)
        return self._paint(x, y, self._in_box(x, y))

    def right(self, warp=None):
        """As the right camera sees it, then moved by a homography."""
        x, y = self._grid(warp)
        box = self._in_box(x + self.box_px, y)
        across, down = self.slope
        wall = (x + self.wall_px + down * y) / (1 - across)
        return self._paint(np.where(box, x + self.box_px, wall), y, box)

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

    def _paint(self, x, y, box):
        layers = []
        for waves, phases in zip(self._waves, self._phases, strict=True):
            total = np.zeros(x.shape)
            for (u, v), phase in zip(waves, phases, strict=True):
                total += np.cos(u * x + v * y + phase)
            layers.append(0.5 + 0.04 * total)
        return np.clip(np.where(box, layers[1], layers[0]), 0, 1).astype(np.float32)


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
    to_left = np.einsum("ni,ni->n", lines_in_left(fundamental, right_px), homogeneous(left_px))
    to_right = np.einsum("ni,ni->n", lines_in_left(fundamental.T, left_px), homogeneous(right_px))
    return np.hypot(to_left, to_right)

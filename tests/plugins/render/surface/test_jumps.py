"""A groove or a lip would be felt at a step, a line or a border; or waves would change by a bit."""

import numpy as np
import pytest
from scipy.ndimage import spline_filter

from tangible_core.data import HapticSurface, Relief
from tangible_render.proxy import Proxy
from tangible_render.surface import spline
from tangible_render.surface.coefficients import spline_coefficients, spline_surface
from tangible_render.surface.jumps import jumps

K, DEPTH_M, WIDTH_M = 800.0, 0.001, 0.08
SIZES = [(64, 64), (256, 256), (48, 1024), (24, 4096)]
DEGREES = (0, 90, 180, 10, 45, 77)


def step(shape: tuple[int, int], degrees: float, high_m: float = 0.01, blur_cells: float = 0.0) -> HapticSurface:
    """Return ground that steps down past the centre in this direction, blurred as by a camera."""
    row, column = np.indices(shape) + 0.5
    x, y = column - shape[1] / 2, shape[0] / 2 - row
    over = 0.1 - np.cos(np.radians(degrees)) * x - np.sin(np.radians(degrees)) * y
    heights = np.clip(over / blur_cells + 0.5, 0, 1) if blur_cells else over > 0
    extent_m = (WIDTH_M, WIDTH_M * shape[0] / shape[1])
    return HapticSurface(Relief((high_m * heights).astype(np.float32), extent_m))


def read(surface: HapticSurface, places: np.ndarray) -> np.ndarray:
    coefficients, _, _, across, down = spline_surface(surface, "never")
    return np.array([spline.height(coefficients, across, down, x, y) for x, y in places.tolist()])


@pytest.mark.parametrize("shape", SIZES)
class TestSteps:
    def test_step_has_no_groove_and_no_lip_and_does_not_hold_the_hand(self, shape: tuple[int, int]):
        """Sharp and blurred edges, up to the borders, were off by a fifth of the step without easing."""
        random = np.random.default_rng(5)
        for degrees in DEGREES if shape[0] > 50 else (0, 180):
            for high_m, blur_cells in ((0.02, 0.0), (0.0005, 0.0), (0.01, 1.0), (0.01, 2.0)):
                surface = step(shape, degrees, high_m, blur_cells)
                places = random.uniform(-0.5, 0.5, (1500, 2)) * surface.extent_m
                places[:1000, 0] *= min(8 / shape[1], 1) if degrees in (0, 180) else 1
                found = read(surface, places) / high_m
                assert found.min() >= -0.01 and found.max() <= 1.01
                assert found.min() < 0.001 and found.max() > 0.999
        for angle in DEGREES if shape[0] > 50 else (0, 180):
            away = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
            pitch_m = WIDTH_M / shape[1]
            along = np.append(np.full(1500, 0.5 * pitch_m), np.linspace(0.5 * pitch_m, 0.012, 2000))
            z = np.append(np.linspace(0.012, -DEPTH_M, 1500), np.full(2000, -DEPTH_M))
            path = np.column_stack([along[:, None] * away, z])
            force = Proxy(stiffness_n_per_m=K).touch(step(shape, angle)).path(path)
            free = (along > 2.5 * pitch_m) & (np.arange(3500) > 1500)
            assert free.any()
            assert np.abs(force[free] - [0, 0, K * DEPTH_M]).max() <= 1e-4
            assert np.abs(force).max() <= 8.01 + K * DEPTH_M


def waves(seed: int, shortest_cells: float) -> np.ndarray:
    random, (row, column) = np.random.default_rng(seed), np.indices((96, 120))
    number = random.normal(0, 1, (5, 2))
    number *= 2 * np.pi / shortest_cells / np.abs(number).max()
    turned, high = random.uniform(0, 7, 5), 10 ** random.uniform(-3, 0, 5)
    sum_of = sum(a * np.sin(u * column + v * row + p) for (u, v), p, a in zip(number, turned, high, strict=True))
    return np.asarray(sum_of - np.min(sum_of), np.float32)


def test_waves_are_interpolated_to_the_bit():
    for seed in range(40):
        heights = waves(seed, (8, 12, 40, 3000)[seed % 4])
        continued = np.pad(heights.astype(np.float64), 32, mode="reflect", reflect_type="odd")
        exact = spline_filter(continued, order=3, mode="mirror")[30:-30, 30:-30].astype(np.float32)
        assert not jumps(heights).any()
        assert (spline_coefficients(heights) == exact).all()


@pytest.mark.parametrize("turned", [False, True])
def test_line_of_one_cell_keeps_its_height(turned: bool):
    heights = np.zeros((40, 40), np.float32)
    heights[:, 20] = 0.002
    surface = HapticSurface.from_heights(heights.T if turned else heights, WIDTH_M)
    x = (np.arange(20 * 64) / 64 - 10) * WIDTH_M / 40
    across = np.column_stack([0 * x, -x] if turned else [x, 0 * x])
    found = read(surface, across)
    assert found.max() == pytest.approx(0.002, rel=1e-6) and found.min() >= -1e-9


@pytest.mark.parametrize("where", range(1, 5))
def test_ground_beyond_a_jump_at_the_border_is_level(where: int):
    """Without easing the ground rose further, by half of the step at the border."""
    heights = np.zeros((30, 40), np.float32)
    heights[:, -where:] = 0.01
    x = np.linspace(0.3, 0.5, 400) * WIDTH_M
    found = read(HapticSurface.from_heights(heights, WIDTH_M), np.column_stack([x, 0 * x]))
    assert found.max() <= 0.0101 and found.min() >= -0.0001

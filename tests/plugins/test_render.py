"""Forces on surfaces whose answer is known exactly."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from tangible_core.data import NO_FORCE, Force, HapticState, HapticSurface, Material, Relief
from tangible_core.errors import GeometryError
from tangible_core.plugins.interfaces import Touch
from tangible_render.force_shading import ForceShading
from tangible_render.grey_level import GreyLevel
from tangible_render.lateral_gradient import LateralGradient
from tangible_render.lateral_shape import LateralShape
from tangible_render.penalty import Penalty
from tangible_render.penalty_gradient import PenaltyGradient
from tangible_render.proxy import Proxy
from tangible_render.tangible_mask import TangibleMask

WIDTH_M = 0.0625  # powers of two: cells, centres and slopes below are exact in floating point
UP_M = 1 / 32
PUSHING_UP = (
    PenaltyGradient(),
    PenaltyGradient(damping_n_s_per_m=2.0),
    GreyLevel(),
    Penalty(damping_n_s_per_m=2.0),
    ForceShading(),
    Proxy(),
    Proxy(static_friction=0.5, dynamic_friction=0.3, damping_n_s_per_m=2.0),
)
LATERAL = (TangibleMask(), LateralGradient(), LateralShape())
RENDERERS = PUSHING_UP + LATERAL
RNG = np.random.default_rng(7)
BUMPY = HapticSurface.from_heights(RNG.uniform(0, 0.004, (12, 16)), WIDTH_M)


def at(touch: Touch, x: float, y: float, z: float, velocity=(0.0, 0.0, 0.0)) -> Force:
    return touch.force(HapticState((x, y, z), velocity))


def tilted(slope_x: float, slope_y: float, shape: tuple[int, int] = (32, 32), width_m: float = WIDTH_M):
    """A plane, UP_M high at the origin, of square cells."""
    rows, columns = shape
    pitch = width_m / columns
    x = (np.arange(columns) + 0.5) * pitch - width_m / 2
    y = rows * pitch / 2 - (np.arange(rows) + 0.5) * pitch
    return HapticSurface.from_heights(UP_M + slope_x * x[None, :] + slope_y * y[:, None], width_m)


def material(name: str, stiffness_n_per_m: float) -> Material:
    return Material(name, stiffness_n_per_m, 3.0, 0.5, 0.4)


class TestPenaltyGradient:
    @pytest.mark.parametrize("depth_m", [2**-20, 2**-10, 2**-7, 0.5])
    def test_level_ground_is_a_spring(self, depth_m: float):
        touch = PenaltyGradient(stiffness_n_per_m=640.0).touch(tilted(0, 0))
        assert at(touch, 0.01, -0.02, UP_M - depth_m) == (0.0, 0.0, 640.0 * depth_m)

    def test_tilted_plane_is_exact_in_height_and_direction(self):
        touch = PenaltyGradient(stiffness_n_per_m=512.0).touch(tilted(0.125, -0.0625))
        x, y, depth = 3 / 1024, -5 / 1024, 1 / 512
        z = UP_M + 0.125 * x - 0.0625 * y - depth
        assert at(touch, x, y, z) == (-0.125 * 1.0, 0.0625 * 1.0, 1.0)

    def test_one_bilinear_patch(self):
        """h = a + b x + c y + e x y through four centres: height and gradient are those of the polynomial."""
        corners = np.array([[1, 3], [2, 7]]) / 1024  # far row first
        touch = PenaltyGradient(stiffness_n_per_m=1024.0).touch(HapticSurface.from_heights(corners, 2.0))
        x, y = 0.25, -0.125  # centres stand at -+ 0.5
        u, v = x + 0.5, 0.5 - y
        height = ((1 - v) * (1 * (1 - u) + 3 * u) + v * (2 * (1 - u) + 7 * u)) / 1024
        slope_x, slope_y = ((1 - v) * 2 + v * 5) / 1024, -((1 - u) * 1 + u * 4) / 1024
        depth = 1 / 256
        assert at(touch, x, y, height - depth) == (-4 * slope_x, -4 * slope_y, 4.0)

    def test_heights_go_on_unchanged_from_the_last_centre_to_the_edge(self):
        surface = tilted(0.125, 0)
        touch = PenaltyGradient(stiffness_n_per_m=512.0).touch(surface)
        edge = WIDTH_M / 2
        highest = float(surface.height_m[0, -1])
        for x in (edge, edge - surface.relief.pitch_m[0] / 4):
            assert at(touch, x, 0.0, highest - 1 / 512) == (0.0, 0.0, 1.0)

    def test_sphere_within_the_error_of_its_samples(self):
        radius, count, k = 0.05, 256, 800.0
        pitch = WIDTH_M / count
        c = (np.arange(count) + 0.5) * pitch - WIDTH_M / 2
        cap = np.sqrt(radius**2 - c[None, :] ** 2 - c[:, None] ** 2) - 0.02
        touch = PenaltyGradient(stiffness_n_per_m=k).touch(HapticSurface.from_heights(cap, WIDTH_M))
        curvature = radius**2 / (radius**2 - 2 * 0.02**2) ** 1.5  # the most of h'' where |x|, |y| <= 0.02
        for x, y in RNG.uniform(-0.02, 0.02, (200, 2)):
            up = np.sqrt(radius**2 - x**2 - y**2)
            depth = 0.001
            force = np.array(at(touch, x, y, up - 0.02 - depth))
            off_m = 2 * pitch**2 / 8 * curvature + 1e-8
            assert abs(force[2] / k - depth) <= off_m
            slope = -force[:2] / force[2]
            assert np.abs(slope + np.array([x, y]) / up).max() <= 2 * pitch * curvature

    def test_force_is_the_gradient_of_its_potential(self):
        """F = -grad U with U = k d^2 / 2, by central differences inside each cell."""
        k, step, z = 800.0, 1e-7, -0.001
        touch = PenaltyGradient(stiffness_n_per_m=k).touch(BUMPY)

        def potential(x: float, y: float, z: float) -> float:
            return at(touch, x, y, z).z ** 2 / (2 * k)

        for x, y in RNG.uniform(-0.02, 0.02, (50, 2)):
            numeric = [
                (potential(x - a, y - b, z - c) - potential(x + a, y + b, z + c)) / (2 * step)
                for a, b, c in np.eye(3) * step
            ]
            assert np.allclose(at(touch, x, y, z), numeric, rtol=2e-4, atol=2e-4)

    @given(st.floats(0.001, 0.02), st.floats(0, 6.28), st.integers(1, 3))
    def test_no_work_over_a_closed_path(self, radius_m: float, start: float, waves: int):
        turn = start + np.linspace(0, 2 * np.pi, 20001)
        path = np.column_stack(
            [radius_m * np.cos(turn), 0.7 * radius_m * np.sin(turn), 0.002 + 0.001 * np.sin(waves * turn)]
        )
        force = PenaltyGradient().touch(BUMPY).path(path)
        steps, mean = np.diff(path, axis=0), (force[1:] + force[:-1]) / 2
        moved = np.abs(mean * steps).sum()
        assert moved > 0
        # the slope steps at cell edges, so the sum over 20000 chords is right to the first order only
        assert abs((mean * steps).sum()) <= 1e-3 * moved

    def test_damping_acts_along_the_normal_in_contact_and_never_pulls(self):
        slope, k, b, depth = 0.5, 512.0, 4.0, 1 / 256
        touch = PenaltyGradient(stiffness_n_per_m=k, damping_n_s_per_m=b).touch(tilted(slope, 0))
        normal = np.array([-slope, 0, 1]) / np.hypot(slope, 1)
        along = np.array([1, 0, slope])
        spring = k * depth * np.hypot(slope, 1)
        for speed in (-0.25, 0.0, 0.125, 100.0):
            force = at(touch, 0.0, 0.0, UP_M - depth, tuple(speed * normal + 0.5 * along))
            assert np.allclose(force, max(0.0, spring - b * speed) * normal, rtol=1e-12, atol=1e-12)
        assert at(touch, 0.0, 0.0, 0.05, (0.0, 0.0, -1.0)) == NO_FORCE

    def test_materials_give_the_stiffness_of_their_cell(self):
        labels = np.zeros((4, 8), np.int32)
        labels[:, 4:], labels[3, :] = 1, 2
        materials = material("soft", 128.0), material("hard", 1024.0), material("middling", 256.0)
        surface = HapticSurface.from_heights(np.full((4, 8), UP_M), WIDTH_M, labels, materials)
        touch = PenaltyGradient().touch(surface)
        for x, y, stiffness in ((-1e-9, 0, 128), (1e-9, 0, 1024), (-0.03, -0.015, 256), (0.03125, -0.015625, 256)):
            assert at(touch, x, y, 0.0).z == stiffness * UP_M

    def test_labels_without_materials_have_the_stiffness_of_the_option(self):
        surface = HapticSurface.from_heights(np.full((2, 2), UP_M), WIDTH_M, np.zeros((2, 2), np.int32))
        assert at(PenaltyGradient().touch(surface), 0.0, 0.0, 0.0).z == 800 * UP_M

    def test_resampling_a_plane_changes_nothing(self):
        forces = [at(PenaltyGradient().touch(tilted(0.25, 0.125, (n, n))), 0.003, 0.007, 0.001) for n in (16, 32, 64)]
        assert np.allclose(forces, forces[0], rtol=1e-6)

    def test_resampling_a_smooth_surface_changes_less_than_a_finger_feels(self):
        def waves(count: int) -> HapticSurface:
            c = ((np.arange(count) + 0.5) / count - 0.5) * WIDTH_M
            return HapticSurface.from_heights(0.005 + 0.002 * np.sin(150 * c)[None] * np.cos(120 * c)[:, None], WIDTH_M)

        path = np.column_stack([*RNG.uniform(-0.028, 0.028, (2, 500)), np.full(500, 0.002)])
        coarse, plain, fine = (PenaltyGradient().touch(waves(n)).path(path) for n in (128, 256, 512))
        size = np.linalg.norm(plain, axis=1)
        for other in (coarse, fine):
            assert (np.linalg.norm(other - plain, axis=1) / size).max() < 0.03  # magnitude is told apart from 7 % on


class TestGreyLevel:
    def test_force_is_the_grey_of_the_cell_under_the_tip(self):
        heights = np.array([[0, 51, 102], [153, 204, 255]]) / 255 * 0.01
        touch = GreyLevel(force_at_white_n=5.0).touch(HapticSurface.from_heights(heights, 0.03))
        for row, y in enumerate((0.009, -0.001)):
            for column, x in enumerate((-0.0149, -0.0049, 0.0051)):
                assert at(touch, x, y, -1e-4) == pytest.approx((0, 0, 5.0 * (3 * row + column) / 5))

    def test_it_steps_at_the_surface_and_knows_no_depth(self):
        touch = GreyLevel(force_at_white_n=3.0).touch(tilted(0, 0))
        assert at(touch, 0, 0, UP_M) == NO_FORCE
        assert at(touch, 0, 0, np.nextafter(UP_M, 0)) == (0, 0, 3.0)
        assert at(touch, 0, 0, -1.0) == (0, 0, 3.0)

    def test_heights_are_of_256_steps(self):
        ramp = np.linspace(0, 0.01, 4001)[None, :]
        path = np.column_stack([np.linspace(-0.0399, 0.0399, 4001), np.zeros(4001), np.full(4001, -0.001)])
        felt = GreyLevel(force_at_white_n=255.0).touch(HapticSurface.from_heights(ramp)).path(path)[:, 2]
        assert np.array_equal(np.unique(felt), np.arange(256))

    def test_black_ground_is_not_felt(self):
        assert at(GreyLevel().touch(HapticSurface.from_heights(np.zeros((3, 3)))), 0, 0, -0.01) == NO_FORCE

    @pytest.mark.parametrize("highest", [1e-45, 1e-30, 3e38])
    def test_any_range_of_heights(self, highest: float):
        surface = HapticSurface.from_heights(np.array([[0, highest]]))
        assert at(GreyLevel(force_at_white_n=2.0).touch(surface), 0.01, 0, -0.01) == (0, 0, 2.0)

    def test_it_wants_no_materials(self):
        assert not GreyLevel.uses_materials


@pytest.mark.parametrize("renderer", RENDERERS, ids=repr)
class TestEveryRenderer:
    def test_free_air(self, renderer):
        touch, edge = renderer.touch(tilted(0, 0)), WIDTH_M / 2
        assert at(touch, 0, 0, UP_M) == NO_FORCE
        assert at(touch, 0, 0, UP_M, (0, 0, -1)) == NO_FORCE
        for x, y in ((np.nextafter(edge, 1), 0), (0, -np.nextafter(edge, 1)), (5, 5), (1e300, 0)):
            assert at(touch, x, y, 0.0) == NO_FORCE
        for x, y in ((edge, edge), (-edge, -edge)):
            assert (at(touch, x, y, 0.0).z > 0) == (renderer in PUSHING_UP)

    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
    @pytest.mark.parametrize("axis", range(6))
    def test_a_state_that_is_not_finite_is_not_pushed(self, renderer, bad: float, axis: int):
        numbers = [0.001, 0.002, -0.003, 0.0, 0.0, 0.0]
        numbers[axis] = bad
        assert at(renderer.touch(BUMPY), *numbers[:3], velocity=tuple(numbers[3:])) == NO_FORCE

    def test_a_path_is_force_by_force(self, renderer):
        path = np.column_stack([RNG.uniform(-0.035, 0.035, (300, 2)), RNG.uniform(-0.002, 0.005, 300)])
        path[77] = np.nan
        steps = np.diff(path, axis=0, prepend=path[:1]) / 0.002
        steps[[77, 78]] = 0  # a step from or to nowhere has no velocity
        touch = renderer.touch(BUMPY)
        singly = [touch.force(HapticState(tuple(p), tuple(v))) for p, v in zip(path, steps, strict=True)]
        assert np.array_equal(renderer.touch(BUMPY).path(path, period_s=0.002), singly)
        assert np.count_nonzero(singly) > 50

    def test_paths_of_any_layout(self, renderer):
        def felt(path: np.ndarray) -> np.ndarray:
            return renderer.touch(BUMPY).path(path)

        assert felt(np.empty((0, 3))).shape == (0, 3)
        path = np.asfortranarray(RNG.uniform(-0.003, 0.003, (10, 3)))
        path.flags.writeable = False
        assert np.array_equal(felt(path), felt(np.ascontiguousarray(path)))
        assert np.array_equal(felt(np.zeros((1, 3), int)), [at(renderer.touch(BUMPY), 0, 0, 0)])

    @pytest.mark.parametrize("shape", [(3,), (3, 2), (2, 3, 3)])
    def test_what_is_no_path(self, renderer, shape: tuple[int, ...]):
        with pytest.raises(GeometryError, match=r"\(n, 3\)"):
            renderer.touch(BUMPY).path(np.zeros(shape))

    @pytest.mark.parametrize("period_s", [0.0, -1.0, np.nan, np.inf])
    def test_what_is_no_period(self, renderer, period_s: float):
        with pytest.raises(GeometryError, match="period_s"):
            renderer.touch(BUMPY).path(np.zeros((2, 3)), period_s)

    @pytest.mark.parametrize("shape", [(1, 1), (1, 5), (5, 1), (2, 1)])
    def test_the_smallest_surfaces(self, renderer, shape: tuple[int, int]):
        touch = renderer.touch(HapticSurface(Relief(np.full(shape, UP_M, np.float32), (WIDTH_M, WIDTH_M))))
        expected = renderer.touch(tilted(0, 0))
        for x, y in ((0, 0), (0.03125, -0.03125), (-0.013, 0.021)):
            assert at(touch, x, y, 0.001) == pytest.approx(at(expected, x, y, 0.001), abs=1e-12)

    def test_heights_of_any_layout(self, renderer):
        heights = np.asarray(RNG.uniform(0, 0.004, (6, 9)), np.float32)
        extent = (WIDTH_M, WIDTH_M)
        plain = renderer.touch(HapticSurface(Relief(heights, extent)))
        turned = renderer.touch(HapticSurface(Relief(np.asfortranarray(heights), extent)))
        path = RNG.uniform(-0.004, 0.004, (50, 3))
        assert np.array_equal(plain.path(path), turned.path(path))

    @given(st.lists(st.floats(), min_size=6, max_size=6))
    def test_always_finite(self, renderer, numbers: list[float]):
        force = at(renderer.touch(BUMPY), *numbers[:3], velocity=tuple(numbers[3:]))
        assert np.isfinite(force).all()


@pytest.mark.parametrize(
    ("renderer", "option", "value"),
    [
        (PenaltyGradient, "stiffness_n_per_m", 0),
        (PenaltyGradient, "stiffness_n_per_m", -800),
        (PenaltyGradient, "stiffness_n_per_m", np.inf),
        (PenaltyGradient, "damping_n_s_per_m", -1),
        (PenaltyGradient, "damping_n_s_per_m", np.nan),
        (PenaltyGradient, "stifness_n_per_m", 800),
        (GreyLevel, "force_at_white_n", 0),
        (GreyLevel, "force_at_white_n", np.nan),
        (Penalty, "damping_n_s_per_m", -1),
        (TangibleMask, "mask_px", 4),
        (TangibleMask, "mask_px", 1),
        (TangibleMask, "mask_m", 0),
        (LateralGradient, "dequantise", "often"),
        (LateralShape, "dequantise", 0),
        (Proxy, "static_friction", -0.1),
        (Proxy, "dynamic_friction", 0.2),
    ],
)
def test_options_that_make_no_sense(renderer, option: str, value: float):
    with pytest.raises(ValidationError, match=option):
        renderer(**{option: value})

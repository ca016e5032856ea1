"""The gradient spring on surfaces with exact answers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planes import UP_M, WIDTH_M, at, tilted
from tangible_core.data import NO_FORCE, HapticSurface, Material
from tangible_render.penalty_gradient import PenaltyGradient

RNG = np.random.default_rng(7)
BUMPY = HapticSurface.from_heights(RNG.uniform(0, 0.004, (12, 16)), WIDTH_M)


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

    def test_bilinear_patch_is_exact_in_height_and_gradient(self):
        """h = a + b x + c y + e x y through four centres: height and gradient are those of the polynomial."""
        corners = np.array([[1, 3], [2, 7]]) / 1024  # far row first
        touch = PenaltyGradient(stiffness_n_per_m=1024.0).touch(HapticSurface.from_heights(corners, 2.0))
        x, y = 0.25, -0.125  # centres stand at -+ 0.5
        u, v = x + 0.5, 0.5 - y
        height = ((1 - v) * (1 * (1 - u) + 3 * u) + v * (2 * (1 - u) + 7 * u)) / 1024
        slope_x, slope_y = ((1 - v) * 2 + v * 5) / 1024, -((1 - u) * 1 + u * 4) / 1024
        depth = 1 / 256
        assert at(touch, x, y, height - depth) == (-4 * slope_x, -4 * slope_y, 4.0)

    def test_surface_has_the_height_and_the_normal_that_the_law_has(self):
        surface = HapticSurface.from_heights(RNG.uniform(0.001, 0.004, (40, 60)).astype(np.float32), 0.08)
        touch = PenaltyGradient(stiffness_n_per_m=640.0).touch(surface)
        x, y = RNG.uniform(-0.04, 0.04, 200), RNG.uniform(-0.026, 0.026, 200)
        for point in zip(x, y, surface.height_at(x, y), surface.normal_at(x, y), strict=True):
            force = np.array(at(touch, *point[:2], point[2] - 0.001))
            np.testing.assert_allclose(force, 0.64 * point[3] / point[3][2], rtol=1e-9)

    def test_heights_from_the_last_centre_to_the_edge_are_constant(self):
        surface = tilted(0.125, 0)
        touch = PenaltyGradient(stiffness_n_per_m=512.0).touch(surface)
        edge = WIDTH_M / 2
        highest = float(surface.height_m[0, -1])
        for x in (edge, edge - surface.relief.pitch_m[0] / 4):
            assert at(touch, x, 0.0, highest - 1 / 512) == (0.0, 0.0, 1.0)

    def test_sphere_is_within_the_error_of_its_samples(self):
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
    def test_closed_path_does_no_work(self, radius_m: float, start: float, waves: int):
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

    def test_materials_set_the_stiffness_of_their_cell(self):
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

    def test_plane_resampled_has_the_same_forces(self):
        forces = [at(PenaltyGradient().touch(tilted(0.25, 0.125, (n, n))), 0.003, 0.007, 0.001) for n in (16, 32, 64)]
        assert np.allclose(forces, forces[0], rtol=1e-6)

    def test_smooth_surface_resampled_changes_imperceptibly(self):
        def waves(count: int) -> HapticSurface:
            c = ((np.arange(count) + 0.5) / count - 0.5) * WIDTH_M
            return HapticSurface.from_heights(0.005 + 0.002 * np.sin(150 * c)[None] * np.cos(120 * c)[:, None], WIDTH_M)

        path = np.column_stack([*RNG.uniform(-0.028, 0.028, (2, 500)), np.full(500, 0.002)])
        coarse, plain, fine = (PenaltyGradient().touch(waves(n)).path(path) for n in (128, 256, 512))
        size = np.linalg.norm(plain, axis=1)
        for other in (coarse, fine):
            assert (np.linalg.norm(other - plain, axis=1) / size).max() < 0.03  # magnitude is told apart from 7 % on

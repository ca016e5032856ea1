"""The gradient spring would give a wrong force: on surfaces with exact answers."""

import numpy as np
import pytest

from planes import UP_M, WIDTH_M, at, tilted
from tangible_core.data import NO_FORCE, HapticSurface, Material
from tangible_render.penalty_gradient import PenaltyGradient

RNG = np.random.default_rng(7)
BUMPY = HapticSurface.from_heights(RNG.uniform(0, 0.004, (12, 16)), WIDTH_M)


def material(name: str, stiffness_n_per_m: float) -> Material:
    return Material(name, stiffness_n_per_m, 3.0, 0.5, 0.4)


class TestPenaltyGradient:
    @pytest.mark.parametrize("depth_m", [2**-20, 2**-10, 2**-7, 0.5])
    def test_level_ground_is_a_spring_and_a_tilted_plane_exact_in_height_and_direction(self, depth_m: float):
        touch = PenaltyGradient(stiffness_n_per_m=640.0).touch(tilted(0, 0))
        assert at(touch, 0.01, -0.02, UP_M - depth_m) == (0.0, 0.0, 640.0 * depth_m)
        touch = PenaltyGradient(stiffness_n_per_m=512.0).touch(tilted(0.125, -0.0625))
        x, y, depth = 3 / 1024, -5 / 1024, 1 / 512
        z = UP_M + 0.125 * x - 0.0625 * y - depth
        assert at(touch, x, y, z) == (-0.125 * 1.0, 0.0625 * 1.0, 1.0)

    def test_bilinear_patch_is_exact_and_constant_to_the_edge(self):
        """h = a + b x + c y + e x y through four centres: height and gradient are those of the polynomial."""
        corners = np.array([[1, 3], [2, 7]]) / 1024  # far row first
        touch = PenaltyGradient(stiffness_n_per_m=1024.0).touch(HapticSurface.from_heights(corners, 2.0))
        x, y = 0.25, -0.125  # centres stand at -+ 0.5
        u, v = x + 0.5, 0.5 - y
        height = ((1 - v) * (1 * (1 - u) + 3 * u) + v * (2 * (1 - u) + 7 * u)) / 1024
        slope_x, slope_y = ((1 - v) * 2 + v * 5) / 1024, -((1 - u) * 1 + u * 4) / 1024
        depth = 1 / 256
        assert at(touch, x, y, height - depth) == (-4 * slope_x, -4 * slope_y, 4.0)
        surface = tilted(0.125, 0)
        touch = PenaltyGradient(stiffness_n_per_m=512.0).touch(surface)
        edge = WIDTH_M / 2
        highest = float(surface.height_m[0, -1])
        for x in (edge, edge - surface.relief.pitch_m[0] / 4):
            assert at(touch, x, 0.0, highest - 1 / 512) == (0.0, 0.0, 1.0)

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

    def test_materials_set_the_stiffness_of_their_cell_and_labels_alone_leave_that_of_the_option(self):
        labels = np.zeros((4, 8), np.int32)
        labels[:, 4:], labels[3, :] = 1, 2
        materials = material("soft", 128.0), material("hard", 1024.0), material("middling", 256.0)
        surface = HapticSurface.from_heights(np.full((4, 8), UP_M), WIDTH_M, labels, materials)
        touch = PenaltyGradient().touch(surface)
        for x, y, stiffness in ((-1e-9, 0, 128), (1e-9, 0, 1024), (-0.03, -0.015, 256), (0.03125, -0.015625, 256)):
            assert at(touch, x, y, 0.0).z == stiffness * UP_M
        surface = HapticSurface.from_heights(np.full((2, 2), UP_M), WIDTH_M, np.zeros((2, 2), np.int32))
        assert at(PenaltyGradient().touch(surface), 0.0, 0.0, 0.0).z == 800 * UP_M

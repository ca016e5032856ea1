"""The default force law would push the wrong way or too hard: against exact nearest points."""

from dataclasses import replace

import numpy as np
import pytest

from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import Force, HapticState, HapticSurface, Material, Relief
from tangible_core.plugins.interfaces import Touch
from tangible_core.testing.synthetic.scenes import KnownSurface, plane, ramp, sphere_cap, waves
from tangible_render.proxy import Proxy

RNG = np.random.default_rng(23)
K = 800.0
LEVEL = plane(0.01).surface


def at(touch: Touch, x: float, y: float, z: float, velocity=(0.0, 0.0, 0.0)) -> Force:
    return touch.force(HapticState((float(x), float(y), float(z)), velocity))


def stroke(
    known: KnownSurface, seconds: float, depth_m: float, speed: float = 1.0, wide_m: float = 0.034
) -> np.ndarray:
    """Return a wandering hand at 1 kHz at this depth below the surface; about 82 mm/s at most."""
    t = np.arange(int(1000 * seconds)) / 1000 * speed
    x, y = wide_m * np.sin(2 * np.pi * 0.31 * t), wide_m * np.sin(2 * np.pi * 0.23 * t + 0.7)
    return np.array([known.at(*place, depth_m) for place in np.column_stack([x, y]).tolist()])


def nearest(known: KnownSurface, path: np.ndarray) -> np.ndarray:
    """Return the exact nearest points of waves, by Newton's method on the formula, along the path."""
    p, found = path[0, :2].copy(), []
    for hand in path:
        for _ in range(100):
            step = _newton(known, p, hand)
            p += step
            if np.abs(step).max() < 1e-15:
                break
        found.append([*p, known.height_m(*p)])
    return np.array(found)


def _newton(known: KnownSurface, p: np.ndarray, hand: np.ndarray, eps: float = 1e-6) -> np.ndarray:
    slope = np.array(known.slope(*p))
    hessian = np.array([np.subtract(known.slope(*(p + d)), known.slope(*(p - d))) for d in np.eye(2) * eps]) / (2 * eps)
    away = hand - [*p, known.height_m(*p)]
    matrix = np.eye(2) + np.outer(slope, slope) - away[2] * hessian
    return np.linalg.solve(matrix, away[:2] + away[2] * slope)


class TestAccuracy:
    def test_force_on_a_plane_is_a_spring_along_the_normal(self):
        known = ramp()
        for x, y in RNG.uniform(-0.035, 0.035, (20, 2)):
            force = at(Proxy().touch(known.surface), *known.at(x, y, 0.001))
            normal = known.normal(x, y)
            assert np.allclose(force, K * 0.001 * normal[2] * normal, rtol=1e-4, atol=1e-5)

    def test_force_on_a_sphere_points_from_the_centre(self):
        known = sphere_cap(shape=(256, 256))
        for x, y in RNG.uniform(-0.03, 0.03, (20, 2)):
            hand = np.add(known.at(x, y, 0.002), [0, 0, 0.08])  # from the sphere's centre
            out = hand / np.linalg.norm(hand)
            force = np.array(at(Proxy().touch(known.surface), *known.at(x, y, 0.002)))
            assert np.allclose(force, K * (0.1 - np.linalg.norm(hand)) * out, rtol=1e-5, atol=1e-5)

    @pytest.mark.parametrize("shape", [(40, 100), (100, 40)])
    @pytest.mark.parametrize("extent_m", [(0.08, 0.03), (0.03, 0.08)])
    def test_proxy_on_an_oblong_surface_is_the_nearest_point(
        self, shape: tuple[int, int], extent_m: tuple[float, float]
    ):
        width, length = extent_m
        rows, columns = np.indices(shape) + 0.5
        x, y = (columns / shape[1] - 0.5) * width, (0.5 - rows / shape[0]) * length
        a, b, c = 0.4, -0.7, 0.05
        surface = HapticSurface(Relief((c + a * x + b * y).astype(np.float32), extent_m))
        clamped = 0
        inside = RNG.uniform(-0.5, 0.5, (60, 2)) * extent_m
        inside[20:, 0] = -width / 2 + RNG.uniform(0, 0.001, 40)
        inside[40:, 1] = length / 2 - RNG.uniform(0, 0.001, 20)
        for qx, qy in inside.tolist():
            qz = c + a * qx + b * qy - 0.003
            px, py = (np.array((qx, qy)) + np.array((a, b)) * -0.003 / (1 + a * a + b * b)).tolist()
            if px < -width / 2:
                px, clamped = -width / 2, clamped + 1
                py = qy + b * (qz - c - a * px - b * qy) / (1 + b * b)
            if py > length / 2:
                py, clamped = length / 2, clamped + 1
                px = max(qx + a * (qz - c - b * py - a * qx) / (1 + a * a), -width / 2)
            path = np.tile((qx, qy, qz), (40, 1))  # it goes 0.25 mm a tick at most
            force = Proxy().touch(surface).path(path)[-1]
            assert np.allclose(force, K * np.array((px - qx, py - qy, c + a * px + b * py - qz)), rtol=0, atol=1e-4)
        assert clamped > 20

    @pytest.mark.parametrize("depth_m", [0.0002, 0.0008])
    def test_proxy_on_waves_at_the_speed_of_a_hand_is_exact(self, depth_m: float):
        known = waves()
        path = stroke(known, 4, depth_m, speed=0.99)
        assert 0.075 < np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1).max() * 1000 < 0.082
        force, exact = Proxy().touch(known.surface).path(path) / K, nearest(known, path) - path
        off_m = np.linalg.norm(force - exact, axis=1)
        sines = np.linalg.norm(np.cross(force, exact), axis=1) / np.linalg.norm(force, axis=1)
        assert np.percentile(off_m, 99) <= 1e-8
        assert np.percentile(np.degrees(sines / np.linalg.norm(exact, axis=1)), 99) <= 1e-3


class TestMaterials:
    def test_spring_is_that_of_the_material_at_the_proxy(self):
        labels = np.zeros((64, 64), np.int32)
        labels[:, 32:] = 1
        hard, soft = (Material(name, k, 0.0, 50.0, 50.0) for name, k in (("hard", 1200.0), ("soft", 300.0)))
        surface = HapticSurface.from_heights(np.full((64, 64), 0.01), 0.08, labels, (hard, soft))
        touch = Proxy().touch(surface)
        at(touch, -0.001, 0.0, 0.009)
        assert at(touch, 0.001, 0.0, 0.009) == pytest.approx((-1200 * 0.002, 0, 1200 * 0.001), abs=1e-5)

    def test_touch_reports_the_greatest_stiffness(self):
        soft = Material("soft", 300.0, 0.0, 0.0, 0.0)
        labels = np.arange(4096, dtype=np.int32).reshape(64, 64) % 3
        for other in ({}, {"damping_n_s_per_m": 1.0}, {"roughness_m": 1e-4}):
            materials = tuple(replace(soft, stiffness_n_per_m=k, **other) for k in (500.0, 1500.0, 900.0))
            touch = Proxy().touch(HapticSurface.from_heights(np.full((64, 64), 0.01), 0.08, labels, materials))
            assert isinstance(touch, CompiledTouch)
            assert touch.stiffness_n_per_m == 1500.0
        plain = Proxy(stiffness_n_per_m=700.0).touch(LEVEL)
        assert isinstance(plain, CompiledTouch)
        assert plain.stiffness_n_per_m == 700.0

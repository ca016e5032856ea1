"""The proxy against exact nearest points, and its ways in and out."""

import numpy as np
import pytest

from tangible_core.data import NO_FORCE, Force, HapticState, HapticSurface
from tangible_core.interfaces import Touch
from tangible_core.testing.reliefs import cliff, cone, waves
from tangible_core.testing.scenes import KnownSurface, plane, ramp, sphere_cap
from tangible_render.proxy import Proxy

RNG = np.random.default_rng(23)
K = 800.0
LEVEL = plane(0.01).surface


def at(touch: Touch, x: float, y: float, z: float, velocity=(0.0, 0.0, 0.0)) -> Force:
    return touch.force(HapticState((float(x), float(y), float(z)), velocity))


def stroke(
    known: KnownSurface, seconds: float, depth_m: float, speed: float = 1.0, wide_m: float = 0.034
) -> np.ndarray:
    """A wandering hand at 1 kHz, this deep under the surface; about 82 mm/s at most."""
    t = np.arange(int(1000 * seconds)) / 1000 * speed
    x, y = wide_m * np.sin(2 * np.pi * 0.31 * t), wide_m * np.sin(2 * np.pi * 0.23 * t + 0.7)
    return np.array([known.at(*place, depth_m) for place in np.column_stack([x, y]).tolist()])


def nearest(known: KnownSurface, path: np.ndarray) -> np.ndarray:
    """The exact nearest points of waves, by Newton's method on the formula itself, followed along the path."""
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
    def test_on_a_plane_it_is_a_spring_along_the_normal(self):
        known = ramp()
        for x, y in RNG.uniform(-0.035, 0.035, (20, 2)):
            force = at(Proxy().touch(known.surface), *known.at(x, y, 0.001))
            normal = known.normal(x, y)
            assert np.allclose(force, K * 0.001 * normal[2] * normal, rtol=1e-4, atol=1e-5)

    def test_on_a_sphere_it_points_from_the_centre(self):
        known = sphere_cap(shape=(256, 256))
        for x, y in RNG.uniform(-0.03, 0.03, (20, 2)):
            hand = np.add(known.at(x, y, 0.002), [0, 0, 0.08])  # from the sphere's centre
            out = hand / np.linalg.norm(hand)
            force = np.array(at(Proxy().touch(known.surface), *known.at(x, y, 0.002)))
            assert np.allclose(force, K * (0.1 - np.linalg.norm(hand)) * out, rtol=1e-5, atol=1e-5)

    @pytest.mark.parametrize("depth_m", [0.0002, 0.0008])
    def test_on_waves_at_the_speed_of_a_hand(self, depth_m: float):
        known = waves()
        path = stroke(known, 4, depth_m, speed=0.99)
        assert 0.075 < np.linalg.norm(np.diff(path[:, :2], axis=0), axis=1).max() * 1000 < 0.082
        force, exact = Proxy().touch(known.surface).path(path) / K, nearest(known, path) - path
        off_m = np.linalg.norm(force - exact, axis=1)
        sines = np.linalg.norm(np.cross(force, exact), axis=1) / np.linalg.norm(force, axis=1)
        assert np.percentile(off_m, 99) <= 1e-8
        assert np.percentile(np.degrees(sines / np.linalg.norm(exact, axis=1)), 99) <= 1e-3

    def test_the_track_holds_at_half_a_metre_a_second(self):
        known = waves()
        path = stroke(known, 2, 0.0005, speed=4.4)
        assert np.linalg.norm(np.diff(path, axis=0), axis=1).max() > 0.0005
        off_m = np.linalg.norm(Proxy().touch(known.surface).path(path) / K + path - nearest(known, path), axis=1)
        assert off_m.max() < 1e-7

    def test_on_a_cone_the_size_and_direction_are_those_of_its_side(self):
        known = cone(slope=0.5)
        for x, y in ((0.02, 0.01), (-0.015, 0.02), (0.0, -0.025)):
            force = np.array(at(Proxy().touch(known.surface), *known.at(x, y, 0.001)))
            assert np.allclose(force, K * 0.001 * known.normal(x, y)[2] * known.normal(x, y), rtol=2e-3, atol=1e-4)


class TestWays:
    def test_it_starts_where_the_hand_came_through(self):
        """Sideways into a cliff half way up: held back along x, not lifted to the top."""
        touch = Proxy().touch(cliff(shape=(512, 512)).surface)
        x = np.linspace(-0.003, 0.0005, 50)
        force = touch.path(np.column_stack([x, np.zeros(50), np.full(50, 0.002)]))
        assert np.allclose(force[-1], [-K * 0.0005, 0, 0], atol=0.12) and abs(force[-1, 0]) > 0.25

    def test_a_hand_that_is_put_down_deep_is_taken_straight_up(self):
        touch = Proxy().touch(LEVEL)
        assert at(touch, 0.03, 0.03, -0.01) == pytest.approx((0, 0, K * 0.02), rel=1e-5)
        assert at(touch, -0.03, 0.01, 0.005) == pytest.approx((0, 0, K * 0.005), rel=1e-5)

    def test_a_hand_from_beside_the_block_is_held_off_and_let_up_over_the_rim(self):
        touch = Proxy().touch(LEVEL)
        assert at(touch, 0.041, 0.002, 0.004) == NO_FORCE
        assert at(touch, 0.039, 0.003, 0.004) == pytest.approx((K * 0.001, 0, 0), abs=1e-9)
        assert at(touch, 0.038, 0.004, 0.007) == pytest.approx((K * 0.002, 0, 0), abs=1e-9)
        assert at(touch, 0.038, 0.004, 0.0105) == NO_FORCE
        assert at(touch, 0.038, 0.004, 0.0095) == pytest.approx((0, 0, K * 0.0005), abs=1e-4)

    def test_a_wall_does_not_throw_the_hand_out_at_its_far_side(self):
        heights = np.zeros((256, 256))
        heights[:, 100:116] = 0.01  # 5 mm thick
        touch = Proxy().touch(HapticSurface.from_heights(heights))
        x = np.linspace(-0.012, -0.005, 200)
        force = touch.path(np.column_stack([x, np.zeros(200), np.full(200, 0.005)]))
        assert (force[:, 0] <= 1e-9).all() and force[-1, 0] < -1.0

    def test_a_proxy_left_far_behind_is_let_go(self):
        heights = np.zeros((256, 256))
        heights[:, 60:] = 0.006
        touch = Proxy().touch(HapticSurface.from_heights(heights))
        x = np.linspace(-0.03, 0.03, 600)
        force = touch.path(np.column_stack([x, np.zeros(600), np.full(600, 0.004)]))
        assert np.linalg.norm(force, axis=1).max() < K * 0.0201
        assert force[-1] == pytest.approx([0, 0, K * 0.002], abs=1e-3)

    def test_so_is_one_at_the_side_of_the_block(self):
        x = np.linspace(0.041, -0.03, 1000)
        force = Proxy().touch(LEVEL).path(np.column_stack([x, np.zeros(1000), np.full(1000, 0.004)]))
        assert np.linalg.norm(force, axis=1).max() < K * 0.0201
        assert force[-1] == pytest.approx([0, 0, K * 0.006], abs=1e-6)

    def test_a_lost_state_ends_the_contact(self):
        touch = Proxy(static_friction=5.0, dynamic_friction=5.0).touch(LEVEL)
        at(touch, 0.0, 0.0, 0.009)
        assert at(touch, 0.001, 0.0, 0.009).x < -0.5
        assert at(touch, np.nan, 0.0, 0.009) == NO_FORCE
        assert at(touch, 0.002, 0.0, 0.009).x == pytest.approx(0, abs=1e-9)

"""The default force law would push the wrong way or too hard, kick a hand, or get stuck on rough ground."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rough_surfaces import rough_surfaces
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import NO_FORCE, Force, HapticState, HapticSurface, Material, Relief
from tangible_core.plugins.interfaces import Touch
from tangible_core.testing.synthetic.scenes import KnownSurface, plane, ramp, sphere_cap, waves
from tangible_render.proxy import Proxy
from tangible_render.surface import spline
from tangible_render.surface.coefficients import spline_surface

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
    def test_force_on_plane_and_sphere_is_a_spring_along_the_normal(self):
        known = ramp()
        for x, y in RNG.uniform(-0.035, 0.035, (20, 2)):
            force = at(Proxy().touch(known.surface), *known.at(x, y, 0.001))
            normal = known.normal(x, y)
            assert np.allclose(force, K * 0.001 * normal[2] * normal, rtol=1e-4, atol=1e-5)
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
    def test_stiffness_is_that_of_materials_at_the_proxy_and_the_greatest(self):
        labels = np.zeros((64, 64), np.int32)
        labels[:, 32:] = 1
        hard, soft = (Material(name, k, 0.0, 50.0, 50.0) for name, k in (("hard", 1200.0), ("soft", 300.0)))
        surface = HapticSurface.from_heights(np.full((64, 64), 0.01), 0.08, labels, (hard, soft))
        touch = Proxy().touch(surface)
        at(touch, -0.001, 0.0, 0.009)
        assert at(touch, 0.001, 0.0, 0.009) == pytest.approx((-1200 * 0.002, 0, 1200 * 0.001), abs=1e-5)
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


GLUE = Proxy(static_friction=50.0, dynamic_friction=50.0)
"""A friction that holds the proxy in its first place, so that the force shows that place."""


class TestWays:
    @pytest.mark.parametrize("slope", [(0.0, 0.0), (0.5, 0.0), (-1.5, 0.8)])
    def test_contact_starts_within_a_64th_of_the_crossing(self, slope: tuple[float, float]):
        """The start is on the hand's side, so that no energy is stored that was not given."""
        known, starts = ramp(slope, 0.1), []
        for _ in range(100):
            x, y, dx, dy, dz = RNG.uniform(-1, 1, 5) * (0.02, 0.02, 0.0028, 0.0028, 0.0028)
            outside = np.array(known.at(x, y, -abs(dz) - 1e-6))
            inside = np.array(known.at(x + dx, y + dy, 0.002))
            if np.linalg.norm(inside - outside) > 0.0049:
                continue
            touch = GLUE.touch(known.surface)
            assert at(touch, *outside) == NO_FORCE
            way = (inside - outside)[:2]
            proxy = inside[:2] + np.array(at(touch, *inside))[:2] / K
            assert (proxy - outside[:2]) @ (-way[1], way[0]) == pytest.approx(0, abs=1e-9)
            over = abs(dz) + 1e-6
            crosses, starts_at = over / (over + 0.002), way @ (proxy - outside[:2]) / (way @ way)
            starts.append(crosses - starts_at)
        assert min(starts) >= -1e-4 and max(starts) <= 1 / 64 + 1e-4
        assert len(starts) > 20 and max(starts) > 1 / 128  # it is searched for in halves

    def test_hand_from_the_side_is_pushed_back_to_its_own_side(self):
        touch = Proxy().touch(LEVEL)
        assert at(touch, 0.041, 0.002, 0.004) == NO_FORCE
        assert at(touch, 0.039, 0.003, 0.004) == pytest.approx((K * 0.001, 0, 0), abs=1e-9)
        assert at(touch, 0.038, 0.004, 0.007) == pytest.approx((K * 0.002, 0, 0), abs=1e-9)
        assert at(touch, 0.038, 0.004, 0.0105) == NO_FORCE
        assert at(touch, 0.038, 0.004, 0.0095) == pytest.approx((0, 0, K * 0.0005), abs=1e-4)
        heights = np.zeros((256, 256))
        heights[:, 100:116] = 0.01  # 5 mm thick
        touch = Proxy().touch(HapticSurface.from_heights(heights))
        x = np.linspace(-0.012, -0.005, 200)
        force = touch.path(np.column_stack([x, np.zeros(200), np.full(200, 0.005)]))
        assert (force[:, 0] <= 1e-9).all() and force[-1, 0] < -1.0

    def test_proxy_below_a_farther_surface_is_not_released(self):
        """At a depth of 24 mm the proxy is released beyond that distance, not beyond 20 mm."""
        z, x = np.linspace(0.0099, -0.014, 30), np.append(np.linspace(0, 0.0238, 30), 0.0242)
        path = np.vstack([np.column_stack([0 * z, 0 * z, z]), np.column_stack([x, 0 * x, np.full(31, -0.014)])])
        force = GLUE.touch(LEVEL).path(path)
        assert force[-2] == pytest.approx((-K * 0.0238, 0, K * 0.024), abs=1e-5)
        assert force[-1] == pytest.approx((0, 0, K * 0.024), abs=1e-5)

    @pytest.mark.parametrize("axis", range(3))
    def test_hand_moving_5_mm_in_a_tick_starts_anew(self, axis: int):
        for leap_m, held in ((0.0049, True), (0.0051, False)):
            hand, touch = np.array((0.001, 0.001, 0.0)), GLUE.touch(LEVEL)
            at(touch, 0.0, 0.0, 0.0)
            assert at(touch, *hand) == pytest.approx((-K * 0.001, -K * 0.001, K * 0.01), abs=1e-5)
            hand[axis] -= leap_m
            x, y, z = hand if held else (0.0, 0.0, hand[2])
            assert at(touch, *hand) == pytest.approx((-K * x, -K * y, K * (0.01 - z)), abs=1e-5)

    def test_proxy_moves_two_millimetres_a_tick_at_most(self):
        """There are eight steps of a quarter: after a hand that moved by 4.5 mm it arrives in the third tick."""
        touch = Proxy(damping_n_s_per_m=1e-300).touch(LEVEL)
        at(touch, 0.0, 0.0, 0.009)
        for behind_m in (0.0025, 0.0005, 0.0):
            assert at(touch, 0.0027, 0.0036, 0.009) == pytest.approx(
                (-K * behind_m * 0.6, -K * behind_m * 0.8, K * 0.001), abs=1e-6
            )

    @pytest.mark.parametrize(
        "other", [{}, {"damping_n_s_per_m": 1.0}, {"roughness_m": 1e-4}], ids=["spring", "damped", "textured"]
    )
    def test_force_not_finite_is_zero(self, other: dict[str, float]):
        rock = replace(Material("rock", 1e308, 0.0, 0.0, 0.0), **other)
        surface = HapticSurface.from_heights(np.full((8, 8), 0.01), 0.08, np.zeros((8, 8), np.int32), (rock,))
        touch = Proxy().touch(surface)
        assert at(touch, 0.0, 0.0, 0.009).z > 1e300
        assert at(touch, 0.0, 0.0, -1000.0) == NO_FORCE
        assert at(touch, 0.0, 0.0, 0.009).z > 1e300

    def test_proxy_without_contact_is_absent(self):
        for renderer in (Proxy(), Proxy(static_friction=0.5, dynamic_friction=0.5)):
            touch = renderer.touch(LEVEL)
            assert isinstance(touch, CompiledTouch)
            at(touch, 0.01, 0.02, 0.009)
            assert touch.memory[:3] == pytest.approx((0.01, 0.02, 0.01))
            for elsewhere in ((0.01, 0.02, 0.011), (0.5, 0.02, 0.009), (np.nan, 0.02, 0.009)):
                at(touch, *elsewhere)
                assert np.isnan(touch.memory[2])
                at(touch, 0.01, 0.02, 0.009)


MAPS = rough_surfaces()


@pytest.fixture(params=MAPS)
def rough(request) -> HapticSurface:
    return MAPS[request.param]


class TestStress:
    def test_proxy_at_rest_has_the_hand_along_its_normal(self, rough: HapticSurface):
        coefficients, *_, across, down = spline_surface(rough, "auto")
        for x, y in RNG.uniform(-0.03, 0.03, (60, 2)):
            hand = np.array([x, y, spline.height(coefficients, across, down, x, y) - 0.003])
            pull = Proxy().touch(rough).path(np.tile(hand, (200, 1)))[-1] / K
            height, slope_x, slope_y = spline.slope(coefficients, across, down, *(hand + pull)[:2])
            assert hand[2] + pull[2] == pytest.approx(height, abs=1e-8)
            normal = np.array([-slope_x, -slope_y, 1]) / np.sqrt(1 + slope_x**2 + slope_y**2)
            assert np.linalg.norm(np.cross(pull, normal)) <= 1e-6 * np.linalg.norm(pull)


class TestShortCuts:
    """Each short cut gives what the long way gives."""

    def test_spring_alone_and_equal_materials_are_the_general_kernel(self, rough: HapticSurface):
        """Damping without velocity has no force, which lets the general kernel run."""
        turn = np.linspace(0, 6, 3000)
        path = np.column_stack([0.03 * np.sin(3 * turn), 0.03 * np.cos(2 * turn), 0.002 * np.sin(9 * turn)])
        states = [HapticState(tuple(place)) for place in path.tolist()]
        general, spring = (Proxy(damping_n_s_per_m=b).touch(rough) for b in (1.0, 0.0))
        assert general.tick is not spring.tick
        assert np.allclose([general.force(s) for s in states], [spring.force(s) for s in states], rtol=0, atol=1e-9)
        labels = np.arange(4096, dtype=np.int32).reshape(64, 64) % 3
        alike = tuple(Material(name, 500.0, 0.0, 0.0, 0.0) for name in "abc")
        one = Proxy(stiffness_n_per_m=500.0).touch(plane().surface)
        three = Proxy().touch(HapticSurface.from_heights(np.full((64, 64), 0.01), 0.08, labels, alike))
        assert three.tick is one.tick
        assert three.force(HapticState((0.01, 0.02, 0.004))) == pytest.approx(
            one.force(HapticState((0.01, 0.02, 0.004)))
        )

    @given(st.floats(-0.04, 0.04), st.floats(-0.04, 0.04), st.floats(-0.001, 0.011))
    def test_hand_above_the_surface_is_in_free_air(self, x: float, y: float, z: float):
        surface = MAPS["spikes"]
        coefficients, _, _, across, down = spline_surface(surface, "auto")
        assert (Proxy().touch(surface).force(HapticState((x, y, z))) == NO_FORCE) == (
            z >= spline.height(coefficients, across, down, x, y)
        )

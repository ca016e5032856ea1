"""The proxy: against exact nearest points, its ways in and out, its energy, its friction, and what is left out."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.data import NO_FORCE, Force, HapticState, HapticSurface, Material
from tangible_core.interfaces import Touch
from tangible_core.testing.reliefs import cliff, cone, waves
from tangible_core.testing.rough import rough_surfaces
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

    def test_a_lost_state_ends_the_contact(self):
        touch = Proxy(static_friction=5.0, dynamic_friction=5.0).touch(LEVEL)
        at(touch, 0.0, 0.0, 0.009)
        assert at(touch, 0.001, 0.0, 0.009).x < -0.5
        assert at(touch, np.nan, 0.0, 0.009) == NO_FORCE
        assert at(touch, 0.002, 0.0, 0.009).x == pytest.approx(0, abs=1e-9)


MAPS = rough_surfaces()


@pytest.fixture(params=MAPS)
def rough(request) -> HapticSurface:
    return MAPS[request.param]


class TestStress:
    @pytest.mark.parametrize("depth_m", [0.0, 0.004])
    def test_no_closed_path_gains_energy(self, rough: HapticSurface, depth_m: float):
        """Work of the device on the hand over the second of two turns, by the trapezoidal rule."""
        turn = np.arange(20000) / 20000
        x, y = 0.032 * np.sin(2 * np.pi * 5 * turn), 0.041 * np.sin(2 * np.pi * 3 * turn + 0.4)  # over the borders too
        loop = np.column_stack([x, y, 0.002 + 0.001 * np.sin(2 * np.pi * 7 * turn) - depth_m])
        force = Proxy().touch(rough).path(np.vstack([loop, loop, loop[:1]]))[20000:]
        parts = (force[1:] + force[:-1]) / 2 * np.diff(np.vstack([loop, loop[:1]]), axis=0)
        assert parts.sum() <= 1e-5 * np.abs(parts).sum()

    @pytest.mark.parametrize(
        "renderer", [Proxy(), Proxy(static_friction=0.6, dynamic_friction=0.4, damping_n_s_per_m=1)]
    )
    def test_a_wild_hand_is_never_pushed_wildly(self, rough: HapticSurface, renderer: Proxy):
        """Walks of 0.5 m/s and more with leaps, 15000 ticks a map: finite, and no longer than what was said."""
        random = np.random.default_rng(9)
        steps = random.normal(0, 1, (15000, 3)) * random.choice([1e-5, 2e-4, 1e-3], (15000, 1))
        path = np.cumsum(steps, axis=0) * [1, 1, 0.05] + [0, 0, 0.002]
        path[:, :2] = (path[:, :2] + 0.042) % 0.084 - 0.042  # leaps at the borders
        leaps = random.integers(0, 15000, 100)
        path[leaps] = random.uniform(-0.04, 0.04, (100, 3)) * [1, 1, 0.2]
        force = renderer.touch(rough).path(path)
        assert np.isfinite(force).all()
        deepest = max(0.02, float(rough.height_m.max()) * 2 - path[:, 2].min())
        speed = np.linalg.norm(np.diff(path, axis=0), axis=1).max() / 0.001
        most = K * (deepest + 0.005) + renderer.damping_n_s_per_m * min(speed, 100)
        assert np.linalg.norm(force, axis=1).max() <= most

    def test_a_hand_at_rest_sees_its_proxy_only_come_nearer(self, rough: HapticSurface):
        for x, y in RNG.uniform(-0.038, 0.038, (10, 2)):
            rest = Proxy().touch(rough).path(np.tile([x, y, -0.001], (60, 1)))
            size = np.linalg.norm(rest, axis=1)
            assert (np.diff(size) <= 1e-6).all()  # of newtons: the last step follows a Taylor series
            assert np.abs(rest[-1] - rest[-2]).max() < 1e-3


class TestFriction:
    def test_it_sticks_up_to_the_static_cone_and_slides_on_the_dynamic_one(self):
        touch = Proxy(static_friction=0.8, dynamic_friction=0.5).touch(LEVEL)
        x = np.arange(0, 0.004, 1e-6)
        force = touch.path(np.column_stack([x, np.zeros_like(x), np.full_like(x, 0.009)]))
        ratio = -force[:, 0] / force[:, 2]
        slip = int(ratio.argmax())
        assert np.allclose(-force[: slip + 1, 0], K * x[: slip + 1], atol=1e-6)  # held: a spring along x
        assert ratio[slip] == pytest.approx(0.8, abs=2e-3)
        assert np.allclose(ratio[slip + 1 :], 0.5, atol=2e-3)

    def test_it_sticks_again_when_the_hand_turns_back(self):
        touch = Proxy(static_friction=0.8, dynamic_friction=0.5).touch(LEVEL)
        there, back = np.linspace(0, 0.004, 400), np.linspace(0.004, 0.002, 400)
        x = np.concatenate([there, back])
        force = touch.path(np.column_stack([x, np.zeros(800), np.full(800, 0.009)]))
        assert force[399, 0] == pytest.approx(-0.4, abs=1e-3)
        assert force[:, 0].max() == pytest.approx(0.8 * 0.8, abs=0.01)

    def test_on_a_slope_it_rests_if_the_cone_is_wider_than_the_slope(self):
        known = ramp((0.3, 0.0), 0.02)
        hand = known.at(0.001, 0.002, 0.001)
        held = at(Proxy(static_friction=0.31, dynamic_friction=0.31).touch(known.surface), *hand)
        assert held == pytest.approx((0, 0, K * 0.001), abs=1e-6)
        slid = np.array(at(Proxy(static_friction=0.2, dynamic_friction=0.1).touch(known.surface), *hand))
        normal = known.normal(0, 0)
        along = np.linalg.norm(slid - (slid @ normal) * normal)
        assert along == pytest.approx(0.1 * (slid @ normal), rel=1e-3)

    def test_on_a_curved_surface_the_force_stays_on_the_cone(self):
        known = sphere_cap(shape=(256, 256))
        path = stroke(known, 2, 0.002, wide_m=0.025)
        force = Proxy(static_friction=0.4, dynamic_friction=0.3).touch(known.surface).path(path)
        out = force / K + path + [0, 0, 0.08]
        normal = out / np.linalg.norm(out, axis=1, keepdims=True)
        push = np.sum(force * normal, axis=1)
        along = np.linalg.norm(force - push[:, None] * normal, axis=1)
        assert np.percentile(np.abs(along[200:] / push[200:] - 0.3), 95) < 1e-3

    def test_materials_bring_their_own_stiffness_and_friction(self):
        labels = np.zeros((64, 64), np.int32)
        labels[:, 32:] = 1
        materials = Material("ice", 1200.0, 0, 0.0, 0.0), Material("felt", 300.0, 0, 0.9, 0.7)
        surface = HapticSurface.from_heights(np.full((64, 64), 0.01), 0.08, labels, materials)
        x = np.linspace(0, 0.004, 400)
        for start, stiffness, friction in ((-0.03, 1200.0, 0.0), (0.01, 300.0, 0.7)):
            path = np.column_stack([start + x, np.zeros(400), np.full(400, 0.009)])
            last = Proxy().touch(surface).path(path)[-1]
            assert last == pytest.approx([-friction * stiffness * 0.001, 0, stiffness * 0.001], abs=1e-3)
            off = Proxy(friction=False).touch(surface).path(path)[-1]
            assert off == pytest.approx([0, 0, stiffness * 0.001], abs=1e-6)

    def test_damping_acts_along_the_normal_and_never_pulls(self):
        known = ramp((0.5, 0.0), 0.03)
        normal, along = known.normal(0, 0), np.array([1, 0, 0.5])
        renderer = Proxy(damping_n_s_per_m=4.0)
        hand = known.at(0, 0, 0.001)
        spring = K * 0.001 * normal[2]
        for speed in (-0.25, 0.0, 0.125, 100.0):
            force = at(renderer.touch(known.surface), *hand, tuple(speed * normal + 0.5 * along))
            assert np.allclose(force, max(0.0, spring - 4 * speed) * normal, rtol=1e-4, atol=1e-4)


class TestWhatIsLeftOut:
    """Each short cut gives what the long way gives."""

    def test_the_spring_alone_is_the_general_law(self, rough: HapticSurface):
        """Damping without velocity is nothing, so that the general law can be made to run."""
        turn = np.linspace(0, 6, 3000)
        path = np.column_stack([0.03 * np.sin(3 * turn), 0.03 * np.cos(2 * turn), 0.002 * np.sin(9 * turn)])
        states = [HapticState(tuple(place)) for place in path.tolist()]
        general, spring = (Proxy(damping_n_s_per_m=b).touch(rough) for b in (1.0, 0.0))
        assert general._tick is not spring._tick
        assert np.allclose([general.force(s) for s in states], [spring.force(s) for s in states], rtol=0, atol=1e-9)

    def test_materials_that_are_alike_are_one(self):
        labels = np.arange(4096, dtype=np.int32).reshape(64, 64) % 3
        alike = tuple(Material(name, 500.0, 0.0, 0.0, 0.0) for name in "abc")
        one = Proxy(stiffness_n_per_m=500.0).touch(LEVEL)
        three = Proxy().touch(HapticSurface.from_heights(np.full((64, 64), 0.01), 0.08, labels, alike))
        assert three._tick is one._tick
        assert at(three, 0.01, 0.02, 0.004) == pytest.approx(at(one, 0.01, 0.02, 0.004))

    @given(st.floats(-0.04, 0.04), st.floats(-0.04, 0.04), st.floats(-0.001, 0.011))
    def test_free_air_is_where_the_hand_is_above_the_surface(self, x: float, y: float, z: float):
        from tangible_render import spline
        from tangible_render.coefficients import spline_surface

        surface = MAPS["spikes"]
        coefficients, _, _, across, down = spline_surface(surface, "auto")
        assert (at(Proxy().touch(surface), x, y, z) == NO_FORCE) == (
            z >= spline.height(coefficients, across, down, x, y)
        )

    def test_level_ground_is_level_in_the_tiles_as_in_the_spline(self):
        heights = np.full((256, 256), 0.004)
        heights[100:120, 100:120] = 0.009
        path = np.column_stack([np.linspace(-0.039, 0.039, 3000), np.linspace(0.03, -0.02, 3000), np.full(3000, 0.003)])
        surface = HapticSurface.from_heights(heights)
        general, quick = Proxy(damping_n_s_per_m=1e-300).touch(surface), Proxy().touch(surface)
        assert general._tick is not quick._tick
        assert np.allclose(general.path(path), quick.path(path), rtol=0, atol=1e-7)


def test_friction_that_grows_when_it_slides_is_refused():
    with pytest.raises(ValueError, match="slide more easily"):
        Proxy(static_friction=0.2, dynamic_friction=0.3)

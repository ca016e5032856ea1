"""The proxy on surfaces that break careless force laws: energy, bounds, and short cuts against the long way."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rough_surfaces import rough_surfaces
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import NO_FORCE, HapticState, HapticSurface, Material
from tangible_core.testing.synthetic.scenes import plane
from tangible_render.proxy import Proxy
from tangible_render.surface import spline
from tangible_render.surface.coefficients import spline_surface

RNG = np.random.default_rng(23)
K = 800.0
MAPS = rough_surfaces()


@pytest.fixture(params=MAPS)
def rough(request) -> HapticSurface:
    return MAPS[request.param]


class TestStress:
    @pytest.mark.parametrize("depth_m", [0.0, 0.004])
    def test_closed_paths_gain_no_energy(self, rough: HapticSurface, depth_m: float):
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
    def test_force_on_a_wild_hand_is_bounded(self, rough: HapticSurface, renderer: Proxy):
        """Walks of 0.5 m/s and more with leaps, 15000 ticks a map, have finite forces within their bound."""
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

    def test_proxy_of_a_hand_at_rest_only_comes_nearer(self, rough: HapticSurface):
        for x, y in RNG.uniform(-0.038, 0.038, (10, 2)):
            rest = Proxy().touch(rough).path(np.tile([x, y, -0.001], (60, 1)))
            size = np.linalg.norm(rest, axis=1)
            assert (np.diff(size) <= 1e-6).all()  # of newtons: the last step follows a Taylor series
            assert np.abs(rest[-1] - rest[-2]).max() < 1e-3

    def test_proxy_at_rest_has_the_hand_along_its_normal(self, rough: HapticSurface):
        """The search gets stuck on no rough ground."""
        coefficients, *_, across, down = spline_surface(rough, "auto")
        for x, y in RNG.uniform(-0.03, 0.03, (60, 2)):
            hand = np.array([x, y, spline.height(coefficients, across, down, x, y) - 0.003])
            pull = Proxy().touch(rough).path(np.tile(hand, (200, 1)))[-1] / K
            height, slope_x, slope_y = spline.slope(coefficients, across, down, *(hand + pull)[:2])
            assert hand[2] + pull[2] == pytest.approx(height, abs=1e-8)
            normal = np.array([-slope_x, -slope_y, 1]) / np.sqrt(1 + slope_x**2 + slope_y**2)
            assert np.linalg.norm(np.cross(pull, normal)) <= 1e-6 * np.linalg.norm(pull)

    @pytest.mark.parametrize(("step_m", "ticks"), [(3e-4, 4000), (1e-3, 3000)])
    def test_proxy_in_each_tick_comes_nearer(self, rough: HapticSurface, step_m: float, ticks: int):
        """The work of the moving hand is the only energy."""
        random = np.random.default_rng(4)
        path = np.cumsum(random.normal(0, step_m, (ticks, 3)) * [1, 1, 0.1], axis=0) + np.array([0, 0, -0.002])
        path[:, :2] = (path[:, :2] + 0.03) % 0.06 - 0.03
        touch = Proxy().touch(rough)
        assert isinstance(touch, CompiledTouch)
        before, stayed = np.full(3, np.nan), 0
        for hand in path:
            touch.force(HapticState(tuple(hand.tolist())))
            proxy, moved = touch.memory[:3].copy(), np.linalg.norm(touch.memory[:2] - before[:2])
            if moved <= 0.0021:  # and not let go, or new
                stayed += 1
                assert np.linalg.norm(proxy - hand) <= np.linalg.norm(before - hand) + 1e-9
            before = proxy
        assert stayed > ticks / 2


class TestShortCuts:
    """Each short cut gives what the long way gives."""

    def test_spring_alone_matches_the_general_kernel(self, rough: HapticSurface):
        """Damping without velocity has no force, which lets the general kernel run."""
        turn = np.linspace(0, 6, 3000)
        path = np.column_stack([0.03 * np.sin(3 * turn), 0.03 * np.cos(2 * turn), 0.002 * np.sin(9 * turn)])
        states = [HapticState(tuple(place)) for place in path.tolist()]
        general, spring = (Proxy(damping_n_s_per_m=b).touch(rough) for b in (1.0, 0.0))
        assert general.tick is not spring.tick
        assert np.allclose([general.force(s) for s in states], [spring.force(s) for s in states], rtol=0, atol=1e-9)

    def test_equal_materials_are_one(self):
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

    def test_level_ground_is_level_in_tiles_and_spline(self):
        heights = np.full((256, 256), 0.004)
        heights[100:120, 100:120] = 0.009
        path = np.column_stack([np.linspace(-0.039, 0.039, 3000), np.linspace(0.03, -0.02, 3000), np.full(3000, 0.003)])
        surface = HapticSurface.from_heights(heights)
        general, quick = Proxy(damping_n_s_per_m=1e-300).touch(surface), Proxy().touch(surface)
        assert general.tick is not quick.tick
        assert np.allclose(general.path(path), quick.path(path), rtol=0, atol=1e-7)

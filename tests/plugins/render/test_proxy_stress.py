"""The proxy would get stuck on rough ground, or its short cuts would feel different from the long way."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rough_surfaces import rough_surfaces
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

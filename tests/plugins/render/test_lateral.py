"""Lateral force laws, the plain spring and force shading would give wrong forces on analytic surfaces."""

import numpy as np
import pytest

from tangible_core.data import HapticState, HapticSurface, Material
from tangible_core.testing.synthetic.scenes import KnownSurface, ramp, sphere_cap, waves
from tangible_render.force_shading import ForceShading
from tangible_render.lateral_gradient import LateralGradient
from tangible_render.lateral_shape import LateralShape
from tangible_render.penalty import Penalty

RNG = np.random.default_rng(17)
KNOWN = {"ramp": ramp(), "sphere": sphere_cap(shape=(256, 256)), "waves": waves()}


def press(renderer, known: KnownSurface, x: float, y: float, depth_m: float = 0.001) -> np.ndarray:
    return np.array(renderer.touch(known.surface).force(HapticState(known.at(x, y, depth_m))))


@pytest.fixture(params=KNOWN)
def known(request) -> KnownSurface:
    return KNOWN[request.param]


PLACES = RNG.uniform(-0.036, 0.036, (12, 2))


def test_lateral_gradient_at_any_depth_is_the_slope(known: KnownSurface):
    for x, y in PLACES:
        slope = np.array(known.slope(x, y))
        for depth in (1e-5, 0.004):
            assert np.allclose(
                press(LateralGradient(force_per_slope_n=3.0), known, x, y, depth), [*-3 * slope, 0], atol=1e-3
            )


def test_lateral_shape_is_the_slope_times_the_push(known: KnownSurface):
    for x, y in PLACES:
        slope = np.array(known.slope(x, y))
        for depth in (0.0005, 0.004):
            force = press(LateralShape(stiffness_n_per_m=500.0), known, x, y, depth)
            assert np.allclose(force, [*(-500 * depth * slope), 0], rtol=0, atol=1e-4)


def test_penalty_is_a_spring_along_z_with_damping_that_never_pulls(known: KnownSurface):
    touch = Penalty(stiffness_n_per_m=500.0, damping_n_s_per_m=2.0).touch(known.surface)
    for x, y in PLACES:
        for speed in (-0.25, 0.0, 0.1, 100.0):
            force = touch.force(HapticState(known.at(x, y, 0.002), (3.0, -2.0, speed)))
            assert force == pytest.approx((0, 0, max(0.0, 1.0 - 2 * speed)), abs=1e-4)


def test_penalty_takes_the_stiffness_of_materials():
    labels = np.repeat([[0, 1]], 2, axis=0).repeat(8, axis=1).astype(np.int32)
    materials = Material("soft", 100.0, 0, 0, 0), Material("hard", 900.0, 0, 0, 0)
    touch = Penalty().touch(HapticSurface.from_heights(np.full((2, 16), 0.01), 0.08, labels, materials))
    assert touch.force(HapticState((-0.02, 0, 0))).z == pytest.approx(1.0)
    assert touch.force(HapticState((0.02, 0, 0))).z == pytest.approx(9.0)


class TestForceShading:
    @pytest.mark.parametrize("known", [ramp(), ramp((0.5, -0.75), 0.06), ramp((0.0, 0.6), 0.06)])
    def test_force_on_a_plane_is_a_spring_along_the_normal(self, known: KnownSurface):
        normal = known.normal(0, 0)
        for x, y in RNG.uniform(-0.037, 0.037, (12, 2)):
            force = press(ForceShading(stiffness_n_per_m=700.0), known, x, y)
            assert np.allclose(force, 0.7 * normal[2] * normal, rtol=1e-3, atol=1e-4)

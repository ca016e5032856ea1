"""A hand would stick or slip where the friction of the surface says otherwise."""

import numpy as np
import pytest

from tangible_core.data import Force, HapticState, HapticSurface, Material
from tangible_core.plugins.interfaces import Touch
from tangible_core.testing.synthetic.scenes import plane, ramp
from tangible_render.proxy import Proxy

K = 800.0
LEVEL = plane(0.01).surface


def at(touch: Touch, x: float, y: float, z: float, velocity=(0.0, 0.0, 0.0)) -> Force:
    return touch.force(HapticState((float(x), float(y), float(z)), velocity))


class TestFriction:
    def test_proxy_sticks_in_the_static_cone_and_slides_on_the_dynamic_one(self):
        touch = Proxy(static_friction=0.8, dynamic_friction=0.5).touch(LEVEL)
        x = np.arange(0, 0.004, 1e-6)
        force = touch.path(np.column_stack([x, np.zeros_like(x), np.full_like(x, 0.009)]))
        ratio = -force[:, 0] / force[:, 2]
        slip = int(ratio.argmax())
        assert np.allclose(-force[: slip + 1, 0], K * x[: slip + 1], atol=1e-6)  # held: a spring along x
        assert ratio[slip] == pytest.approx(0.8, abs=2e-3)
        assert np.allclose(ratio[slip + 1 :], 0.5, atol=2e-3)

    @pytest.mark.parametrize(
        "between",
        [(0.003, 0.0, 0.1), (0.05, 0.0, 0.009), (np.nan, 0.0, 0.009), (0.003, np.inf, 0.009), None],
        ids=["lifted", "beside", "lost", "no number", "leapt"],
    )
    def test_contact_after_another_begins_at_rest(self, between: tuple[float, float, float] | None):
        """A proxy that slid is held up to the static friction again once the hand was elsewhere: on a slope within
        that cone, but not within the dynamic one, it rests."""
        known = ramp((0.65, 0.0), 0.03)
        touch = Proxy(static_friction=0.8, dynamic_friction=0.5).touch(known.surface)
        down = touch.path(np.array([known.at(x, 0.0, 0.001) for x in np.linspace(0.01, 0.003, 300).tolist()]))[-1]
        normal = known.normal(0, 0)
        assert np.linalg.norm(down - (down @ normal) * normal) == pytest.approx(0.5 * (down @ normal), rel=1e-3)
        if between is not None:
            at(touch, *between)
        anew = known.at(-0.004, 0.003, 0.001)
        assert at(touch, *anew) == pytest.approx((0, 0, K * 0.001), abs=1e-5)
        assert at(touch, *anew) == pytest.approx((0, 0, K * 0.001), abs=1e-5)

    def test_proxy_on_a_slope_within_the_cone_rests(self):
        known = ramp((0.3, 0.0), 0.02)
        hand = known.at(0.001, 0.002, 0.001)
        held = at(Proxy(static_friction=0.31, dynamic_friction=0.31).touch(known.surface), *hand)
        assert held == pytest.approx((0, 0, K * 0.001), abs=1e-6)
        slid = np.array(at(Proxy(static_friction=0.2, dynamic_friction=0.1).touch(known.surface), *hand))
        normal = known.normal(0, 0)
        along = np.linalg.norm(slid - (slid @ normal) * normal)
        assert along == pytest.approx(0.1 * (slid @ normal), rel=1e-3)

    def test_damping_and_friction_are_those_of_materials_along_the_normal(self):
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
        known = ramp((0.5, 0.0), 0.03)
        normal, along = known.normal(0, 0), np.array([1, 0, 0.5])
        renderer = Proxy(damping_n_s_per_m=4.0)
        hand = known.at(0, 0, 0.001)
        spring = K * 0.001 * normal[2]
        for speed in (-0.25, 0.0, 0.125, 100.0):
            force = at(renderer.touch(known.surface), *hand, tuple(speed * normal + 0.5 * along))
            assert np.allclose(force, max(0.0, spring - 4 * speed) * normal, rtol=1e-4, atol=1e-4)


def test_dynamic_friction_above_static_is_refused():
    with pytest.raises(ValueError, match="sliding takes no more force"):
        Proxy(static_friction=0.2, dynamic_friction=0.3)

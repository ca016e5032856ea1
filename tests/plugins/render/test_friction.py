"""Friction and damping of the proxy: sticking, slipping, slopes, materials."""

import numpy as np
import pytest

from tangible_core.data import Force, HapticState, HapticSurface, Material
from tangible_core.plugins.interfaces import Touch
from tangible_core.testing.synthetic.reliefs import waves
from tangible_core.testing.synthetic.scenes import plane, ramp, sphere_cap
from tangible_render.proxy import Proxy
from tangible_render.surface import spline
from tangible_render.surface.coefficients import spline_surface

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

    def test_sliding_proxy_coming_to_rest_sticks_again(self):
        """A force within the dynamic cone lets the proxy stick, up to the static cone again."""
        touch = Proxy(static_friction=0.8, dynamic_friction=0.5).touch(LEVEL)
        x = np.linspace(0, 0.003, 300)
        touch.path(np.column_stack([x, 0 * x, np.full(300, 0.009)]))
        assert at(touch, 0.0029, 0.0, 0.009).x == pytest.approx(-K * 0.0004, abs=1e-3)
        assert at(touch, 0.0032, 0.0, 0.009).x == pytest.approx(-K * 0.0007, abs=1e-3)

    def test_proxy_sticks_again_when_the_hand_turns_back(self):
        touch = Proxy(static_friction=0.8, dynamic_friction=0.5).touch(LEVEL)
        there, back = np.linspace(0, 0.004, 400), np.linspace(0.004, 0.002, 400)
        x = np.concatenate([there, back])
        force = touch.path(np.column_stack([x, np.zeros(800), np.full(800, 0.009)]))
        assert force[399, 0] == pytest.approx(-0.4, abs=1e-3)
        assert force[:, 0].max() == pytest.approx(0.8 * 0.8, abs=0.01)

    def test_proxy_on_a_slope_within_the_cone_rests(self):
        known = ramp((0.3, 0.0), 0.02)
        hand = known.at(0.001, 0.002, 0.001)
        held = at(Proxy(static_friction=0.31, dynamic_friction=0.31).touch(known.surface), *hand)
        assert held == pytest.approx((0, 0, K * 0.001), abs=1e-6)
        slid = np.array(at(Proxy(static_friction=0.2, dynamic_friction=0.1).touch(known.surface), *hand))
        normal = known.normal(0, 0)
        along = np.linalg.norm(slid - (slid @ normal) * normal)
        assert along == pytest.approx(0.1 * (slid @ normal), rel=1e-3)

    def test_force_on_a_curved_surface_stays_on_the_cone(self):
        known = sphere_cap(shape=(256, 256))
        turn = np.arange(2000) / 1000
        places = np.column_stack([0.025 * np.sin(1.95 * turn), 0.025 * np.sin(1.45 * turn + 0.7)])
        path = np.array([known.at(x, y, 0.002) for x, y in places.tolist()])
        force = Proxy(static_friction=0.4, dynamic_friction=0.3).touch(known.surface).path(path)
        out = force / K + path + [0, 0, 0.08]
        normal = out / np.linalg.norm(out, axis=1, keepdims=True)
        push = np.sum(force * normal, axis=1)
        along = np.linalg.norm(force - push[:, None] * normal, axis=1)
        assert np.percentile(np.abs(along[200:] / push[200:] - 0.3), 95) < 1e-3

    def test_materials_have_their_own_stiffness_and_friction(self):
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

    def test_damping_of_materials_without_friction_stays(self):
        honey = Material("honey", 500.0, 4.0, 0.6, 0.5)
        surface = HapticSurface.from_heights(np.full((8, 8), 0.01), 0.08, np.zeros((8, 8), np.int32), (honey,))
        touch = Proxy(friction=False).touch(surface)
        at(touch, 0.0, 0.0, 0.009)
        assert at(touch, 0.001, 0.0, 0.009, (0.1, 0.0, -0.05)) == pytest.approx((0, 0, 0.5 + 0.2), abs=1e-5)

    def test_damping_acts_along_the_normal_at_the_proxy(self):
        """The normal is that after the last step, the only one under a slow hand, not that before."""
        known = waves()
        coefficients, _, _, across, down = spline_surface(known.surface, "auto")
        touch, without = Proxy(damping_n_s_per_m=4.0).touch(known.surface), Proxy().touch(known.surface)
        worst = 0.0
        for x in np.linspace(0.003, 0.0034, 200).tolist():
            hand = known.at(x, 0.5 * x, 0.0008)
            damped = np.subtract(at(touch, *hand, (0.0, 0.0, -0.1)), at(without, *hand))
            _, hx, hy = spline.slope(coefficients, across, down, *touch.memory[:2])
            worst = max(worst, float(np.linalg.norm(np.cross(damped, (-hx, -hy, 1))) / np.linalg.norm(damped)))
        assert worst < 1e-5

    def test_damping_acts_along_the_normal_and_never_pulls(self):
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

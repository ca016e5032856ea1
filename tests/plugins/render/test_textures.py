"""Fine textures under the proxy: a true displacement of its surface, conservative, and forces that only take energy."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

from rough_surfaces import rough_surfaces
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import NO_FORCE, HapticState, HapticSurface, Material
from tangible_core.materials.assignment import library
from tangible_core.plugins.interfaces import ForceRenderer
from tangible_core.testing.synthetic.scenes import ramp
from tangible_render.haptic_textures import compile_textures
from tangible_render.haptic_textures.heights import texture_height
from tangible_render.kernels import proxy, proxy_spring, proxy_texture
from tangible_render.proxy import Proxy
from tangible_render.with_materials import WithMaterials

K = 800.0
MAPS = rough_surfaces()
GRAINY = Material("grainy", K, 0.0, 0.0, 0.0, roughness_m=1e-4, grain_m=1e-3)
RUBBER = replace(library()["rubber"], roughness_m=0.0, damping_n_s_per_m=0.0)


def in_stripes(surface: HapticSurface, *materials: Material) -> HapticSurface:
    """Cover the surface with stripes of materials from left to right."""
    labels = np.zeros(surface.height_m.shape, np.int32)
    labels[:] = np.arange(labels.shape[1]) * len(materials) // labels.shape[1]
    return HapticSurface(surface.relief, labels, materials)


def level(*materials: Material) -> HapticSurface:
    return in_stripes(HapticSurface.from_heights(np.full((64, 64), 0.01)), *materials)


def texture_along(path: np.ndarray) -> np.ndarray:
    """Return height and slopes of GRAINY along a path at the hand's speed: (n, 3)."""
    table = compile_textures([GRAINY])
    steps = np.diff(path, axis=0, prepend=path[:1])
    return np.array([texture_height(table, 0, *at[:2], *step[:2], 1.0) for at, step in zip(path, steps, strict=True)])


def touch(renderer: Proxy, surface: HapticSurface) -> CompiledTouch:
    made = renderer.touch(surface)
    assert isinstance(made, CompiledTouch)
    return made


@pytest.mark.parametrize("method", [Proxy(), WithMaterials(law="penalty-gradient")])
@pytest.mark.parametrize(("friction", "ratio"), [(True, 2.0 / 1.6), (False, 1.0)])
def test_stiffness_reported_is_that_of_a_sticking_hand(method: ForceRenderer, friction: bool, ratio: float) -> None:
    """Sideways a bristle is stiffer than its material by mu_s / mu_d; no steeper force than said is felt."""
    sticky = replace(RUBBER, stiffness_n_per_m=K, static_friction=2.0, dynamic_friction=1.6)
    law = method.model_copy(update={"friction": friction}).touch(level(sticky))
    assert isinstance(law, CompiledTouch)
    assert law.stiffness_n_per_m == pytest.approx(ratio * K, rel=1e-12)
    aside_m = np.arange(20) * 1e-5
    forces = law.path(np.column_stack([0.003 + aside_m, 0 * aside_m, 0 * aside_m + 0.009]))
    assert np.ptp(forces[:, 0]) == pytest.approx(friction * ratio * K * np.ptp(aside_m), rel=1e-6)


class TestHeights:
    def test_surface_is_displaced_by_the_texture(self):
        surface = level(GRAINY)
        for x in np.linspace(-0.03, 0.03, 20).tolist():
            t = texture_along(np.array([[x, 0.002, 0.0]]))[0, 0]
            for up_m, free in ((1e-8, True), (-1e-8, False)):
                force = Proxy().touch(surface).force(HapticState((x, 0.002, 0.01 + float(t) + up_m)))
                assert (force == NO_FORCE) == free

    def test_force_on_level_ground_is_the_gradient_of_a_spring(self):
        """F = -grad k (h + t - z)^2 / 2."""
        s = np.linspace(0, 0.02, 2000)
        path = np.column_stack([s, 0.3 * s, np.full_like(s, 0.009)])
        t, tx, ty = texture_along(path).T
        push = K * (0.01 + t - 0.009)
        force = Proxy().touch(level(GRAINY)).path(path)
        assert np.allclose(force, np.column_stack([-tx * push, -ty * push, push]), rtol=0, atol=1e-6)

    @pytest.mark.parametrize("name", MAPS)
    def test_force_is_that_of_the_plain_surface_transformed(self, name: str):
        """A hand at z feels what the plain surface does at z - t, and F_z gives the rest, on any surface."""
        turn = np.linspace(0, 6, 6000)
        path = np.column_stack([0.03 * np.sin(3 * turn), 0.03 * np.cos(2 * turn), 0.002 * np.sin(9 * turn)])
        t, tx, ty = texture_along(path).T
        below = Proxy(stiffness_n_per_m=K).touch(MAPS[name]).path(path - np.column_stack([0 * t, 0 * t, t]))
        expected = below - np.column_stack([tx * below[:, 2], ty * below[:, 2], 0 * t])
        assert np.allclose(Proxy().touch(in_stripes(MAPS[name], GRAINY)).path(path), expected, rtol=0, atol=1e-6)

    @pytest.mark.parametrize("depth_m", [0.0, 0.004])
    @pytest.mark.parametrize("name", MAPS)
    def test_closed_paths_gain_no_energy(self, name: str, depth_m: float):
        """Work of the device on the hand over the second of two turns, too slow for a wave to fade."""
        turn = np.arange(100000) / 100000
        x, y = 0.032 * np.sin(2 * np.pi * 5 * turn), 0.041 * np.sin(2 * np.pi * 3 * turn + 0.4)  # over the borders too
        loop = np.column_stack([x, y, 0.002 + 0.001 * np.sin(2 * np.pi * 7 * turn) - depth_m])
        force = Proxy().touch(in_stripes(MAPS[name], GRAINY)).path(np.vstack([loop, loop, loop[:1]]))[len(loop) :]
        parts = (force[1:] + force[:-1]) / 2 * np.diff(np.vstack([loop, loop[:1]]), axis=0)
        assert parts.sum() <= 1e-5 * np.abs(parts).sum()

    def test_damping_sees_the_speed_over_the_texture(self):
        """The hand over the texture rises by v_z - t'.v."""
        damped = replace(GRAINY, damping_n_s_per_m=3.0)
        x, y, (vx, vy, vz) = 0.0123, -0.004, (0.2, -0.1, 0.05)
        ((t, tx, ty),) = texture_along(np.array([[x, y, 0.009]]))
        push = K * (0.001 + t) - 3.0 * (vz - tx * vx - ty * vy)
        assert abs(tx * vx) > 0.01
        force = Proxy().touch(level(damped)).force(HapticState((x, y, 0.009), (vx, vy, vz)))
        assert force == pytest.approx((-tx * push, -ty * push, push), abs=1e-5)

    def test_hand_too_fast_for_a_texture_gets_none(self):
        path = np.column_stack([np.arange(40) * 5e-4, np.zeros(40), np.full(40, 0.009)])
        lines = replace(GRAINY, anisotropy=1.0, direction_deg=90.0)
        assert np.allclose(Proxy().touch(level(lines)).path(path)[1:], [0, 0, K * 0.001], atol=1e-6)

    def test_first_tick_anywhere_has_the_whole_texture(self):
        """A hand without a last position did not come from the middle."""
        low = in_stripes(HapticSurface.from_heights(np.full((64, 64), 0.001)), GRAINY)
        touch, state = Proxy().touch(low), HapticState((0.0012, 0.0016, 0.0005))
        assert touch.force(state) == touch.force(state) != NO_FORCE

    def test_hand_entering_anew_gets_the_whole_texture(self):
        touch, state = Proxy().touch(level(GRAINY)), HapticState((0.0102, 0.003, 0.009))
        first = touch.force(state)
        for other in ((np.nan, 0.0, 0.0), (-0.02, 0.01, 0.009)):
            touch.force(HapticState(other))
            assert touch.force(state) == first


class TestForces:
    def test_friction_of_the_surface_stays(self):
        rough = replace(GRAINY, static_friction=0.6, dynamic_friction=0.5)
        x = np.linspace(0, 0.03, 3000)
        force = Proxy().touch(level(rough)).path(np.column_stack([x, 0 * x, np.full_like(x, 0.009)]))[500:]
        assert -force[:, 0].mean() / force[:, 2].mean() == pytest.approx(0.5, abs=0.02)

    @pytest.mark.parametrize("slope", [0.0, 0.7])
    def test_texture_with_stick_slip_is_the_only_friction(self, slope: float):
        """Friction on any slope lies across the force of the surface, in proportion to it."""
        known = ramp((slope, 0.0), 0.03)
        path = np.array([known.at(x, 0.001, 0.001) for x in np.linspace(-0.01, 0.01, 4000).tolist()])
        force = Proxy().touch(in_stripes(known.surface, RUBBER)).path(path)[1000:]
        normal = known.normal(0, 0)
        push = force @ normal
        along = -force @ np.array([normal[2], 0, -normal[0]])
        assert np.allclose(push, RUBBER.stiffness_n_per_m * 0.001 * normal[2], rtol=1e-3)
        assert along.mean() / push.mean() == pytest.approx(RUBBER.dynamic_friction, rel=0.02)
        assert along.max() / push.mean() <= 1.01 * RUBBER.static_friction
        assert np.ptp(along) > 0.1 * push.mean()

    def test_rubbing_never_gives_energy(self):
        """Work up to any moment of a wild path, the sum of forces times steps, is never positive."""
        random = np.random.default_rng(2)
        path = np.column_stack([np.cumsum(random.normal(0, 1e-4, (5000, 2)), axis=0), np.full(5000, 0.009)])
        force = Proxy().touch(level(RUBBER)).path(path)
        given = np.cumsum(np.sum(force[1:, :2] * np.diff(path[:, :2], axis=0), axis=1))
        assert given.max() <= 1e-12

    def test_drag_is_against_the_velocity(self):
        water = replace(library()["water"], damping_n_s_per_m=0.0)
        state = HapticState((0.0, 0.0, 0.009), (0.2, -0.1, 0.0))
        force = Proxy().touch(level(water)).force(state)
        assert force == pytest.approx((-0.2 * water.drag_n_s_per_m, 0.1 * water.drag_n_s_per_m, 0.1), abs=1e-6)

    def test_materials_have_their_own_textures(self):
        surface = level(replace(GRAINY, roughness_m=0.0), RUBBER)
        for start, friction in ((-0.03, 0.0), (0.01, RUBBER.dynamic_friction)):
            path = np.column_stack([start + np.linspace(0, 0.02, 2000), np.zeros(2000), np.full(2000, 0.009)])
            force = Proxy().touch(surface).path(path)[1000:]
            assert -force[:, 0].mean() / force[:, 2].mean() == pytest.approx(friction, rel=0.03)


class TestOmissions:
    @pytest.mark.parametrize("off", [{"texture": False}, {"friction": False}])
    def test_disabled_effect_has_no_force(self, off: dict[str, bool]):
        rubber = replace(RUBBER, roughness_m=1e-4)
        path = np.column_stack([np.linspace(0, 0.02, 2000), np.zeros(2000), np.full(2000, 0.009)])
        force = Proxy(**off).touch(level(rubber)).path(path)[1000:]
        if "texture" in off:
            assert np.allclose(force, 0.45 * np.array([-rubber.dynamic_friction, 0, 1]), atol=1e-3)
        else:
            assert abs(force[:, 0].mean()) < 0.01 and force[:, 0].std() > 0.01

    def test_surface_without_textures_uses_the_simpler_kernel(self):
        smooth = replace(GRAINY, roughness_m=0.0)
        assert touch(Proxy(), level(smooth)).tick is proxy_spring.spring_tick
        assert touch(Proxy(), level(replace(smooth, damping_n_s_per_m=1.0))).tick is proxy.tick
        assert touch(Proxy(), level(GRAINY)).tick is proxy_texture.textured_tick
        assert touch(Proxy(texture=False), level(GRAINY)).tick is proxy_spring.spring_tick
        assert touch(Proxy(friction=False), level(RUBBER)).tick is proxy_spring.spring_tick

    def test_material_not_occurring_costs_nothing(self):
        surface = HapticSurface.from_heights(np.full((4, 4), 0.01), 0.08, np.zeros((4, 4), np.int32), (RUBBER, GRAINY))
        alone = HapticSurface.from_heights(np.full((4, 4), 0.01), 0.08, np.zeros((4, 4), np.int32), (RUBBER,))
        assert touch(Proxy(texture=False), surface).tick is touch(Proxy(texture=False), alone).tick
        smooth = replace(GRAINY, roughness_m=0.0)
        plain = HapticSurface.from_heights(np.full((4, 4), 0.01), 0.08, np.zeros((4, 4), np.int32), (smooth, RUBBER))
        assert touch(Proxy(), plain).tick is touch(Proxy(texture=False), plain).tick is proxy_spring.spring_tick

    @pytest.mark.parametrize("material", [GRAINY, RUBBER], ids=lambda each: each.name)
    def test_touch_pickled_has_the_same_forces(self, material: Material):
        path = np.column_stack([np.linspace(0, 0.02, 200), np.zeros(200), np.full(200, 0.009)])
        made = touch(Proxy(), level(material))
        other = pickle.loads(pickle.dumps(made))
        assert np.array_equal(other.path(path), made.path(path))

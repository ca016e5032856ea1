"""A fine texture under the proxy would be felt in the wrong place or push the hand on."""

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

    def test_texture_is_whole_at_the_first_tick_and_none_at_great_speed(self):
        path = np.column_stack([np.arange(40) * 5e-4, np.zeros(40), np.full(40, 0.009)])
        lines = replace(GRAINY, anisotropy=1.0, direction_deg=90.0)
        assert np.allclose(Proxy().touch(level(lines)).path(path)[1:], [0, 0, K * 0.001], atol=1e-6)
        low = in_stripes(HapticSurface.from_heights(np.full((64, 64), 0.001)), GRAINY)
        touch, state = Proxy().touch(low), HapticState((0.0012, 0.0016, 0.0005))
        assert touch.force(state) == touch.force(state) != NO_FORCE


class TestForces:
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

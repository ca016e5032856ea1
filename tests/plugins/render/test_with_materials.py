"""Materials around any force law: friction, texture and damping are exact, passive, and absent without materials."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from materials_on_laws import GRAINY, LATERAL, PLAIN, PUSHING, RUBBER, STICKY, K, cover, level, stroke
from rough_surfaces import rough_surfaces
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import HapticState, HapticSurface, Material
from tangible_core.materials.assignment import library
from tangible_core.plugins.registry import load_method
from tangible_core.testing.synthetic.reliefs import waves
from tangible_core.testing.synthetic.scenes import ramp
from tangible_render.effects.effects_table import effects_table, split_textures
from tangible_render.effects.material_table import material_table
from tangible_render.haptic_textures import compile_textures
from tangible_render.haptic_textures.heights import texture_height
from tangible_render.haptic_textures.table import STIFFNESS
from tangible_render.with_materials import WithMaterials

MAPS = rough_surfaces()


def grain(path: np.ndarray) -> np.ndarray:
    """Return height and slopes of GRAINY along a path: (3, n)."""
    table, steps = compile_textures([GRAINY]), np.diff(path, axis=0, prepend=path[:1])
    made = [texture_height(table, 0, *at[:2], *step[:2], 1.0) for at, step in zip(path, steps, strict=True)]
    return np.transpose(made)


class TestFriction:
    @pytest.mark.parametrize("law", PUSHING)
    def test_friction_sticks_up_to_static_and_slides_on_dynamic(self, law: str):
        path = stroke()
        force = WithMaterials(law=law).touch(level(STICKY)).path(path)
        ratio = -force[:, 0] / force[:, 2]
        slip = int(ratio.argmax())
        assert np.allclose(-force[: slip + 1, 0], K * path[: slip + 1, 0], atol=1e-9)
        assert ratio[slip] == pytest.approx(0.8, abs=2e-3)
        assert np.allclose(ratio[slip + 1 :], 0.5, atol=2e-3)
        assert np.allclose(force[:, 1], 0, atol=1e-9)

    @pytest.mark.parametrize("law", LATERAL)
    def test_push_under_a_lateral_law_is_the_depth(self, law: str):
        force = WithMaterials(law=law).touch(level(STICKY)).path(stroke())
        assert -force[:, 0].min() == pytest.approx(0.8 * K * 0.001, rel=5e-3)
        assert np.allclose(force[-1000:], [-0.5 * K * 0.001, 0, 0], atol=1e-3)

    @pytest.mark.parametrize("steepness", [0.3, 3.0])
    def test_friction_on_any_slope_lies_along_it(self, steepness: float):
        known = ramp((0.0, steepness), 0.15)
        path = np.array([known.at(0.002, y, 0.001) for y in np.linspace(-0.01, 0.01, 20000).tolist()])
        force = WithMaterials(law="penalty-gradient").touch(cover(known.surface, STICKY)).path(path)[10000:]
        normal = known.normal(0, 0)
        push, along = force @ normal, force @ np.array([0, normal[2], -normal[1]])
        assert np.allclose(push, K * 0.001 / normal[2], rtol=1e-3)
        assert np.allclose(along, -0.5 * push, rtol=1e-3)
        assert np.allclose(force[:, 0], 0, atol=1e-6)

    @pytest.mark.parametrize("slopes", [(0.0, 0.75), (0.5, -0.75), (-0.6, -0.3)])
    @pytest.mark.parametrize("way", [(0.0, 0.8, 0.6), (0.6, 0.0, 0.0), (0.0, 0.0, -1.0)], ids=["up", "across", "down"])
    def test_bristle_is_stretched_by_the_way_along_the_surface(
        self, way: tuple[float, float, float], slopes: tuple[float, float]
    ):
        """A way straight down on a slope stretches it by its part along the slope."""
        known = ramp(slopes, 0.05)
        touch = WithMaterials(law="penalty-gradient").touch(cover(known.surface, STICKY))
        alone = load_method("render", "penalty-gradient")().touch(cover(known.surface, STICKY))
        start, normal = np.array(known.at(0.0, 0.0, 0.001)), known.normal(0, 0)
        touch.force(HapticState(tuple(start.tolist())))
        end = HapticState(tuple((start + 2e-4 * np.array(way)).tolist()))
        stretched = 2e-4 * (np.array(way) - (way @ normal) * normal)
        assert np.subtract(touch.force(end), alone.force(end)) == pytest.approx(-K * stretched, abs=1e-6)

    @pytest.mark.parametrize("slopes", [(0.0, 0.0), (0.5, -0.75), (-0.6, -0.3)])
    @pytest.mark.parametrize("velocity", [(0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.02, -0.05, 0.08)])
    def test_drag_is_against_the_velocity_along_the_surface(
        self, slopes: tuple[float, float], velocity: tuple[float, float, float]
    ):
        known, honey = ramp(slopes, 0.05), replace(PLAIN, name="honey", drag_n_s_per_m=2.0)
        state = HapticState(known.at(0.0, 0.0, 0.001), velocity)
        touch = WithMaterials(law="penalty-gradient").touch(cover(known.surface, honey))
        alone = load_method("render", "penalty-gradient")().touch(cover(known.surface, honey))
        normal = known.normal(0, 0)
        along = np.array(velocity) - (velocity @ normal) * normal
        assert np.subtract(touch.force(state), alone.force(state)) == pytest.approx(-2.0 * along, abs=1e-6)

    @pytest.mark.parametrize("material", [STICKY, RUBBER], ids=lambda each: each.name)
    @pytest.mark.parametrize("law", PUSHING + LATERAL)
    def test_friction_in_any_direction_is_the_same(self, law: str, material: Material):
        """The path goes back and forth on level ground."""
        path = np.vstack([stroke(0.008, ticks=500), stroke(0.008, ticks=300)[::-1]])
        expected = WithMaterials(law=law).touch(level(material)).path(path)
        for turn in (np.pi / 2, 2.5, -1.0):
            turned = np.array([[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
            found = WithMaterials(law=law).touch(level(material)).path(path @ turned)
            assert np.allclose(found, expected @ turned, rtol=0, atol=1e-6)

    def test_material_is_that_under_the_hand_on_a_long_surface(self):
        """2 by 8 cm, sticky along the far quarter."""
        labels = np.repeat(np.int32([1, 0, 0, 0]), 20)[:, None].repeat(20, 1)
        surface = HapticSurface.from_heights(np.full((80, 20), 0.01), 0.02, labels, (PLAIN, STICKY))
        for y, pull_n in ((0.03, 0.5 * K * 0.001), (0.015, 0.0), (-0.03, 0.0)):
            force = WithMaterials(law="penalty").touch(surface).path(stroke(0.008) + np.array([0, y, 0]))
            assert -force[-1, 0] == pytest.approx(pull_n, rel=1e-3)

    @pytest.mark.parametrize("law", PUSHING + LATERAL)
    def test_friction_outside_of_the_surface_is_zero(self, law: str):
        touch = WithMaterials(law=law).touch(level(STICKY))
        assert not touch.path(stroke() + np.array((0.0401, 0, 0))).any()
        assert not touch.path(stroke() + np.array((0, 0.0401, 0))).any()

    @pytest.mark.parametrize("material", [STICKY, RUBBER], ids=lambda each: each.name)
    @pytest.mark.parametrize("law", PUSHING + LATERAL)
    @pytest.mark.parametrize(
        "between",
        [(0.003, 0.0, 0.011), (0.05, 0.0, 0.009), (np.nan, 0.0, 0.009), (0.003, 0.0052, 0.009)],
        ids=["lifted", "beside", "lost", "leapt"],
    )
    def test_contact_after_another_is_like_the_first(
        self, law: str, material: Material, between: tuple[float, float, float]
    ):
        """The first tick has no friction wherever the hand was, and the next ones are those of a new touch."""
        touch, alone = (WithMaterials(law=law).touch(level(each)) for each in (material, PLAIN))
        again = stroke(0.002, ticks=40) + np.array((0.0025, between[1], 0))
        fresh = WithMaterials(law=law).touch(level(material)).path(again)
        touch.path(stroke(0.003, ticks=300))
        touch.force(HapticState(between))
        if between[1]:  # the leap itself begins the contact
            assert touch.force(HapticState(between)) == alone.force(HapticState(between))
            touch.force(HapticState((0.0, 0.0, 0.011)))
        assert touch.force(HapticState(tuple(again[0]))) == alone.force(HapticState(tuple(again[0])))
        assert np.allclose([touch.force(HapticState(tuple(at))) for at in again[1:]], fresh[1:], rtol=0, atol=1e-12)


def test_table_leaves_out_what_is_off_and_friction_of_textures_that_stick():
    halves = np.int32([[0, 1]])
    surface = HapticSurface.from_heights(np.zeros((1, 2)), 0.02, halves, (STICKY, RUBBER))
    labels, table = effects_table(surface)
    assert labels.tolist() == halves.tolist()
    assert table[:, -4:].tolist() == [[K, 0, 0.8, 0.5], [K, 0, 0, 0]]
    assert (table[:, STIFFNESS] > 0).tolist() == [False, True]
    _, smooth = effects_table(surface, friction=False)
    assert smooth[:, -4:].tolist() == [[K, 0, 0, 0]] * len(smooth)
    assert not smooth[:, STIFFNESS].any()


def test_table_of_one_material_is_one_row():
    """Of the labels that occur; those of two materials are kept where they differ in anything."""
    whole, halves = np.int32([[1, 1]]), np.int32([[0, 1]])
    for labels, size in ((whole, 1), (halves, 2)):
        surface = HapticSurface.from_heights(np.zeros((1, 2)), 0.02, labels, (STICKY, PLAIN))
        for found, table in (effects_table(surface), material_table(surface, (1.0, 1.0, 1.0, 1.0))):
            assert found.shape == (1, size)
            assert table[:, -4:].tolist() == [[K, 0, 0.8, 0.5], [K, 0, 0, 0]][-size:]


def test_textures_are_split_from_what_the_law_renders_itself():
    rough = replace(STICKY, roughness_m=1e-4, damping_n_s_per_m=3.0)
    split = split_textures(level(rough), friction=True)
    assert split is not None
    _, with_friction, table, _ = split
    assert with_friction.tolist() == [[K, 3, 0.8, 0.5]]
    assert table[:, -4:].tolist() == [[K, 0, 0, 0]]
    assert split_textures(level(STICKY), friction=True) is None


class TestTexture:
    @pytest.mark.parametrize("smooth", [PLAIN, STICKY], ids=lambda each: each.name)
    @pytest.mark.parametrize("law", PUSHING)
    def test_force_is_that_of_the_inner_law_transformed(self, law: str, smooth: Material):
        """Friction included: it goes along with the hand as the law sees it."""
        turn = np.linspace(0, 6, 6000)
        path = np.column_stack([0.03 * np.sin(3 * turn), 0.03 * np.cos(2 * turn), 0.003 + 0.002 * np.sin(9 * turn)])
        t, tx, ty = grain(path)
        surface = MAPS["waves"]
        below = WithMaterials(law=law).touch(cover(surface, smooth)).path(path - t[:, None] * [0, 0, 1])
        expected = below - below[:, 2:] * np.column_stack([tx, ty, 0 * tx])
        found = (
            WithMaterials(law=law).touch(cover(surface, replace(smooth, roughness_m=1e-4, name="grainy"))).path(path)
        )
        assert np.allclose(found, expected, rtol=0, atol=1e-9)

    @pytest.mark.parametrize("law", [{"use": "penalty-gradient", "damping_n_s_per_m": 3.0}, "penalty-gradient"])
    def test_damping_sees_the_speed_over_the_texture(self, law: str | dict[str, object]):
        """The law's own and the material's: both see the hand rise by v_z - t'.v."""
        x, y, (vx, vy, vz) = 0.0123, -0.004, (0.2, -0.1, 0.05)
        (t,), (tx,), (ty,) = grain(np.array([[x, y, 0.009]]))
        grainy = GRAINY if isinstance(law, dict) else replace(GRAINY, damping_n_s_per_m=3.0)
        touch = WithMaterials(law=law).touch(level(grainy))
        push = K * (0.001 + t) - 3.0 * (vz - tx * vx - ty * vy)
        assert abs(tx * vx) > 0.01
        assert touch.force(HapticState((x, y, 0.009), (vx, vy, vz))) == pytest.approx(
            (-tx * push, -ty * push, push), abs=1e-6
        )

    def test_push_under_a_lateral_law_is_the_depth(self):
        path = stroke()
        t, tx, ty = grain(path)
        push = K * (0.001 + t)
        force = WithMaterials(law="lateral-gradient").touch(level(GRAINY)).path(path)
        assert np.allclose(force, -push[:, None] * np.column_stack([tx, ty, 0 * tx]), atol=1e-6)

    def test_closed_paths_gain_no_energy(self):
        """The potential of penalty-gradient is one with a texture as well; a sum of chords errs a little."""
        turn = np.linspace(0, 2 * np.pi, 200001)
        loop = np.column_stack([0.02 * np.cos(turn), 0.015 * np.sin(turn), 0.002 + 0.001 * np.sin(3 * turn)])
        surface = waves(shape=(512, 512)).surface
        for material in (PLAIN, GRAINY):
            force = WithMaterials(law="penalty-gradient").touch(cover(surface, material)).path(loop)
            parts = (force[1:] + force[:-1]) / 2 * np.diff(loop, axis=0)
            assert abs(parts.sum()) <= 2e-5 * np.abs(parts).sum()


class TestDamping:
    @pytest.mark.parametrize("law", PUSHING)
    def test_damping_acts_along_the_push_and_never_pulls(self, law: str):
        oily = replace(PLAIN, damping_n_s_per_m=4.0)
        still = WithMaterials(law=law).touch(level(oily)).force(HapticState((0.0, 0.0, 0.009))).z
        for speed in (-0.25, 0.01, 100.0):
            force = WithMaterials(law=law).touch(level(oily)).force(HapticState((0.0, 0.0, 0.009), (0.3, 0.1, speed)))
            assert force == pytest.approx((0, 0, max(0.0, still - 4 * speed)), abs=1e-9)

    @pytest.mark.parametrize("law", LATERAL)
    def test_lateral_law_has_no_damping(self, law: str):
        state = HapticState((0.001, 0.002, 0.001), (0.1, 0.2, 0.3))
        surface = MAPS["waves"]
        plain = load_method("render", law)().touch(surface)
        oily = WithMaterials(law=law).touch(cover(surface, replace(PLAIN, damping_n_s_per_m=4.0)))
        assert oily.force(state) == plain.force(state)
        assert isinstance(oily, CompiledTouch) and isinstance(plain, CompiledTouch)
        assert oily.tick is plain.tick  # and so nothing is wrapped around it


@pytest.mark.parametrize("law", PUSHING + LATERAL)
@pytest.mark.parametrize("name", ["sand", "rubber", "water", "grass"])
def test_material_forces_take_energy_from_a_hand_at_one_height(law: str, name: str):
    """A wild lateral path on level ground has negative work up to any moment."""
    random = np.random.default_rng(5)
    path = np.column_stack([np.cumsum(random.normal(0, 1e-4, (4000, 2)), axis=0), np.full(4000, 0.009)])
    force = WithMaterials(law=law).touch(level(replace(library()[name], roughness_m=0.0))).path(path)
    given = np.cumsum(np.sum(force[1:, :2] * np.diff(path[:, :2], axis=0), axis=1))
    assert given.max() <= 1e-12 and given[-1] < -1e-4


@pytest.mark.parametrize("law", PUSHING)
@pytest.mark.parametrize(
    "material", [STICKY, RUBBER, replace(RUBBER, static_friction=5.0)], ids=["plain", "slip", "grip"]
)
def test_pressing_and_easing_gains_nothing(law: str, material: Material):
    """On level ground each of these force laws has a convex potential: whatever the hand does in all three
    dimensions, what it has been given up to any moment since it was in free air is less than nothing."""
    random = np.random.default_rng(8)
    steps = random.normal(0, 1, (20000, 3)) * random.choice([1e-5, 1e-4, 5e-4], (20000, 1)) * [1, 1, 2]
    path = np.cumsum(steps, axis=0)
    path[:, 2] = 0.008 + np.abs((path[:, 2] + 0.002) % 0.0088 - 0.0044)  # up and down, from free air to 2 mm deep
    path[:, :2] = np.abs((path[:, :2] + 0.03) % 0.12 - 0.06) - 0.03
    path[0, 2] = 0.012
    force = WithMaterials(law=law).touch(level(material)).path(path)
    given = np.cumsum(np.sum(force[1:] * np.diff(path, axis=0), axis=1))
    assert given.max() <= 1e-12 and given[-1] < -0.01


@pytest.mark.parametrize("law", PUSHING + LATERAL)
def test_force_on_a_wild_hand_is_bounded(law: str):
    """Friction is within its cone, and the slopes of a texture turn a force by no more than they are steep."""
    random = np.random.default_rng(9)
    path = random.uniform(-0.042, 0.042, (5000, 3)) * [1, 1, 0.2]
    path[::97] = np.nan
    for name in ("brick", "skin"):
        material = replace(library()[name], damping_n_s_per_m=0.0)
        surface = cover(MAPS["waves"], material)
        alone = load_method("render", law)().touch(surface).path(path)
        force = WithMaterials(law=law).touch(surface).path(path)
        assert np.isfinite(force).all()
        most = np.linalg.norm(alone, axis=1).max() + material.stiffness_n_per_m * 0.02
        assert np.linalg.norm(force, axis=1).max() <= 4 * most


def test_touch_reports_the_greatest_stiffness():
    """The law's, or that of the bristle, which is the stiffest material's; without friction there is no bristle."""
    labels = np.arange(4096, dtype=np.int32).reshape(64, 64) % 2
    soft, hard = (replace(STICKY, name=str(k), stiffness_n_per_m=k) for k in (300.0, 2000.0))
    surface = HapticSurface.from_heights(np.full((64, 64), 0.01), 0.08, labels, (soft, hard))
    for law, friction, expected in (
        ("grey-level", True, 2000.0),
        ("grey-level", False, 0.0),
        ("penalty", False, 2000.0),
    ):
        touch = WithMaterials(law=law, friction=friction).touch(surface)
        assert isinstance(touch, CompiledTouch)
        assert touch.stiffness_n_per_m == expected
    nowhere = replace(STICKY, name="nowhere", stiffness_n_per_m=9000.0)
    more = WithMaterials(law="grey-level").touch(HapticSurface(surface.relief, labels, (soft, hard, nowhere)))
    assert isinstance(more, CompiledTouch)
    assert more.stiffness_n_per_m == 2000.0
    lateral = WithMaterials(law="tangible-mask").touch(surface)
    assert isinstance(lateral, CompiledTouch)
    assert lateral.stiffness_n_per_m == 2000.0


def test_friction_of_two_materials_is_one_bristle():
    """No energy is stored on the way from one material to the other that was not given."""
    labels = np.zeros((64, 64), np.int32)
    labels[:, 32:] = 1
    soft = replace(STICKY, name="soft", stiffness_n_per_m=200.0)
    surface = HapticSurface.from_heights(np.full((64, 64), 0.01), 0.08, labels, (STICKY, soft))
    x = np.concatenate([np.linspace(a, b, 500) for a, b in pairwise([-0.001, 0.0005, -0.0004, 0.0008, -0.001])])
    force = WithMaterials(law="penalty").touch(surface).path(np.column_stack([x, 0 * x, np.full_like(x, 0.009)]))
    assert np.cumsum(force[1:, 0] * np.diff(x)).max() <= 1e-12

"""Materials around any law: friction, texture and damping are exact, passive, and no law is changed without them."""

import pickle
from copy import deepcopy
from dataclasses import replace
from itertools import pairwise
from typing import ClassVar

import numpy as np
import pytest
from pydantic import Field, ValidationError

from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import Force, HapticState, HapticSurface, Material
from tangible_core.haptic_textures import compile_textures
from tangible_core.haptic_textures.heights import texture_height
from tangible_core.materials.assignment import library
from tangible_core.plugins.interfaces import ForceRenderer, PlainTouch, Touch
from tangible_core.plugins.registry import load_method
from tangible_core.testing.synthetic.reliefs import waves
from tangible_core.testing.synthetic.rough import rough_surfaces
from tangible_core.testing.synthetic.scenes import ramp
from tangible_render.with_materials import WithMaterials

PUSHING = ("penalty", "penalty-gradient", "force-shading", "grey-level")
LATERAL = ("lateral-gradient", "lateral-shape", "tangible-mask")
K = 600.0
PLAIN = Material("bare", K, 0.0, 0.0, 0.0)
STICKY = replace(PLAIN, name="sticky", static_friction=0.8, dynamic_friction=0.5)
GRAINY = replace(PLAIN, name="grainy", roughness_m=1e-4)
RUBBER = replace(library()["rubber"], stiffness_n_per_m=K, roughness_m=0.0, damping_n_s_per_m=0.0)
MAPS = rough_surfaces()


def covered(surface: HapticSurface, material: Material) -> HapticSurface:
    return HapticSurface(surface.relief, np.zeros(surface.height_m.shape, np.int32), (material,))


def level(material: Material) -> HapticSurface:
    return covered(HapticSurface.from_heights(np.full((64, 64), 0.01)), material)


def stroke(length_m: float = 0.01, z: float = 0.009, ticks: int = 5000) -> np.ndarray:
    x = np.linspace(0, length_m, ticks)
    return np.column_stack([x, 0 * x, np.full_like(x, z)])


def grain(path: np.ndarray) -> np.ndarray:
    """(3, n): height and slopes of GRAINY along a path."""
    table, steps = compile_textures([GRAINY]), np.diff(path, axis=0, prepend=path[:1])
    made = [texture_height(table, 0, *at[:2], *step[:2], 1.0) for at, step in zip(path, steps, strict=True)]
    return np.transpose(made)


class TestFriction:
    @pytest.mark.parametrize("law", PUSHING)
    def test_it_sticks_up_to_the_static_friction_and_slides_on_the_dynamic_one(self, law: str):
        path = stroke()
        force = WithMaterials(law=law).touch(level(STICKY)).path(path)
        ratio = -force[:, 0] / force[:, 2]
        slip = int(ratio.argmax())
        assert np.allclose(-force[: slip + 1, 0], K * path[: slip + 1, 0], atol=1e-9)
        assert ratio[slip] == pytest.approx(0.8, abs=2e-3)
        assert np.allclose(ratio[slip + 1 :], 0.5, atol=2e-3)
        assert np.allclose(force[:, 1], 0, atol=1e-9)

    @pytest.mark.parametrize("law", LATERAL)
    def test_under_a_lateral_law_the_depth_is_the_push(self, law: str):
        force = WithMaterials(law=law).touch(level(STICKY)).path(stroke())
        assert -force[:, 0].min() == pytest.approx(0.8 * K * 0.001, rel=5e-3)
        assert np.allclose(force[-1000:], [-0.5 * K * 0.001, 0, 0], atol=1e-3)

    @pytest.mark.parametrize("steepness", [0.3, 3.0])
    def test_it_lies_along_a_slope_however_steep(self, steepness: float):
        known = ramp((0.0, steepness), 0.15)
        path = np.array([known.at(0.002, y, 0.001) for y in np.linspace(-0.01, 0.01, 20000).tolist()])
        force = WithMaterials(law="penalty-gradient").touch(covered(known.surface, STICKY)).path(path)[10000:]
        normal = known.normal(0, 0)
        push, along = force @ normal, force @ np.array([0, normal[2], -normal[1]])
        assert np.allclose(push, K * 0.001 / normal[2], rtol=1e-3)
        assert np.allclose(along, -0.5 * push, rtol=1e-3)
        assert np.allclose(force[:, 0], 0, atol=1e-6)

    @pytest.mark.parametrize("way", [(0.0, 0.8, 0.6), (0.6, 0.0, 0.0), (0.0, 0.0, -1.0)], ids=["up", "across", "down"])
    def test_what_sticks_is_stretched_by_the_way_along_the_surface(self, way: tuple[float, float, float]):
        """On a slope of 3 in 4: of a way straight down, by what of it lies along."""
        known = ramp((0.0, 0.75), 0.05)
        touch = WithMaterials(law="penalty-gradient").touch(covered(known.surface, STICKY))
        alone = load_method("render", "penalty-gradient")().touch(covered(known.surface, STICKY))
        start, normal = np.array(known.at(0.0, 0.0, 0.001)), known.normal(0, 0)
        touch.force(HapticState(tuple(start.tolist())))
        end = HapticState(tuple((start + 2e-4 * np.array(way)).tolist()))
        stretched = 2e-4 * (np.array(way) - (way @ normal) * normal)
        assert np.subtract(touch.force(end), alone.force(end)) == pytest.approx(-K * stretched, abs=1e-6)

    @pytest.mark.parametrize("material", [STICKY, RUBBER], ids=lambda each: each.name)
    @pytest.mark.parametrize("law", PUSHING + LATERAL)
    def test_no_direction_is_another(self, law: str, material: Material):
        """On level ground, back and forth."""
        path = np.vstack([stroke(0.008, ticks=500), stroke(0.008, ticks=300)[::-1]])
        expected = WithMaterials(law=law).touch(level(material)).path(path)
        for turn in (np.pi / 2, 2.5, -1.0):
            turned = np.array([[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
            found = WithMaterials(law=law).touch(level(material)).path(path @ turned)
            assert np.allclose(found, expected @ turned, rtol=0, atol=1e-6)

    @pytest.mark.parametrize("law", PUSHING + LATERAL)
    def test_beside_the_surface_there_is_none(self, law: str):
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
    def test_each_contact_is_the_first(self, law: str, material: Material, between: tuple[float, float, float]):
        """Wherever the hand was, its first tick has no friction, and the next are those of a new touch."""
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


class TestTexture:
    @pytest.mark.parametrize("smooth", [PLAIN, STICKY], ids=lambda each: each.name)
    @pytest.mark.parametrize("law", PUSHING)
    def test_it_is_the_law_below_turned_by_the_texture(self, law: str, smooth: Material):
        """Friction included: it goes along with the hand as the law sees it."""
        turn = np.linspace(0, 6, 6000)
        path = np.column_stack([0.03 * np.sin(3 * turn), 0.03 * np.cos(2 * turn), 0.003 + 0.002 * np.sin(9 * turn)])
        t, tx, ty = grain(path)
        surface = MAPS["waves"]
        below = WithMaterials(law=law).touch(covered(surface, smooth)).path(path - t[:, None] * [0, 0, 1])
        expected = below - below[:, 2:] * np.column_stack([tx, ty, 0 * tx])
        found = (
            WithMaterials(law=law).touch(covered(surface, replace(smooth, roughness_m=1e-4, name="grainy"))).path(path)
        )
        assert np.allclose(found, expected, rtol=0, atol=1e-9)

    @pytest.mark.parametrize("law", [{"use": "penalty-gradient", "damping_n_s_per_m": 3.0}, "penalty-gradient"])
    def test_damping_is_of_the_speed_over_the_texture(self, law: str | dict[str, object]):
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

    def test_under_a_lateral_law_the_depth_is_the_push(self):
        path = stroke()
        t, tx, ty = grain(path)
        push = K * (0.001 + t)
        force = WithMaterials(law="lateral-gradient").touch(level(GRAINY)).path(path)
        assert np.allclose(force, -push[:, None] * np.column_stack([tx, ty, 0 * tx]), atol=1e-6)

    def test_no_closed_path_gains_energy(self):
        """The potential of penalty-gradient is one with a texture as well; a sum of chords errs a little."""
        turn = np.linspace(0, 2 * np.pi, 200001)
        loop = np.column_stack([0.02 * np.cos(turn), 0.015 * np.sin(turn), 0.002 + 0.001 * np.sin(3 * turn)])
        surface = waves(shape=(512, 512)).surface
        for material in (PLAIN, GRAINY):
            force = WithMaterials(law="penalty-gradient").touch(covered(surface, material)).path(loop)
            parts = (force[1:] + force[:-1]) / 2 * np.diff(loop, axis=0)
            assert abs(parts.sum()) <= 2e-5 * np.abs(parts).sum()


class TestDamping:
    @pytest.mark.parametrize("law", PUSHING)
    def test_it_acts_along_the_push_and_never_pulls(self, law: str):
        oily = replace(PLAIN, damping_n_s_per_m=4.0)
        still = WithMaterials(law=law).touch(level(oily)).force(HapticState((0.0, 0.0, 0.009))).z
        for speed in (-0.25, 0.01, 100.0):
            force = WithMaterials(law=law).touch(level(oily)).force(HapticState((0.0, 0.0, 0.009), (0.3, 0.1, speed)))
            assert force == pytest.approx((0, 0, max(0.0, still - 4 * speed)), abs=1e-9)

    @pytest.mark.parametrize("law", LATERAL)
    def test_a_lateral_law_has_none(self, law: str):
        state = HapticState((0.001, 0.002, 0.001), (0.1, 0.2, 0.3))
        surface = MAPS["waves"]
        plain = load_method("render", law)().touch(surface)
        oily = WithMaterials(law=law).touch(covered(surface, replace(PLAIN, damping_n_s_per_m=4.0)))
        assert oily.force(state) == plain.force(state)
        assert isinstance(oily, CompiledTouch) and isinstance(plain, CompiledTouch)
        assert oily.tick is plain.tick  # and so nothing is wrapped around it


@pytest.mark.parametrize("law", PUSHING + LATERAL)
@pytest.mark.parametrize("name", ["sand", "rubber", "water", "grass"])
def test_what_materials_add_takes_energy_from_a_hand_at_rest_in_height(law: str, name: str):
    """On level ground, without heights: a wild lateral path, force at a tick's end times its step, up to any moment."""
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
    """On level ground, where each of these laws has a potential that is convex: whatever the hand does in all three
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
def test_a_wild_hand_is_never_pushed_wildly(law: str):
    """Friction is within its cone, and the slopes of a texture turn a force by no more than they are steep."""
    random = np.random.default_rng(9)
    path = random.uniform(-0.042, 0.042, (5000, 3)) * [1, 1, 0.2]
    path[::97] = np.nan
    for name in ("brick", "skin"):
        material = replace(library()[name], damping_n_s_per_m=0.0)
        surface = covered(MAPS["waves"], material)
        alone = load_method("render", law)().touch(surface).path(path)
        force = WithMaterials(law=law).touch(surface).path(path)
        assert np.isfinite(force).all()
        most = np.linalg.norm(alone, axis=1).max() + material.stiffness_n_per_m * 0.02
        assert np.linalg.norm(force, axis=1).max() <= 4 * most


def test_it_says_the_greatest_stiffness():
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


class TestLeftOut:
    @pytest.mark.parametrize("law", PUSHING + LATERAL)
    def test_a_surface_to_which_nothing_is_added_has_the_law_itself(self, law: str):
        bare = load_method("render", law)().touch(level(PLAIN))
        for renderer, surface in (
            (WithMaterials(law=law), level(PLAIN)),
            (WithMaterials(law=law), HapticSurface.from_heights(np.full((64, 64), 0.01))),
            (WithMaterials(law=law, friction=False, texture=False, damping=False), level(library()["rubber"])),
        ):
            touch = renderer.touch(surface)
            assert isinstance(touch, CompiledTouch) and isinstance(bare, CompiledTouch)
            assert touch.tick is bare.tick

    @pytest.mark.parametrize(("part", "name"), [("friction", "sticky"), ("texture", "grainy"), ("damping", "oily")])
    def test_each_part_is_left_out_by_itself(self, part: str, name: str):
        """Without the one thing that a material has, it is the law."""
        material = {"sticky": STICKY, "grainy": GRAINY, "oily": replace(PLAIN, damping_n_s_per_m=3.0)}[name]
        on, off = (WithMaterials(law="penalty", **{part: value}).touch(level(material)) for value in (True, False))
        path = stroke() + np.linspace(0, 1e-3, 5000)[:, None] * [0, 0, -1]
        alone = load_method("render", "penalty")().touch(level(material)).path(path)
        assert np.array_equal(off.path(path), alone)
        assert not np.allclose(on.path(path), alone, atol=1e-4)

    def test_a_material_may_be_named_for_a_surface_that_has_none(self):
        bare = HapticSurface.from_heights(np.full((64, 64), 0.01))
        named = WithMaterials(law="penalty", material="rubber").touch(bare).path(stroke())
        assert np.array_equal(named, WithMaterials(law="penalty").touch(level(library()["rubber"])).path(stroke()))
        ice = WithMaterials(law="penalty", material="rubber").touch(level(library()["ice"])).path(stroke())
        assert np.array_equal(ice, WithMaterials(law="penalty").touch(level(library()["ice"])).path(stroke()))


class TestOptions:
    def test_a_law_is_a_name_or_a_block(self):
        short, long = WithMaterials(law="penalty"), WithMaterials(law={"use": "penalty", "stiffness_n_per_m": 800})
        assert short == long
        assert short.law["use"] == "penalty" and short.law["dequantise"] == "auto"
        surface = HapticSurface.from_heights(np.full((8, 8), 0.01))
        stiff = WithMaterials(law={"use": "penalty", "stiffness_n_per_m": 1200})
        assert stiff.touch(surface).force(HapticState((0.0, 0.0, 0.009))).z == pytest.approx(1.2, rel=1e-5)

    @pytest.mark.parametrize(
        ("law", "said"),
        [
            ("penalti", "did you mean 'penalty'"),
            ({"use": "penalty", "stifness_n_per_m": 1}, "stifness_n_per_m"),
            ({"use": "penalty", "stiffness_n_per_m": -1}, "greater than 0"),
            ({"stiffness_n_per_m": 1}, "a law has a name"),
            ("proxy", "proxy renders materials itself"),
            ("with-materials", "with-materials renders materials itself"),
        ],
    )
    def test_a_law_that_is_none(self, law: object, said: str):
        with pytest.raises(ValidationError, match=said):
            WithMaterials(law=law)  # pyright: ignore[reportArgumentType]

    def test_a_material_that_is_not_shipped(self):
        with pytest.raises(ValidationError, match="did you mean 'sand'"):
            WithMaterials(material="sandy")


class Named(ForceRenderer):
    """The law of `penalty`, or another that is shipped, with an option called friction that is no material's."""

    friction: float = 0.25
    """How hard its author finds physics."""

    law: str = "penalty"
    options: dict[str, float] = Field(default_factory=dict)

    def touch(self, surface: HapticSurface) -> Touch:
        return load_method("render", self.law)(**self.options).touch(surface)


class Unnamed(ForceRenderer):
    """Renders materials, by whatever its options are called."""

    renders_materials: ClassVar[bool] = True
    stickiness: float = 0.5

    def touch(self, surface: HapticSurface) -> Touch:
        return load_method("render", "proxy")().touch(surface)


class Told(PlainTouch):
    """Another law, as if it were Python's; it keeps what it was asked."""

    def __init__(self, law: Touch) -> None:
        self.law, self.asked = law, []
        self.stiffness_n_per_m = law.stiffness_n_per_m

    def force(self, state: HapticState) -> Force:
        self.asked.append(state)
        return self.law.force(state)


class InPython(Named):
    def touch(self, surface: HapticSurface) -> Touch:
        return Told(super().touch(surface))


class Sideways(InPython):
    is_lateral: ClassVar[bool] = True
    law: str = "lateral-shape"


class Drawn(ForceRenderer):
    """Says that it is lateral, and gives no force at all: what is felt is the materials' alone."""

    is_lateral: ClassVar[bool] = True

    def touch(self, surface: HapticSurface) -> Touch:
        class Nothing(PlainTouch):
            stiffness_n_per_m = 0.0

            def force(self, state: HapticState) -> Force:
                return Force(0.0, 0.0, 0.0)

        return Nothing()


class Undrawn(Drawn):
    is_lateral: ClassVar[bool] = False


MADE_UP = {"named": Named, "unnamed": Unnamed, "in-python": InPython, "sideways": Sideways}
MADE_UP |= {"drawn": Drawn, "undrawn": Undrawn}
DAMPED = {"damping_n_s_per_m": 2.0}


@pytest.fixture
def made_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """These laws, installed."""
    monkeypatch.setattr(
        "tangible_core.plugins.registry.load_method",
        lambda kind, name: MADE_UP[name] if name in MADE_UP else load_method(kind, name),
    )


@pytest.mark.usefixtures("made_up")
class TestFacts:
    """What a law says of itself counts, not what its options are called or what it gives on level ground."""

    def test_an_option_called_friction_is_no_material(self):
        surface = level(STICKY)
        found = WithMaterials(law="named").touch(surface).path(stroke())
        assert np.array_equal(found, WithMaterials(law="penalty").touch(surface).path(stroke()))

    def test_a_law_that_renders_materials_by_another_name_is_refused(self):
        with pytest.raises(ValidationError, match="unnamed renders materials itself; use it as it is"):
            WithMaterials(law="unnamed")

    def test_a_law_that_says_it_is_lateral_leaves_the_push_to_the_table(self):
        """Friction of a push of k d under a law that says so, and none under one that only gives no force."""
        lateral = WithMaterials(law="drawn").touch(level(STICKY)).path(stroke())
        assert lateral[-1] == pytest.approx((-0.5 * K * 0.001, 0, 0), rel=1e-5)
        assert not WithMaterials(law="undrawn").touch(level(STICKY)).path(stroke()).any()

    @pytest.mark.parametrize("law", [*PUSHING, *LATERAL])
    def test_the_laws_that_are_shipped(self, law: str):
        cls = load_method("render", law)
        assert issubclass(cls, ForceRenderer)
        assert (cls.is_lateral, cls.renders_materials) == (law in LATERAL, False)


@pytest.mark.usefixtures("made_up")
class TestPlainLaw:
    """Around a law in plain Python, to the last bit what is felt around the same law compiled."""

    @pytest.mark.parametrize(
        ("plain", "compiled"),
        [
            *[({"use": "in-python", "law": law}, law) for law in PUSHING],
            ({"use": "in-python", "options": DAMPED}, {"use": "penalty", **DAMPED}),
            ("sideways", "lateral-shape"),
        ],
    )
    @pytest.mark.parametrize("material", [STICKY, GRAINY, RUBBER, replace(STICKY, damping_n_s_per_m=3.0)])
    def test_it_feels_the_same(self, plain: str | dict, compiled: str | dict, material: Material):
        surface = covered(waves().surface, material)
        path = stroke(0.03, 0.0, 400) + [0, 0, 1] * np.linspace(0.012, 0.0, 400)[:, None]
        path[200] = np.nan
        told, known = (WithMaterials(law=law).touch(surface) for law in (plain, compiled))
        assert not isinstance(told, CompiledTouch) and isinstance(known, CompiledTouch)
        assert told.stiffness_n_per_m == known.stiffness_n_per_m
        expected = known.path(path)
        assert expected[150:].any()
        assert told.path(path).tobytes() == expected.tobytes()

    def test_the_law_is_asked_once_a_tick_with_the_time_and_the_buttons(self):
        touch = WithMaterials(law="in-python").touch(level(GRAINY))
        touch.force(HapticState((0.001, 0.002, 0.009), (0.1, 0.2, 0.3), 7.0, 5))
        (asked,) = touch._law.asked  # pyright: ignore[reportAttributeAccessIssue]
        assert asked.position_m[:2] == (0.001, 0.002) and asked.position_m[2] != 0.009
        assert (asked.time_s, asked.buttons) == (7.0, 5)

    @pytest.mark.parametrize("copy", [deepcopy, lambda touch: pickle.loads(pickle.dumps(touch))])
    def test_a_copy_feels_by_itself(self, copy):
        """As one is asked for the law's stiffness, and one is felt in the loop's process."""
        first = WithMaterials(law="in-python").touch(level(STICKY))
        path = stroke(ticks=50)
        first.path(path[:20])
        second = copy(first)
        assert second.path(path[20:]).tobytes() == first.path(path[20:]).tobytes()


def test_friction_of_two_materials_is_one_bristle():
    """From one to the other nothing is stored that was not given."""
    labels = np.zeros((64, 64), np.int32)
    labels[:, 32:] = 1
    soft = replace(STICKY, name="soft", stiffness_n_per_m=200.0)
    surface = HapticSurface.from_heights(np.full((64, 64), 0.01), 0.08, labels, (STICKY, soft))
    x = np.concatenate([np.linspace(a, b, 500) for a, b in pairwise([-0.001, 0.0005, -0.0004, 0.0008, -0.001])])
    force = WithMaterials(law="penalty").touch(surface).path(np.column_stack([x, 0 * x, np.full_like(x, 0.009)]))
    assert np.cumsum(force[1:, 0] * np.diff(x)).max() <= 1e-12

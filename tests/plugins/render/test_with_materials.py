"""A surface would not stick, slide or feel rough as its material says, or a law change what is switched off."""

import pickle
from copy import deepcopy
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from pydantic import Field

from rough_surfaces import rough_surfaces
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import Force, HapticState, HapticSurface, Material, digest_of
from tangible_core.errors import OptionError
from tangible_core.materials.assignment import library
from tangible_core.plugins.interfaces import ForceRenderer, PlainTouch, Touch
from tangible_core.plugins.registry import load_method
from tangible_core.testing.synthetic.scenes import ramp, waves
from tangible_render.effects.effects_table import effects_table, material_table
from tangible_render.haptic_textures import compile_textures
from tangible_render.haptic_textures.heights import texture_height
from tangible_render.haptic_textures.table import STIFFNESS
from tangible_render.with_materials import WithMaterials

PUSHING = ("penalty", "penalty-gradient", "force-shading", "grey-level")
LATERAL = ("lateral-gradient", "lateral-shape", "tangible-mask")
K = 600.0
PLAIN = Material("bare", K, 0.0, 0.0, 0.0)
STICKY = replace(PLAIN, name="sticky", static_friction=0.8, dynamic_friction=0.5)
GRAINY = replace(PLAIN, name="grainy", roughness_m=1e-4)
RUBBER = replace(library()["rubber"], stiffness_n_per_m=K, roughness_m=0.0, damping_n_s_per_m=0.0)


def cover(surface: HapticSurface, material: Material) -> HapticSurface:
    return HapticSurface(surface.relief, np.zeros(surface.height_m.shape, np.int32), (material,))


def level(material: Material) -> HapticSurface:
    return cover(HapticSurface.from_heights(np.full((64, 64), 0.01)), material)


def stroke(length_m: float = 0.01, z: float = 0.009, ticks: int = 5000) -> np.ndarray:
    x = np.linspace(0, length_m, ticks)
    return np.column_stack([x, 0 * x, np.full_like(x, z)])


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
        "between", [(0.05, 0.0, 0.009), (np.nan, 0.0, 0.009), (0.003, 0.0052, 0.009)], ids=["beside", "lost", "leapt"]
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


def test_table_has_one_row_a_material_and_what_is_on():
    halves = np.int32([[0, 1]])
    surface = HapticSurface.from_heights(np.zeros((1, 2)), 0.02, halves, (STICKY, RUBBER))
    labels, table = effects_table(surface)
    assert labels.tolist() == halves.tolist()
    assert table[:, -4:].tolist() == [[K, 0, 0.8, 0.5], [K, 0, 0, 0]]
    assert (table[:, STIFFNESS] > 0).tolist() == [False, True]
    _, smooth = effects_table(surface, friction=False)
    assert smooth[:, -4:].tolist() == [[K, 0, 0, 0]] * len(smooth)
    assert not smooth[:, STIFFNESS].any()
    whole, halves = np.int32([[1, 1]]), np.int32([[0, 1]])
    for labels, size in ((whole, 1), (halves, 2)):
        surface = HapticSurface.from_heights(np.zeros((1, 2)), 0.02, labels, (STICKY, PLAIN))
        for found, table in (effects_table(surface), material_table(surface, (1.0, 1.0, 1.0, 1.0))):
            assert found.shape == (1, size)
            assert table[:, -4:].tolist() == [[K, 0, 0.8, 0.5], [K, 0, 0, 0]][-size:]


class TestTexture:
    @pytest.mark.parametrize("smooth", [PLAIN, STICKY], ids=lambda each: each.name)
    @pytest.mark.parametrize("law", PUSHING)
    def test_force_is_that_of_the_inner_law_transformed(self, law: str, smooth: Material):
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


class TestDamping:
    @pytest.mark.parametrize("law", PUSHING)
    def test_damping_acts_along_the_push_and_never_pulls(self, law: str):
        oily = replace(PLAIN, damping_n_s_per_m=4.0)
        still = WithMaterials(law=law).touch(level(oily)).force(HapticState((0.0, 0.0, 0.009))).z
        for speed in (-0.25, 0.01, 100.0):
            force = WithMaterials(law=law).touch(level(oily)).force(HapticState((0.0, 0.0, 0.009), (0.3, 0.1, speed)))
            assert force == pytest.approx((0, 0, max(0.0, still - 4 * speed)), abs=1e-9)


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


class TestOmissions:
    @pytest.mark.parametrize("law", PUSHING + LATERAL)
    def test_surface_without_effects_has_the_inner_touch(self, law: str):
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
    def test_effects_are_disabled_one_by_one(self, part: str, name: str):
        material = {"sticky": STICKY, "grainy": GRAINY, "oily": replace(PLAIN, damping_n_s_per_m=3.0)}[name]
        on, off = (WithMaterials(law="penalty", **{part: value}).touch(level(material)) for value in (True, False))
        path = stroke() + np.linspace(0, 1e-3, 5000)[:, None] * [0, 0, -1]
        alone = load_method("render", "penalty")().touch(level(material)).path(path)
        assert np.array_equal(off.path(path), alone)
        assert not np.allclose(on.path(path), alone, atol=1e-4)


class TestOptions:
    def test_law_option_is_a_name_or_a_block(self):
        short, long = WithMaterials(law="penalty"), WithMaterials(law={"use": "penalty", "stiffness_n_per_m": 800})
        assert short == long
        assert short.law["use"] == "penalty" and short.law["dequantise"] == "auto"
        surface = HapticSurface.from_heights(np.full((8, 8), 0.01))
        stiff = WithMaterials(law={"use": "penalty", "stiffness_n_per_m": 1200})
        assert stiff.touch(surface).force(HapticState((0.0, 0.0, 0.009))).z == pytest.approx(1.2, rel=1e-5)

    @pytest.mark.parametrize(
        "options",
        [
            {"law": "penalti"},
            {"law": {"use": "penalty", "stiffness_n_per_m": -1}},
            {"law": {"stiffness_n_per_m": 1}},
            {"law": "proxy"},
            {"law": "with-materials"},
            {"material": "sandy"},
        ],
    )
    def test_wrong_options_are_refused(self, options: dict):
        with pytest.raises(OptionError):
            WithMaterials(**options)


class Named(ForceRenderer):
    """The force law `penalty`, or another one, with an option called friction unrelated to materials."""

    friction: float = 0.25
    """An option of an unrelated meaning."""

    law: str = "penalty"
    options: dict[str, float] = Field(default_factory=dict)

    def touch(self, surface: HapticSurface) -> Touch:
        return load_method("render", self.law)(**self.options).touch(surface)


class PythonTouch(PlainTouch):
    """A compiled law's touch as plain Python."""

    def __init__(self, law: Touch) -> None:
        self.law, self.stiffness_n_per_m = law, law.stiffness_n_per_m

    def force(self, state: HapticState) -> Force:
        return self.law.force(state)


class InPython(Named):
    def touch(self, surface: HapticSurface) -> Touch:
        return PythonTouch(super().touch(surface))


class Sideways(InPython):
    is_lateral: ClassVar[bool] = True
    law: str = "lateral-shape"


LAWS = {"named": Named, "in-python": InPython, "sideways": Sideways}
DAMPED = {"damping_n_s_per_m": 2.0}


@pytest.fixture
def installed_laws(monkeypatch: pytest.MonkeyPatch) -> None:
    """Install these force laws."""
    monkeypatch.setattr(
        "tangible_core.plugins.registry.load_method",
        lambda kind, name: LAWS[name] if name in LAWS else load_method(kind, name),
    )


@pytest.mark.usefixtures("installed_laws")
class TestPlainLaw:
    """Forces around a law in plain Python match those around its compiled form to the last bit."""

    @pytest.mark.parametrize(
        ("plain", "compiled"),
        [
            ({"use": "in-python", "law": "penalty-gradient"}, "penalty-gradient"),
            ({"use": "in-python", "options": DAMPED}, {"use": "penalty", **DAMPED}),
            ("sideways", "lateral-shape"),
        ],
    )
    @pytest.mark.parametrize("material", [STICKY, GRAINY, RUBBER, replace(STICKY, damping_n_s_per_m=3.0)])
    def test_plain_law_has_the_forces_of_the_compiled_one(
        self, plain: str | dict, compiled: str | dict, material: Material
    ):
        surface = cover(waves().surface, material)
        path = stroke(0.03, 0.0, 400) + [0, 0, 1] * np.linspace(0.012, 0.0, 400)[:, None]
        path[200] = np.nan
        in_python, in_kernel = (WithMaterials(law=law).touch(surface) for law in (plain, compiled))
        assert not isinstance(in_python, CompiledTouch) and isinstance(in_kernel, CompiledTouch)
        assert in_python.stiffness_n_per_m == in_kernel.stiffness_n_per_m
        expected = in_kernel.path(path)
        assert expected[150:].any()
        assert digest_of(in_python.path(path)) == digest_of(expected)

    @pytest.mark.parametrize("copy", [deepcopy, lambda touch: pickle.loads(pickle.dumps(touch))])
    def test_copy_of_a_touch_has_its_own_memory(self, copy):
        first = WithMaterials(law="in-python").touch(level(STICKY))
        path = stroke(ticks=50)
        first.path(path[:20])
        second = copy(first)
        assert digest_of(second.path(path[20:])) == digest_of(first.path(path[20:]))

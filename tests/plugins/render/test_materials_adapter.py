"""`with-materials` around laws of every kind: omitted effects, options, facts of laws, and laws in plain Python."""

import pickle
from copy import deepcopy
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from pydantic import Field

from materials_on_laws import GRAINY, LATERAL, PLAIN, PUSHING, RUBBER, STICKY, K, cover, level, stroke
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import Force, HapticState, HapticSurface, Material, digest_of
from tangible_core.errors import OptionError
from tangible_core.materials.assignment import library
from tangible_core.plugins.interfaces import ForceRenderer, PlainTouch, Touch
from tangible_core.plugins.registry import load_method
from tangible_core.testing.synthetic.reliefs import waves
from tangible_render.with_materials import WithMaterials


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
        """With the only effect of a material disabled, forces are the inner force law's."""
        material = {"sticky": STICKY, "grainy": GRAINY, "oily": replace(PLAIN, damping_n_s_per_m=3.0)}[name]
        on, off = (WithMaterials(law="penalty", **{part: value}).touch(level(material)) for value in (True, False))
        path = stroke() + np.linspace(0, 1e-3, 5000)[:, None] * [0, 0, -1]
        alone = load_method("render", "penalty")().touch(level(material)).path(path)
        assert np.array_equal(off.path(path), alone)
        assert not np.allclose(on.path(path), alone, atol=1e-4)

    def test_material_option_covers_a_surface_without_materials(self):
        bare = HapticSurface.from_heights(np.full((64, 64), 0.01))
        named = WithMaterials(law="penalty", material="rubber").touch(bare).path(stroke())
        assert np.array_equal(named, WithMaterials(law="penalty").touch(level(library()["rubber"])).path(stroke()))
        ice = WithMaterials(law="penalty", material="rubber").touch(level(library()["ice"])).path(stroke())
        assert np.array_equal(ice, WithMaterials(law="penalty").touch(level(library()["ice"])).path(stroke()))


class TestOptions:
    def test_law_option_is_a_name_or_a_block(self):
        short, long = WithMaterials(law="penalty"), WithMaterials(law={"use": "penalty", "stiffness_n_per_m": 800})
        assert short == long
        assert short.law["use"] == "penalty" and short.law["dequantise"] == "auto"
        surface = HapticSurface.from_heights(np.full((8, 8), 0.01))
        stiff = WithMaterials(law={"use": "penalty", "stiffness_n_per_m": 1200})
        assert stiff.touch(surface).force(HapticState((0.0, 0.0, 0.009))).z == pytest.approx(1.2, rel=1e-5)

    @pytest.mark.parametrize(
        ("law", "message"),
        [
            ("penalti", "did you mean 'penalty'"),
            ({"use": "penalty", "stifness_n_per_m": 1}, "stifness_n_per_m"),
            ({"use": "penalty", "stiffness_n_per_m": -1}, "greater than 0"),
            ({"stiffness_n_per_m": 1}, "a force law needs a name"),
            ("proxy", "proxy renders materials itself"),
            ("with-materials", "with-materials renders materials itself"),
        ],
    )
    def test_law_option_wrong_is_refused(self, law: object, message: str):
        with pytest.raises(OptionError, match=message):
            WithMaterials(law=law)  # pyright: ignore[reportArgumentType]

    def test_material_not_built_in_is_refused(self):
        with pytest.raises(OptionError, match="did you mean 'sand'"):
            WithMaterials(material="sandy")


class Named(ForceRenderer):
    """The force law `penalty`, or another one, with an option called friction unrelated to materials."""

    friction: float = 0.25
    """An option of an unrelated meaning."""

    law: str = "penalty"
    options: dict[str, float] = Field(default_factory=dict)

    def touch(self, surface: HapticSurface) -> Touch:
        return load_method("render", self.law)(**self.options).touch(surface)


class Unnamed(ForceRenderer):
    """A force law that renders materials under options of other names."""

    renders_materials: ClassVar[bool] = True
    stickiness: float = 0.5

    def touch(self, surface: HapticSurface) -> Touch:
        return load_method("render", "proxy")().touch(surface)


class RecordingTouch(PlainTouch):
    """A compiled law's touch as plain Python, which records its states."""

    def __init__(self, law: Touch) -> None:
        self.law, self.states = law, []
        self.stiffness_n_per_m = law.stiffness_n_per_m

    def force(self, state: HapticState) -> Force:
        self.states.append(state)
        return self.law.force(state)


class InPython(Named):
    def touch(self, surface: HapticSurface) -> Touch:
        return RecordingTouch(super().touch(surface))


class Sideways(InPython):
    is_lateral: ClassVar[bool] = True
    law: str = "lateral-shape"


class Drawn(ForceRenderer):
    """A force law declared lateral that gives no force: only the materials' forces remain."""

    is_lateral: ClassVar[bool] = True

    def touch(self, surface: HapticSurface) -> Touch:
        class Nothing(PlainTouch):
            stiffness_n_per_m = 0.0

            def force(self, state: HapticState) -> Force:
                return Force(0.0, 0.0, 0.0)

        return Nothing()


class Undrawn(Drawn):
    is_lateral: ClassVar[bool] = False


LAWS = {"named": Named, "unnamed": Unnamed, "in-python": InPython, "sideways": Sideways}
LAWS |= {"drawn": Drawn, "undrawn": Undrawn}
DAMPED = {"damping_n_s_per_m": 2.0}


@pytest.fixture
def installed_laws(monkeypatch: pytest.MonkeyPatch) -> None:
    """Install these force laws."""
    monkeypatch.setattr(
        "tangible_core.plugins.registry.load_method",
        lambda kind, name: LAWS[name] if name in LAWS else load_method(kind, name),
    )


@pytest.mark.usefixtures("installed_laws")
class TestFacts:
    """A force law's own facts count, not the names of its options or its force on level ground."""

    def test_option_called_friction_is_not_a_material(self):
        surface = level(STICKY)
        found = WithMaterials(law="named").touch(surface).path(stroke())
        assert np.array_equal(found, WithMaterials(law="penalty").touch(surface).path(stroke()))

    def test_law_rendering_materials_under_another_name_is_refused(self):
        with pytest.raises(OptionError, match="unnamed renders materials itself; use it directly"):
            WithMaterials(law="unnamed")

    def test_law_declared_lateral_leaves_the_push_to_the_table(self):
        """A law declared lateral has friction of a push of k d; a law that only gives no force has none."""
        lateral = WithMaterials(law="drawn").touch(level(STICKY)).path(stroke())
        assert lateral[-1] == pytest.approx((-0.5 * K * 0.001, 0, 0), rel=1e-5)
        assert not WithMaterials(law="undrawn").touch(level(STICKY)).path(stroke()).any()

    @pytest.mark.parametrize("law", [*PUSHING, *LATERAL])
    def test_built_in_laws_declare_their_facts(self, law: str):
        cls = load_method("render", law)
        assert issubclass(cls, ForceRenderer)
        assert (cls.is_lateral, cls.renders_materials) == (law in LATERAL, False)


@pytest.mark.usefixtures("installed_laws")
class TestPlainLaw:
    """Forces around a law in plain Python match those around its compiled form to the last bit."""

    @pytest.mark.parametrize(
        ("plain", "compiled"),
        [
            *[({"use": "in-python", "law": law}, law) for law in PUSHING],
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

    def test_plain_law_is_called_once_a_tick_with_time_and_buttons(self):
        touch = WithMaterials(law="in-python").touch(level(GRAINY))
        touch.force(HapticState((0.001, 0.002, 0.009), (0.1, 0.2, 0.3), 7.0, 5))
        (state,) = touch._law.states  # pyright: ignore[reportAttributeAccessIssue]
        assert state.position_m[:2] == (0.001, 0.002) and state.position_m[2] != 0.009
        assert (state.time_s, state.buttons) == (7.0, 5)

    @pytest.mark.parametrize("copy", [deepcopy, lambda touch: pickle.loads(pickle.dumps(touch))])
    def test_copy_of_a_touch_has_its_own_memory(self, copy):
        """One copy is asked for its stiffness while another runs in the loop's process."""
        first = WithMaterials(law="in-python").touch(level(STICKY))
        path = stroke(ticks=50)
        first.path(path[:20])
        second = copy(first)
        assert digest_of(second.path(path[20:])) == digest_of(first.path(path[20:]))

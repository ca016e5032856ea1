"""Materials around a force law would change what is switched off, or a law in plain Python would feel different."""

import pickle
from copy import deepcopy
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from pydantic import Field

from materials_on_laws import GRAINY, LATERAL, PLAIN, PUSHING, RUBBER, STICKY, cover, level, stroke
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import Force, HapticState, HapticSurface, Material, digest_of
from tangible_core.errors import OptionError
from tangible_core.materials.assignment import library
from tangible_core.plugins.interfaces import ForceRenderer, PlainTouch, Touch
from tangible_core.plugins.registry import load_method
from tangible_core.testing.synthetic.scenes import waves
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

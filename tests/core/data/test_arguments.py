"""Converted arguments and quantities: else a number is taken for another size, or a traceback says nothing."""

from collections.abc import Callable, Mapping
from inspect import signature
from pathlib import Path
from typing import Any, Unpack

import numpy as np
import pytest

from tangible_core import (
    Calibration,
    DisparityMap,
    HapticSurface,
    Material,
    Recording,
    Relief,
    Scene,
    SegmentMap,
    Views,
    Workspace,
    load_method,
)
from tangible_core.data.arguments import as_array, as_force, as_state, named_options
from tangible_core.data.device import Force, HapticState
from tangible_core.data.ticks import TICK_COLUMNS
from tangible_core.errors import ArgumentError, ConfigError, OptionError, TangibleError
from tangible_core.mapping import WorkspaceMapping
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.plugins.registry import default_registry
from tangible_core.scene.scene_files import SceneFiles
from tangible_core.scene.scene_options import TurnOptions
from tangible_core.servo import Safety

pytestmark = pytest.mark.usefixtures("unchecked_shapes")

GREY = np.zeros((2, 2), np.uint8)
FLAT = np.zeros((2, 2), np.float32)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Views("l.png"), "left: is the str 'l.png'; it must be an array of numbers; Scene and numpy.load"),
        (lambda: Views(GREY, Path("r.png")), "right: is a PosixPath; it must be an array of numbers"),
        (lambda: Views(GREY, calibration=(900, 0.1)), r"calibration: is the tuple \(900, 0.1\); it must be a"),
        (lambda: Views([[1], [2, 3]]), r"left: is the list \[\[1\], \[2, 3\]\]; it must be an array of numbers"),
        (lambda: Calibration("900", 0.1), "focal_px: is the str '900'; it must be a number"),
        (lambda: DisparityMap(None), "disparity_px: is None; it must be an array"),
        (lambda: DisparityMap(FLAT, unit="m"), "unit: is the str 'm'; it must be one of px, relative"),
        (lambda: SegmentMap([[0.5]]), "labels: is an array of float64 .*; it must be an array of int32"),
        (lambda: Relief(FLAT, 0.1), "extent_m: is the float 0.1; it must be 2 numbers"),
        (lambda: Relief(FLAT, (0.1, "b")), r"extent_m\[1\]: is the str 'b'; it must be a number"),
        (lambda: HapticSurface(FLAT), "relief: is an array of float32 .*; it must be a Relief"),
        (lambda: HapticSurface.from_heights("h.npy"), "height_m: is the str 'h.npy'; it must be an array"),
        (lambda: HapticSurface.from_heights(FLAT, "8 cm"), "width_m: is the str '8 cm'; it must be a number"),
        (lambda: HapticSurface.from_heights(FLAT, 0.1, [[0, 0]] * 2, ["ice"]), r"materials\[0\]: is the str 'ice'"),
        (lambda: Material("ice", "100", 0, 0, 0), "material 'ice': stiffness_n_per_m: is the str '100'; it"),
        (lambda: Recording.load(7), "path: is the int 7; it must be a path"),
        (lambda: Recording("x"), "rows: is the str 'x'; it must be an array of numbers"),
        (lambda: Scene.photo([[1], [2, 3]]), "photo: is the list"),
        (lambda: Scene.pair(left=GREY, right=GREY, calibration=900), "calibration: is the int 900; it must be a"),
        (lambda: Scene.pair(left=GREY, right=GREY, rig=7), "rig: is the int 7; it must be a StereoRig, or"),
    ],
)  # fmt: skip
def test_wrong_argument_gives_one_sentence_with_its_name(make: Callable[[], Any], message: str):
    with pytest.raises(TangibleError, match=f"^{message}") as raised:
        make()
    assert isinstance(raised.value, TypeError)
    assert "\n" not in str(raised.value)


class Pen:
    @named_options
    def draw(self, at: int, /, wide: int = 1, *points: int, tall: int = 1, **more: int) -> int:
        return at + wide + sum(points) + tall + sum(more.values())


def test_convertible_arguments_are_converted():
    assert Views([[0, 255], [7, 0]]).left.dtype == np.uint8
    assert Views([[0, 256], [7, 0]]).left.dtype == np.uint16
    assert Views([[0.0, 1.0]]).left.shape == (1, 2)
    found = DisparityMap([[1, 2], [3, np.nan]])
    assert (found.disparity_px.dtype, found.confidence.tolist()) == (np.float32, [[1, 1], [1, 0]])
    assert SegmentMap(np.eye(3)).labels.dtype == np.int32
    relief = Relief(np.zeros((2, 2)), [0.1, 0.2])
    assert (relief.height_m.dtype, relief.extent_m) == (np.float32, (0.1, 0.2))
    assert HapticSurface.from_heights([[0, 1]], 0.1, [[0, 1]]).labels is not None
    assert Recording([[0] * len(TICK_COLUMNS)]).rows.dtype == np.float64
    for wrong in ([[2**40]], [[np.nan]], [[0.25]]):
        with pytest.raises(ArgumentError, match="it must be an array of int32"):
            as_array("labels", wrong, "int32")
    for three in ((0, 1, 2), [0.0, 1.0, 2.0], np.arange(3)):
        assert as_state(three) == HapticState((0.0, 1.0, 2.0))
        assert as_force(three) == Force(0.0, 1.0, 2.0)
    for other in (None, "abc", (0, 1), (0, 1, "x"), np.zeros((3, 3)), 7):
        assert as_force(other) is None
        with pytest.raises(ArgumentError, match=r"state: is .*three numbers"):
            as_state(other)


def test_help_of_a_method_lists_its_options_and_its_schema_does_not():
    proxy = load_method("render", "proxy")
    line = "stiffness_n_per_m = 800.0   (N/m, number > 0 or text such as 6 N/m)\n    Stiffness between proxy and hand,"
    assert f"\n\nOptions:\n{line}" in str(proxy.__doc__)
    assert proxy.model_json_schema()["description"].endswith("Eurohaptics 2002.")


def test_unknown_option_lists_only_the_names_that_may_be_written():
    assert Pen().draw(1, 2, 3, tall=4) == 10
    for name in ("tal", "self", "at", "points", "more"):
        with pytest.raises(ArgumentError) as raised:
            Pen().draw(1, **{name: 2})
        meant = " (did you mean 'tall'?)" if name == "tal" else ""
        assert str(raised.value) == f"Pen.draw: {name}: unknown option{meant}; known: wide, tall"


def test_options_of_a_typed_dict_are_in_the_signature_by_name():
    @named_options
    def draw(text: str, **turn: Unpack[TurnOptions]) -> Mapping[str, object]:
        return turn

    assert str(signature(draw)).startswith("(text: str, *, rotate: int = ..., invert: bool = ...)")
    assert draw("a", invert=True) == {"invert": True}
    with pytest.raises(ArgumentError, match="inverted: unknown option"):
        draw("a", inverted=True)


TEXT = """\
scene: {height: map.png, relief_m: 12 mm}
workspace: {width_m: 8cm, smooth_m: 30 um, finest_m: 0.00003}
mapping: {offset_m: [5 mm, 0, -1 cm]}
render: {use: proxy, stiffness_n_per_m: 0.8 N/mm}
safety: {ramp_s: 250 ms}
"""


def test_pipeline_file_with_units_is_read_in_base_units():
    config = parse_config(TEXT, Path("p.yaml"), default_registry(), ["workspace.relief_m=6 mm"])
    assert isinstance(config.scene, SceneFiles) and config.scene.relief_m == 0.012
    size = config.workspace
    assert (size.width_m, size.relief_m, size.smooth_m, size.finest_m) == (0.08, 0.006, 3e-5, 3e-5)
    assert config.mapping.offset_m == (0.005, 0.0, -0.01)
    assert config.safety.ramp_s == 0.25
    assert config.render and config.render.method == load_method("render", "proxy")(stiffness_n_per_m=800.0)


@pytest.mark.parametrize("text", ["6 mm", "6mm", " 6e3 um ", "0.6 cm", "6000 μm", "6000 µm", "0.006 m", "0.006"])
def test_length_written_in_any_unit_gives_the_same_block(text: str):
    assert Workspace(relief_m=text) == Workspace(relief_m=0.006)


@pytest.mark.parametrize("text", ["6 inches", "6 N/m", "6 m m m"])
def test_text_that_is_not_a_length_is_refused_with_the_known_units(text: str):
    with pytest.raises(ConfigError) as error:
        parse_config(f"scene: builtin/coins\nworkspace: {{width_m: {text!r}}}\n", Path("p.yaml"), default_registry())
    assert str(error.value) == (
        f"p.yaml:2:13: workspace.width_m: write a number in m, or with one of the units m, cm, mm, um, not {text!r}"
    )


def test_quantity_of_another_unit_bound_or_type_is_refused_with_its_place():
    for wrong in ("-6 mm", "11 m", "wide", None, "1e999 mm", "1e9999999 mm", "1" * 100_000 + " mm", "nan mm", "inf"):
        with pytest.raises(OptionError):
            Workspace(width_m=wrong)
    with pytest.raises(OptionError):
        Safety(coupling="6 N/m")
    assert WorkspaceMapping(region_m=("1 cm", 0, "2 cm", "30 mm")).region_m == (0.01, 0.0, 0.02, 0.03)
    with pytest.raises(OptionError, match="max_force_n: Input should be a valid number, not True"):
        Safety(max_force_n=True)
    with pytest.raises(OptionError, match="delay_ticks"):
        Safety(delay_ticks=False)
    with pytest.raises(ConfigError, match=r"^p.yaml:2:10: safety.max_force_n: Input should be a valid number"):
        parse_config("scene: builtin/coins\nsafety: {max_force_n: true}\n", Path("p.yaml"), default_registry())

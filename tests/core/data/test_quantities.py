"""If one of these fails, a number with a unit is taken for another size, or a wrong one is accepted."""

from pathlib import Path

import pytest

from tangible_core import Workspace, load_method
from tangible_core.errors import ConfigError, OptionError
from tangible_core.mapping import WorkspaceMapping
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.plugins.registry import default_registry
from tangible_core.scene.scene_files import SceneFiles
from tangible_core.servo import Safety

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


def test_quantity_out_of_bounds_or_of_another_unit_is_refused():
    for wrong in ("-6 mm", "11 m", "wide", None, "1e999 mm", "1e9999999 mm", "1" * 100_000 + " mm", "nan mm", "inf"):
        with pytest.raises(OptionError):
            Workspace(width_m=wrong)
    with pytest.raises(OptionError):
        Safety(coupling="6 N/m")
    assert WorkspaceMapping(region_m=("1 cm", 0, "2 cm", "30 mm")).region_m == (0.01, 0.0, 0.02, 0.03)


def test_true_for_a_number_is_refused_with_its_place():
    with pytest.raises(OptionError, match="max_force_n: Input should be a valid number, not True"):
        Safety(max_force_n=True)
    with pytest.raises(OptionError, match="delay_ticks"):
        Safety(delay_ticks=False)
    with pytest.raises(ConfigError, match=r"^p.yaml:2:10: safety.max_force_n: Input should be a valid number"):
        parse_config("scene: builtin/coins\nsafety: {max_force_n: true}\n", Path("p.yaml"), default_registry())

"""Pipeline files: keys, overrides, and complaints about mistakes."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.errors import Complaint, ConfigError
from tangible_core.pipeline.config.methods import NamedMethod
from tangible_core.pipeline.config.model import PipelineConfig
from tangible_core.pipeline.config.parsing import load_config, parse_config
from tangible_core.plugins.registry import default_registry
from tangible_core.scene.scene import Scene
from tangible_core.scene.scene_files import SceneFiles

ROOT = Path(__file__).parents[4]
PATH = Path("here/p.yaml")


def parse(text: str, *overrides: str):
    return parse_config(text, PATH, default_registry(), overrides)


def complaints(text: str, *overrides: str) -> list[str]:
    with pytest.raises(ConfigError) as error:
        parse(text, *overrides)
    return str(error.value).splitlines()


PIPELINES = sorted(set(ROOT.glob("configs/*.yaml")) - set(ROOT.glob("configs/compare-*.yaml")))


@pytest.mark.parametrize("path", PIPELINES, ids=lambda path: path.name)
def test_sample_configurations_are_valid(path: Path):
    assert load_config(path, default_registry()).scene


def test_embedded_demo_equals_the_sample():
    assert (ROOT / "tangible_core" / "demo.yaml").read_bytes() == (ROOT / "configs" / "demo.yaml").read_bytes()


def test_complaints_come_all_at_once_with_places():
    text = """\
scene: builtin/motorcycle
depht: {use: opencv-sgbm}
depth:
  use: opencv-sgmb
texture:
  use: gradient
  segmnts: 3
render:
  use: penalty-gradient
  stiffness_n_per_m: -5
workspace: {width_m: wide}
want: surfaces
"""
    found = complaints(text)
    starts = [line.split(": ")[0] for line in found]
    assert starts == [
        "here/p.yaml:2:1",
        "here/p.yaml:12:1",
        "here/p.yaml:11:13",
        "here/p.yaml:4:3",
        "here/p.yaml:7:3",
        "here/p.yaml:10:3",
    ]
    assert "unknown key 'depht' (did you mean 'depth'?)" in found[0]
    assert "did you mean 'surface'?" in found[1]
    assert "workspace.width_m" in found[2]
    assert "'wide'" in found[2]
    assert "did you mean 'opencv-sgbm'?" in found[3]
    assert "texture.segmnts: unknown option (did you mean 'segments'?)" in found[4]
    assert "render.stiffness_n_per_m" in found[5]
    assert "not -5" in found[5]


RULES = "scene: builtin/brick\nmaterials:\n  rules:\n    - "


@pytest.mark.parametrize(
    ("text", "place", "what"),
    [
        ("scene: builtin/brick\ndepth:\n\tuse: x\n", "here/p.yaml:3:1", "tabs"),
        ("scene: a\nscene: b\n", "here/p.yaml:2:1", "duplicate key"),
        ("scene: [a\n", "here/p.yaml:2:1", "expected"),
        ("- scene\n", "here/p.yaml:1:1", "mapping"),
        ("", "here/p.yaml:1:1", "mapping"),
        ("want: touch\n", "here/p.yaml:1:1", "`scene:` is missing"),
        ("want: touch\nscene: builtin/brik\n", "here/p.yaml:2:1", "did you mean 'builtin/brick'?"),
        ("scene: {left: a.png}\n", "here/p.yaml:1:1", "right"),
        ("scene: {phto: a.png}\n", "here/p.yaml:1:9", "did you mean 'photo'?"),
        ("scene: builtin/brick\ndevice: {path: circle}\n", "here/p.yaml:2:1", "needs the name of a method"),
        ("scene: builtin/brick\ndevice:\n", "here/p.yaml:2:1", "needs the name of a method"),
        ("scene: builtin/brick\nworkspace: {width_m: .nan}\n", "here/p.yaml:2:13", "finite"),
        ("scene: builtin/brick\nworkspace: [1]\n", "here/p.yaml:2:1", "workspace"),
        ("scene: builtin/brick\nmaterials: {by: colour}\n", "here/p.yaml:2:13", "roughness"),
        ("scene: builtin/brick\nmaterials: {0: ice, one: sand}\n", "here/p.yaml:2:21", "valid integer"),
        ("scene: builtin/brick\nmaterials: {0: ice, 1: sandd}\n", "here/p.yaml:2:21", "did you mean 'sand'?"),
        ("scene: builtin/brick\nmaterials: {default: wod}\n", "here/p.yaml:2:13", "did you mean 'wood'?"),
        (f"{RULES}{{colour: bleu, material: water}}\n", "here/p.yaml:4:8", "(did you mean 'blue'?)"),
        (
            f"{RULES}{{color: blue, material: water}}\n",
            "here/p.yaml:4:8",
            "did you mean 'colour'?); known: segment, part, at,",
        ),
        (f"{RULES}{{colour: blue, material: watr}}\n", "here/p.yaml:4:22", "did you mean 'water'?"),
        (f"{RULES}{{colour: blue}}\n", "here/p.yaml:4:7", "materials.rules.0.material: Field required"),
        (
            f"{RULES}{{material: ice}}\n",
            "here/p.yaml:4:7",
            "takes one of segment, part, at and colour; this one has none",
        ),
        (f"{RULES}{{at: [-1, 2], material: ice}}\n", "here/p.yaml:4:13", "greater than or equal to 0, not -1"),
        (f"{RULES}{{at: 3, material: ice}}\n", "here/p.yaml:4:8", "a list"),
        (f"{RULES}{{at: [.inf, 2], material: ice}}\n", "here/p.yaml:4:13", "finite"),
        ("scene: builtin/brick\nmaterials: {rules: ice}\n", "here/p.yaml:2:13", "materials.rules"),
    ],
)
def test_mistake_gives_one_line_with_its_place(text: str, place: str, what: str):
    found = complaints(text)
    assert found[0].startswith(place + ": "), found
    assert what in "\n".join(found)


def located_complaints(text: str, *overrides: str) -> list[Complaint]:
    """Return the complaints for a program, and check that they equal the sentences."""
    with pytest.raises(ConfigError) as error:
        parse(text, *overrides)
    found = list(error.value.complaints)
    for sentence, each in zip(str(error.value).splitlines(), found, strict=True):
        place = f"here/p.yaml:{each.line}:{each.column}: " if each.line else ""
        assert sentence == place + each.text or (not place and sentence.endswith(f": {each.text}"))
    return found


@pytest.mark.parametrize(
    ("text", "override", "location", "mark"),
    [
        ("scene: builtin/brick\nworkspace:\n  relief_m: x\n", None, ("workspace", "relief_m"), (3, 3)),
        ("scene: builtin/brick\nrender: {use: proxi}\n", None, ("render", "use"), (2, 10)),
        ("scene: builtin/brick\nrender: 3\n", None, ("render",), (2, 1)),
        ("scene: builtin/brick\n5: 3\n", None, (5,), (2, 1)),
        ("scene: builtin/brick\ntrue: 3\n", None, ("True",), (2, 1)),
        (f"{RULES}{{colour: blue}}\n", None, ("materials", "rules", 0, "material"), (4, 7)),
        (f"{RULES}{{colour: blue, material: watr}}\n", None, ("materials", "rules", 0, "material"), (4, 22)),
        ("scene: builtin/brick\nmaterials: {by: {1: sandd}}\n", None, ("materials", "by", 1), (2, 18)),
        ("scene: builtin/brick\nmaterials: {1: sandd}\n", None, ("materials", 1), (2, 13)),
        ("want: touch\n", None, (), (1, 1)),
        ("- scene\n", None, (), (1, 1)),
        ("scene: a\nscene: b\n", None, (), (2, 1)),
        ("scene: builtin/brick\ndepth:\n\tuse: x\n", None, (), (3, 1)),
        ("scene: builtin/brick\n", "workspace.width_m=wide", ("workspace", "width_m"), (None, None)),
        ("scene: builtin/brick\n", "workspace.width_m=[", ("workspace", "width_m"), (None, None)),
        ("scene: builtin/brick\n", "workspace", (), (None, None)),
    ],
)  # fmt: skip
def test_complaint_has_location_line_and_column(text: str, override: str | None, location: tuple, mark: tuple):
    (found,) = located_complaints(text, *([override] if override else []))
    assert (found.location, (found.line, found.column)) == (location, mark)
    assert json.loads(json.dumps(found._asdict()))["location"] == list(location)


def test_complaints_together_have_their_locations():
    text = "scene: builtin/brick\ndepht: x\nworkspace: {width_m: wide, relief_m: -1}\nwant: surfaces\n"
    assert [each.location for each in located_complaints(text)] == [
        ("depht",), ("want",), ("workspace", "width_m"), ("workspace", "relief_m"),
    ]  # fmt: skip


def test_yaml_numbers_and_words_keep_their_types():
    config = parse("scene: {photo: off}\nrender: {use: penalty-gradient, stiffness_n_per_m: 1e3}\n")
    assert config.scene.photo == Path("here/off").absolute()
    assert config.render.method.stiffness_n_per_m == 1000.0


def test_method_without_options_is_named_alone():
    assert parse("scene: builtin/brick\ndepth: luminance\n").depth.name == "luminance"


def test_materials_by_label_are_read():
    assert parse("scene: builtin/brick\nmaterials: {0: ice, 2: sand}\n").materials.by == {0: "ice", 2: "sand"}


def test_materials_by_rules_are_read():
    rules = "{at: [1, 2.5], material: ice}, {segment: 0, material: sand}"
    text = f"scene: builtin/brick\nmaterials: {{rules: [{rules}], by: rules}}\n"
    choice = parse(text).materials
    assert [(rule.at, rule.segment, rule.material) for rule in choice.rules] == [
        ((1, 2.5), None, "ice"), (None, 0, "sand"),
    ]  # fmt: skip
    assert (choice.by, choice.default) == ("rules", "plain")


def test_completed_configuration_keeps_its_rules():
    text = "scene: builtin/brick\nmaterials: {rules: [{colour: blue, material: water}]}"
    completed = parse(text).as_data()["materials"]
    assert completed == {
        "rules": [{"colour": "blue", "material": "water"}], "by": "roughness", "default": "plain", "fit": "device",
    }  # fmt: skip


def test_material_names_of_a_custom_library_are_known(tmp_path: Path):
    (tmp_path / "mine.yaml").write_text(
        "mud: {stiffness_n_per_m: 300, damping_n_s_per_m: 2, static_friction: 0.6, dynamic_friction: 0.5}\n"
    )
    (tmp_path / "p.yaml").write_text("scene: builtin/brick\nmaterials: {library: mine.yaml, by: {0: mud}}\n")
    assert load_config(tmp_path / "p.yaml", default_registry()).materials.by == {0: "mud"}


def test_scene_files_are_relative_to_the_pipeline_file():
    config = parse("scene: {left: a.png, right: b.png, focal_px: 900, baseline_m: 0.2}\n")
    assert isinstance(config.scene, SceneFiles)
    assert config.scene.left == Path("here/a.png").absolute()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("scene: {height: h.npy, nodata: [6, x]}\n", "1:36: scene.nodata.1: Input should be a valid number"),
        ("scene: {height: h.npy, clip: [1]}\n", "1:24: scene.clip.1: Field required"),
        ("scene: {height: 3}\n", "1:9: scene.height: Input should be the path of a file, not 3"),
        ("scene: builtin/brick\nworkspace: x\n", "2:1: workspace: Input should be a mapping, such as {key: value}"),
        ("scene: builtin/brick\nworkspace: {width_m: x}\n", "width_m: Input should be a valid number, not 'x'"),
        (
            "scene: builtin/brick\ntexture: {use: gabor, segments: 0}\n",
            "2:23: texture.segments: Input should be greater than or equal to 1, or 'auto', not 0",
        ),
        (
            "scene: builtin/brick\ntexture: {use: gabor, segments: aut}\n",
            "texture.segments: Input should be a valid integer, or 'auto', not 'aut' (did you mean 'auto'?)",
        ),
    ],
)
def test_complaint_has_the_words_and_places_of_the_file(text: str, says: str):
    (found,) = complaints(text)
    assert says in found and not any(word in found for word in ("tuple", "float", "dictionary", "class", "[1]"))


def test_override_wins_over_the_file_and_complains_alike():
    text = "scene: builtin/brick\nrender: {use: penalty-gradient}\n"
    assert parse(text, "render.stiffness_n_per_m=500").render.method.stiffness_n_per_m == 500
    assert parse(text, "depth.use=luminance").depth.name == "luminance"
    assert parse(text, "materials.1=ice", "materials.0=sand").materials.by == {1: "ice", 0: "sand"}
    grey = parse(text, "render.stiffness_n_per_m=5", "render.use=grey-level", "render.force_at_white_n=2").render
    assert (grey.name, grey.method.force_at_white_n) == ("grey-level", 2)
    (found,) = complaints(text, "render.stiffness_n_per_m=-5")
    assert found.startswith("--set render.stiffness_n_per_m=-5: render.stiffness_n_per_m")
    (found,) = complaints(text, "rendr.use=penalty")
    assert found.startswith("--set rendr.use=penalty: unknown key 'rendr' (did you mean 'render'?)")
    (found,) = complaints(text, "render.stifness_n_per_m=5")
    assert "did you mean 'stiffness_n_per_m'?" in found


@pytest.mark.parametrize("override", ["render", "=5", "render..x=5", "render.x=[", ""])
def test_malformed_override_is_refused(override: str):
    (found,) = complaints("scene: builtin/brick\n", override)
    assert found.startswith(f"--set {override}: ")


def test_later_override_wins():
    config = parse("scene: builtin/brick\n", "workspace.width_m=0.1", "workspace.width_m=0.2")
    assert config.workspace.width_m == 0.2


def test_method_files_are_relative_to_the_pipeline_file(tmp_path: Path):
    (tmp_path / "p.yaml").write_text(
        "scene: builtin/brick\nmaterials: {library: mine.yaml}\ndevice: {use: mock, path: csv, csv_file: hand.csv}\n"
    )
    config = load_config(tmp_path / "p.yaml", default_registry())
    assert config.materials.library == tmp_path / "mine.yaml"
    assert config.device.method.csv_file == tmp_path / "hand.csv"


def test_missing_file_is_named_with_the_nearest_name(tmp_path: Path):
    (tmp_path / "feel.yaml").write_text("scene: builtin/brick\n")
    with pytest.raises(ConfigError, match=r"feeel\.yaml: there is no such file \(did you mean 'feel\.yaml'\?\)"):
        load_config(tmp_path / "feeel.yaml", default_registry())


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b"scene: \x00"])
def test_file_without_text_is_refused(tmp_path: Path, content: bytes):
    (tmp_path / "p.yaml").write_bytes(content)
    with pytest.raises(ConfigError, match=r"p\.yaml"):
        load_config(tmp_path / "p.yaml", default_registry())


def test_completed_configuration_is_read_back_equal(tmp_path: Path):
    from ruamel.yaml import YAML

    config = load_config(ROOT / "configs" / "feel.yaml", default_registry())
    with (tmp_path / "done.yaml").open("w") as file:
        YAML(typ="safe").dump(config.as_data(), file)
    again = load_config(tmp_path / "done.yaml", default_registry())
    assert again.as_data() == config.as_data()
    assert again.render.method == config.render.method


words = st.sampled_from(["scene", "depth", "use", "opencv-sgbm", "materials", "by", "left", "want", "0", "x"])
trees = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | words,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(words | st.integers(0, 3), inner, max_size=4),
    max_leaves=12,
)


@given(st.dictionaries(words, trees, max_size=5))
def test_any_mapping_gives_a_configuration_or_complaints(tree: dict):
    from io import StringIO

    from ruamel.yaml import YAML

    text = StringIO()
    YAML(typ="safe").dump(tree, text)
    try:
        parse(text.getvalue())
    except ConfigError as error:
        assert all(line.startswith("here/p.yaml:") for line in str(error).splitlines()), str(error)


@given(st.text())
def test_any_text_gives_a_configuration_or_complaints(text: str):
    try:
        parse(text)
    except ConfigError as error:
        assert "here/p.yaml" in str(error)


MAPPED = """\
scene: builtin/brick
mapping: {scale: 2, rotation_deg: 90, clutch_button: 0}
device: {use: mock, hand: null}
"""


def test_device_with_a_mapping_is_mapped():
    config = parse(MAPPED)
    assert config.felt_device is not None and config.device is not None
    assert config.felt_device.spec().workspace_m == pytest.approx((0.04, 0.04, 0.04))
    assert config.as_data()["device"] == {"use": "mock", **config.device.method.model_dump(mode="json")}
    again = parse_config(json.dumps(config.as_data()), PATH, default_registry())
    assert again.mapping == config.mapping


def test_device_without_a_mapping_is_itself():
    config = parse("scene: builtin/brick\ndevice: mock\n")
    assert config.device is not None
    assert config.felt_device is config.device.method
    assert parse("scene: builtin/brick\n").felt_device is None


def test_mapping_with_a_mistake_gives_complaints():
    [line] = complaints("scene: builtin/brick\nmapping:\n  clutch: 1\n")
    assert line.startswith("here/p.yaml:3:3: mapping.clutch: unknown option (did you mean 'clutch_button'?)")


@pytest.mark.parametrize(
    ("scene", "name"),
    [
        ("builtin/brick", "builtin/brick"),
        (SceneFiles(photo=Path("/home/me/a.png")), "a.png"),
        (SceneFiles(photo=Path("maps/a.png")), "maps/a.png"),
        (SceneFiles(video=2), "camera 2"),
        (Scene.photo(np.zeros((2, 2)), name="mine"), "mine"),
    ],
)
def test_configuration_in_short_has_no_folders_of_a_person(scene: object, name: str):
    from tangible_depth import Luminance

    config = PipelineConfig(scene=scene, want="relief", depth=NamedMethod("luminance", "1", Luminance()))
    assert repr(config) == f"PipelineConfig('{name}', want='relief', depth='luminance')"


def test_completed_file_has_methods_and_exports_last():
    text = (
        "export: [stl]\nrender: penalty-gradient\ndepth: luminance\nscene: builtin/brick\ntitle: Wall\nlanguage: de\n"
    )
    names = list(parse(text).as_data())
    last = [name for name in names if name in ("depth", "texture", "render", "device", "export")]
    assert names[-len(last) :] == last
    assert {"depth", "render", "export"} <= set(last)
    assert names[:2] == ["scene", "title"]

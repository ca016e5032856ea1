"""Pipeline files. Otherwise a file would be read as something else, or a mistake in it could not be found."""

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.errors import Complaint, ConfigError
from tangible_core.parts import HeightChoice, PartChoice
from tangible_core.pipeline.config.parsing import load_config, parse_config
from tangible_core.plugins.registry import default_registry
from tangible_core.scene.scene_files import SceneFiles

ROOT = Path(__file__).parents[4]
PATH = Path("here/p.yaml")


def parse(text: str, *overrides: str):
    return parse_config(text, PATH, default_registry(), overrides)


def complaints(text: str, *overrides: str) -> list[str]:
    with pytest.raises(ConfigError) as error:
        parse(text, *overrides)
    return str(error.value).splitlines()


def located_complaints(text: str, *overrides: str) -> list[Complaint]:
    """Return the complaints for a program, and check that they equal the sentences."""
    with pytest.raises(ConfigError) as error:
        parse(text, *overrides)
    found = list(error.value.complaints)
    for sentence, each in zip(str(error.value).splitlines(), found, strict=True):
        place = f"here/p.yaml:{each.line}:{each.column}: " if each.line else ""
        assert sentence == place + each.text or (not place and sentence.endswith(f": {each.text}"))
    return found


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
  fil: false
texture:
  use: gradient
  segmnts: 3
render:
  use: penalty-gradient
  stiffness_n_per_m: -5
workspace: {width_m: wide}
want: surfaces
"""
    wanted = {
        "2:1": "'depth'?", "13:1": "'surface'?", "12:13": "workspace.width_m", "4:3": "'opencv-sgbm'?",
        "5:3": "'fill'?", "8:3": "'segments'?", "11:3": "not -5",
    }  # fmt: skip
    found = complaints(text)
    assert [line.split(": ")[0] for line in found] == [f"here/p.yaml:{place}" for place in wanted]
    assert all(word in line for word, line in zip(wanted.values(), found, strict=True))


RULES = "scene: builtin/brick\nmaterials:\n  rules:\n    - "
SEGMENTED = "scene: {photo: a.png, segments: parts.png}\n"
PART_RULE = ("materials", "rules", 0, "part")


@pytest.mark.parametrize(
    ("text", "location", "mark", "word"),
    [
        ("{B}workspace:\n  relief_m: x\n", ("workspace", "relief_m"), (3, 3), "valid number"),
        ("{B}render: {use: proxi}\n", ("render", "use"), (2, 10), "'proxy'?"),
        ("{B}render: 3\n", ("render",), (2, 1), ""),
        ("{B}5: 3\n", (5,), (2, 1), ""),
        ("{B}true: 3\n", ("True",), (2, 1), ""),
        ("{B}device: {path: circle}\n", ("device",), (2, 1), "needs the name"),
        ("{B}device:\n", ("device",), (2, 1), "needs the name"),
        ("{B}workspace: {width_m: .nan}\n", ("workspace", "width_m"), (2, 13), "finite"),
        ("{B}workspace: [1]\n", ("workspace",), (2, 1), "mapping"),
        ("{B}mapping: {clutch: 1}\n", ("mapping", "clutch"), (2, 11), "'clutch_button'?"),
        ("{B}texture: {use: gabor, segments: 0}\n", ("texture", "segments"), (2, 23), "or 'auto', not 0"),
        ("{B}texture: {use: gabor, segments: aut}\n", ("texture", "segments"), (2, 23), "'auto'?"),
        ("{B}materials: {by: colour}\n", ("materials", "by"), (2, 13), "roughness"),
        ("{B}materials: {by: {1: sandd}}\n", ("materials", "by", 1), (2, 18), "'sand'?"),
        ("{B}materials: {1: sandd}\n", ("materials", 1), (2, 13), "'sand'?"),
        ("{B}materials: {1: ice, one: sand}\n", ("materials", "by", "one"), (2, 21), "valid integer"),
        ("{B}materials: {by: rules, 3: ice}\n", ("materials", 3), (2, 24), "`rules: [{segment: 3, material: ice}]`"),
        ("{B}materials: {default: wod}\n", ("materials", "default"), (2, 13), "'wood'?"),
        ("{B}materials: {rules: ice}\n", ("materials", "rules"), (2, 13), ""),
        ("{R}{colour: blue}\n", ("materials", "rules", 0, "material"), (4, 7), "required"),
        ("{R}{colour: blue, material: watr}\n", ("materials", "rules", 0, "material"), (4, 22), "'water'?"),
        ("{R}{colour: bleu, material: water}\n", ("materials", "rules", 0, "colour"), (4, 8), "'blue'?"),
        ("{R}{color: blue, material: water}\n", ("materials", "rules", 0, "color"), (4, 8), "'colour'?"),
        ("{R}{material: ice}\n", ("materials", "rules", 0), (4, 7), "one of segment"),
        ("{R}{at: [-1, 2], material: ice}\n", ("materials", "rules", 0, "at", 0), (4, 13), "not -1"),
        ("{R}{at: 3, material: ice}\n", ("materials", "rules", 0, "at"), (4, 8), "a list"),
        ("want: touch\n", (), (1, 1), "`scene:` is missing"),
        ("scene: builtin/brik\n", ("scene",), (1, 1), "'builtin/brick'?"),
        ("scene: {left: a.png}\n", ("scene",), (1, 1), "right"),
        ("scene: {phto: a.png}\n", ("scene", "phto"), (1, 9), "'photo'?"),
        ("scene: {height: h.npy, nodata: [6, x]}\n", ("scene", "nodata", 1), (1, 36), "valid number"),
        ("scene: {height: h.npy, clip: [1]}\n", ("scene", "clip", 1), (1, 24), "required"),
        ("scene: {height: 3}\n", ("scene", "height"), (1, 9), "path of a file"),
        ("- scene\n", (), (1, 1), "mapping"),
        ("", (), (1, 1), "mapping"),
        ("scene: [a\n", (), (2, 1), "expected"),
        ("scene: a\nscene: b\n", (), (2, 1), "duplicate key"),
        ("{B}depth:\n\tuse: x\n", (), (3, 1), "tabs"),
        ("{S}parts: [wall]", ("parts",), (2, 1), "mapping"),
        ("{S}parts: {one: wall}", ("parts", "one"), (2, 9), "not 'one'"),
        ("{S}parts: {-1: wall}", ("parts", -1), (2, 9), "not -1"),
        ("{S}parts: {0: wall}", ("parts", 0), (2, 9), "needs 1 more in each), not 0"),
        ("{S}materials: {rules: [{part: 0, material: ice}]}", PART_RULE, (2, 22), "needs 1 more in each)"),
        ("{S}parts: {true: wall}", ("parts", "True"), (2, 9), "not True"),
        ("{S}parts: {7: wall, '7': floor}", ("parts", "7"), (2, 18), "twice"),
        ("{S}parts: {7: 3}", ("parts", 7), (2, 9), "the name of a part"),
        ("{S}parts: {7: {nam: wall}}", ("parts", 7, "nam"), (2, 13), "'name'?"),
        ("{S}parts:\n  1: wall\n  7: {name: Wall}", ("parts", 7, "name"), (4, 7), "of part 1 as well"),
        ("{S}parts: {1: wall, 7: 'wall '}", ("parts", 7, "name"), (2, 18), "of part 1 as well"),
        ("{S}parts: {1: '12'}", ("parts", 1, "name"), (2, 9), "number of a part"),
        ('{S}parts: {1: "a\\nb"}', ("parts", 1, "name"), (2, 9), "one line"),
        (f"{{S}}parts: {{1: {'x' * 81}}}", ("parts", 1, "name"), (2, 9), "over 80"),
        ("{S}parts: {1: {material: glas}}", ("parts", 1, "material"), (2, 13), "'glass'?"),
        ("{S}parts: {1: {height_m: .nan}}\nheights: given", ("parts", 1, "height_m"), (2, 13), "finite"),
        ("{S}parts: {1: {height_m: -1 mm}}\nheights: given", ("parts", 1, "height_m"), (2, 13), "greater than"),
        ("{S}parts: {1: {height_m: 1 px}}\nheights: given", ("parts", 1, "height_m"), (2, 13), "units"),
        ("{S}parts: {1: {height_m: 1 mm}}", ("parts", 1, "height_m"), (2, 13), "`heights: {by: given}`"),
        ("{S}heights: {by: gues}", ("heights", "by"), (2, 11), "'guess'?"),
        ("{S}heights: {round_m: 6 mm}", ("heights", "by"), (2, 1), "required"),
        ("{S}heights: {by: given, round_m: .inf}", ("heights", "round_m"), (2, 22), "finite"),
        ("{S}heights: {by: given, bulge_m: 6 mm}", ("heights",), (2, 1), "6.3 mm together"),
        ("{S}title: [a]", ("title",), (2, 1), "string"),
        ("{S}title: " + "x" * 201, ("title",), (2, 1), "200"),
        *((f'{{S}}title: "{each}"', ("title",), (2, 1), "control") for each in (r"a\nb", r"a\eb", r"a\x85b", r"a\Lb")),
        ("{S}language: german?", ("language",), (2, 1), "tag"),
        ("{S}parts: {1: wall}\nmaterials: {rules: [{part: wal, material: ice}]}", PART_RULE, (3, 22), "'wall'?"),
        ("{S}parts: {1: }\nmaterials: {rules: [{part: wal, material: ice}]}", PART_RULE, (3, 22), "names none"),
        ("{S}materials: {rules: [{part: 1, material: ice}]}", PART_RULE, (2, 22), "nothing is by parts"),
    ],
)  # fmt: skip
def test_mistake_has_location_line_and_column(text: str, location: tuple, mark: tuple, word: str):
    begun = text.replace("{B}", "scene: builtin/brick\n").replace("{R}", RULES).replace("{S}", SEGMENTED)
    (found,) = located_complaints(begun)
    assert (found.location, (found.line, found.column)) == (location, mark)
    assert word in found.text
    assert json.loads(json.dumps(found._asdict()))["location"] == list(location)


def test_materials_and_the_wish_of_a_file_are_completed(tmp_path: Path):
    for text, want in (("", "surface"), ("render: proxy\n", "touch"), ("render: proxy\nwant: relief\n", "relief")):
        assert parse(f"scene: builtin/brick\n{text}").want == want
    rules = "{at: [1, 2.5], material: ice}, {segment: 1, material: sand}"
    choice = parse(f"scene: builtin/brick\nmaterials: {{rules: [{rules}], by: rules}}\n").materials
    assert [(rule.at, rule.segment, rule.material) for rule in choice.rules] == [
        ((1, 2.5), None, "ice"), (None, 1, "sand"),
    ]  # fmt: skip
    assert (choice.by, choice.default) == ("rules", "plain")
    assert parse("scene: builtin/brick\nmaterials: {1: ice, 3: sand}\n").materials.by == {1: "ice", 3: "sand"}
    text = "scene: builtin/brick\nmaterials: {rules: [{colour: blue, material: water}]}"
    assert parse(text).as_data()["materials"] == {
        "rules": [{"colour": "blue", "material": "water"}], "by": "roughness", "default": "plain", "fit": "device",
    }  # fmt: skip


def test_override_wins_over_the_file_and_complains_alike():
    text = "scene: builtin/brick\nrender: {use: penalty-gradient}\ndepth: luminance\n"
    assert parse(text).depth.name == "luminance"
    assert parse(text, "render.stiffness_n_per_m=1e3").render.method.stiffness_n_per_m == 1000.0
    assert parse(text, "depth.use=zncc").depth.name == "zncc"
    assert parse(text, "workspace.width_m=0.1", "workspace.width_m=0.2").workspace.width_m == 0.2
    assert parse(text, "materials.2=ice", "materials.1=sand").materials.by == {2: "ice", 1: "sand"}
    grey = parse(text, "render.stiffness_n_per_m=5", "render.use=grey-level", "render.force_at_white_n=2").render
    assert (grey.name, grey.method.force_at_white_n) == ("grey-level", 2)
    for override, word in (
        ("render.stiffness_n_per_m=-5", "greater than"),
        ("rendr.use=penalty", "'render'?"),
        ("render.stifness_n_per_m=5", "'stiffness_n_per_m'?"),
        *((each, "") for each in ("render", "=5", "render..x=5", "render.x=[", "")),
    ):
        (sentence,), (found,) = complaints(text, override), located_complaints(text, override)
        assert sentence.startswith(f"--set {override}: ")
        assert word in sentence
        assert (found.line, found.column) == (None, None)


def test_files_are_relative_to_the_pipeline_file(tmp_path: Path):
    (tmp_path / "mine.yaml").write_text(
        "mud: {stiffness_n_per_m: 300, damping_n_s_per_m: 2, static_friction: 0.6, dynamic_friction: 0.5}\n"
    )
    (tmp_path / "feel.yaml").write_text(
        "scene: {left: a.png, right: off, focal_px: 900, baseline_m: 1e-1}\n"
        "materials: {library: mine.yaml, by: {1: mud}}\ndevice: {use: mock, path: csv, csv_file: hand.csv}\n"
    )
    config = load_config(tmp_path / "feel.yaml", default_registry())
    assert isinstance(config.scene, SceneFiles)
    assert (config.scene.left, config.scene.right) == (tmp_path / "a.png", tmp_path / "off")
    assert config.scene.baseline_m == 0.1
    assert (config.materials.library, config.materials.by) == (tmp_path / "mine.yaml", {1: "mud"})
    assert config.device.method.csv_file == tmp_path / "hand.csv"
    with pytest.raises(ConfigError, match=r"did you mean 'feel\.yaml'"):
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


def test_device_is_mapped_and_parts_are_read_by_number():
    config = parse(MAPPED)
    assert config.felt_device is not None and config.device is not None
    assert config.felt_device.spec().workspace_m == pytest.approx((0.04, 0.04, 0.04))
    assert config.as_data()["device"] == {"use": "mock", **config.device.method.model_dump(mode="json")}
    again = parse_config(json.dumps(config.as_data()), PATH, default_registry())
    assert again.mapping == config.mapping
    plain = parse("scene: builtin/brick\ndevice: mock\n")
    assert plain.felt_device is plain.device.method
    assert parse("scene: builtin/brick\n").felt_device is None
    config = parse(FULL)
    helmet = PartChoice(name=" helmet ", height_m=0.0042, material="glass")
    assert config.parts == {1: PartChoice(name="wall"), 7: helmet, 8: PartChoice(), 9: PartChoice()}
    assert config.heights == HeightChoice(by="given", bulge_m=0.001)
    assert (config.title, config.language) == ("1969", "pt-BR")
    assert (config.part_names, config.given_heights_m) == ({0: "wall", 6: "helmet"}, {6: 0.0042})
    assert [rule.part for rule in config.materials.rules] == ["helmet", 8]
    assert config.size[1:3] == (0.006, 0.0005)
    assert config.top_m == pytest.approx(0.0047)
    config = parse(SEGMENTED)
    assert (config.parts, config.heights, config.by_parts) == (None, None, False)
    assert (config.title, config.language, *config.size[1:3]) == ("", "en", 0.004, 0.0015)
    assert parse(f"{SEGMENTED}parts:\n").by_parts
    assert parse(f"{SEGMENTED}heights: guess\n").heights == HeightChoice(by="guess")
    assert parse("scene: {height: a.npy, segments: b.png}\nparts: {1: sea}\n").by_parts


FULL = f"""{SEGMENTED}title: 1969
language: pt-BR
parts:
  1: wall
  7: {{name: ' helmet ', height_m: 4.2 mm, material: glass}}
  8:
  '9': {{}}
heights: {{by: given, bulge_m: 1 mm}}
materials: {{rules: [{{part: helmet, material: ice}}, {{part: 8, material: sand}}]}}
"""


@pytest.mark.parametrize(
    "text",
    [
        FULL,
        *(f"{SEGMENTED}{end}\n" for end in ("parts: {}", "heights: depth", "parts: {1: {height_m: 1 mm}}\nheights:")),
    ],
)
def test_completed_parts_are_read_back_equal(text: str):
    config = parse(text)
    again = parse(config.as_yaml())
    for name in ("part_names", "given_heights_m", "by_parts", "heights", "title", "language"):
        assert getattr(again, name) == getattr(config, name)
    assert again.as_yaml() == config.as_yaml()


def test_part_mistakes_come_all_at_once_and_overrides_keep_names():
    parts = "{1: wall, 2: wall, 3: {material: glas}, x: 1}"
    text = f"{SEGMENTED}parts: {parts}\nwant: nothing\nheights: {{by: given, bulge_m: 1}}\n"
    assert [each.location for each in located_complaints(text)] == [
        ("want",), ("parts", "x"), ("heights", "bulge_m"), ("parts", 2, "name"), ("parts", 3, "material"),
    ]  # fmt: skip
    (complaint,) = located_complaints("scene: {height: a.npy, segments: b.png}\nheights: {by: given}\n")
    assert (complaint.location, complaint.line) == (("heights",), 2)
    config = parse(f"{SEGMENTED}parts: {{1: wall}}\nheights: given\n", "parts.1.height_m=2 mm", "parts.6.name=x")
    assert config.parts == {1: PartChoice(name="wall", height_m=0.002), 6: PartChoice(name="x")}
    config = parse(f"{SEGMENTED}parts: {{1: wall}}\nheights: given\n", "heights.bulge_m=2 mm")
    assert config.heights == HeightChoice(by="given", bulge_m=0.002)
    config = parse("scene: builtin/brick\nrender: proxy\n", "render.stiffness_n_per_m=500")
    assert config.render is not None and config.render.method.model_dump()["stiffness_n_per_m"] == 500
    wrong = f"{SEGMENTED}parts: {{1: a}}\n", "parts.4.name=a"
    (sentence,), (complaint,) = complaints(*wrong), located_complaints(*wrong)
    assert sentence.startswith("--set parts.4.name=a: 'a' is the name of part 1 as well")
    assert complaint == Complaint(("parts", 4, "name"), complaint.text, None, None)

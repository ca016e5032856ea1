"""Parts in pipeline files. Otherwise a wrong name or height would be felt, or a mistake could not be found."""

from pathlib import Path

import pytest

from tangible_core.errors import Complaint, ConfigError
from tangible_core.parts import HeightChoice, PartChoice
from tangible_core.pipeline.config.model import PipelineConfig
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.plugins.registry import default_registry

PATH = Path("here/p.yaml")
SCENE = "scene: {photo: a.png, segments: parts.png}\n"


RULE = ("materials", "rules", 0, "part")


def parse(text: str, *overrides: str) -> PipelineConfig:
    return parse_config(text, PATH, default_registry(), overrides)


def complaints(text: str, *overrides: str) -> tuple[list[str], list[Complaint]]:
    with pytest.raises(ConfigError) as error:
        parse(text, *overrides)
    return str(error.value).splitlines(), list(error.value.complaints)


FULL = f"""{SCENE}title: 1969
language: pt-BR
parts:
  1: wall
  7: {{name: ' helmet ', height_m: 4.2 mm, material: glass}}
  8:
  '9': {{}}
heights: {{by: given, bulge_m: 1 mm}}
materials: {{rules: [{{part: helmet, material: ice}}, {{part: 8, material: sand}}]}}
"""


def test_parts_are_read_by_number():
    config = parse(FULL)
    helmet = PartChoice(name=" helmet ", height_m=0.0042, material="glass")
    assert config.parts == {1: PartChoice(name="wall"), 7: helmet, 8: PartChoice(), 9: PartChoice()}
    assert config.heights == HeightChoice(by="given", bulge_m=0.001)
    assert (config.title, config.language) == ("1969", "pt-BR")
    assert (config.part_names, config.given_heights_m) == ({0: "wall", 6: "helmet"}, {6: 0.0042})
    assert [rule.part for rule in config.materials.rules] == ["helmet", 8]
    assert config.size[1:3] == (0.006, 0.0005)
    assert config.top_m == pytest.approx(0.0047)


def test_file_without_parts_has_none():
    config = parse(SCENE)
    assert (config.parts, config.heights, config.by_parts) == (None, None, False)
    assert (config.title, config.language, *config.size[1:3]) == ("", "en", 0.004, 0.0015)
    assert parse(f"{SCENE}parts:\n").by_parts
    assert parse(f"{SCENE}heights: guess\n").heights == HeightChoice(by="guess")
    assert parse("scene: {height: a.npy, segments: b.png}\nparts: {1: sea}\n").by_parts


@pytest.mark.parametrize(
    "text",
    [FULL, *(f"{SCENE}{end}\n" for end in ("parts: {}", "heights: depth", "parts: {1: {height_m: 1 mm}}\nheights:"))],
)
def test_completed_parts_are_read_back_equal(text: str):
    config = parse(text)
    again = parse(config.as_yaml())
    for name in ("part_names", "given_heights_m", "by_parts", "heights", "title", "language"):
        assert getattr(again, name) == getattr(config, name)
    assert again.as_yaml() == config.as_yaml()


@pytest.mark.parametrize(
    ("text", "place", "location", "word"),
    [
        ("parts: [wall]", "2:1", ("parts",), "mapping"),
        ("parts: {one: wall}", "2:9", ("parts", "one"), "not 'one'"),
        ("parts: {-1: wall}", "2:9", ("parts", -1), "not -1"),
        ("parts: {0: wall}", "2:9", ("parts", 0), "needs 1 more in each), not 0"),
        ("materials: {rules: [{part: 0, material: ice}]}", "2:22", RULE, "needs 1 more in each)"),
        ("parts: {true: wall}", "2:9", ("parts", "True"), "not True"),
        ("parts: {7: wall, '7': floor}", "2:18", ("parts", "7"), "twice"),
        ("parts: {7: 3}", "2:9", ("parts", 7), "the name of a part"),
        ("parts: {7: {nam: wall}}", "2:13", ("parts", 7, "nam"), "'name'?"),
        ("parts:\n  1: wall\n  7: {name: Wall}", "4:7", ("parts", 7, "name"), "of part 1 as well"),
        ("parts: {1: wall, 7: 'wall '}", "2:18", ("parts", 7, "name"), "of part 1 as well"),
        ("parts: {1: '12'}", "2:9", ("parts", 1, "name"), "number of a part"),
        ('parts: {1: "a\\nb"}', "2:9", ("parts", 1, "name"), "one line"),
        (f"parts: {{1: {'x' * 81}}}", "2:9", ("parts", 1, "name"), "over 80"),
        ("parts: {1: {material: glas}}", "2:13", ("parts", 1, "material"), "'glass'?"),
        ("parts: {1: {height_m: .nan}}\nheights: given", "2:13", ("parts", 1, "height_m"), "finite"),
        ("parts: {1: {height_m: -1 mm}}\nheights: given", "2:13", ("parts", 1, "height_m"), "greater than"),
        ("parts: {1: {height_m: 1 px}}\nheights: given", "2:13", ("parts", 1, "height_m"), "units"),
        ("parts: {1: {height_m: 1 mm}}", "2:13", ("parts", 1, "height_m"), "`heights: {by: given}`"),
        ("heights: {by: gues}", "2:11", ("heights", "by"), "'guess'?"),
        ("heights: {round_m: 6 mm}", "2:1", ("heights", "by"), "required"),
        ("heights: {by: given, round_m: .inf}", "2:22", ("heights", "round_m"), "finite"),
        ("heights: {by: given, bulge_m: 6 mm}", "2:1", ("heights",), "6.3 mm together"),
        ("title: [a]", "2:1", ("title",), "string"),
        ("title: " + "x" * 201, "2:1", ("title",), "200"),
        *((f'title: "{each}"', "2:1", ("title",), "control") for each in (r"a\nb", r"a\eb", r"a\x85b", r"a\Lb")),
        ("language: german?", "2:1", ("language",), "tag"),
        ("parts: {1: wall}\nmaterials: {rules: [{part: wal, material: ice}]}", "3:22", RULE, "'wall'?"),
        ("parts: {1: }\nmaterials: {rules: [{part: wal, material: ice}]}", "3:22", RULE, "names none"),
        ("materials: {rules: [{part: 1, material: ice}]}", "2:22", RULE, "nothing is by parts"),
    ],
)  # fmt: skip
def test_part_mistake_gives_one_line_with_its_place(text: str, place: str, location: tuple, word: str):
    (sentence,), (complaint,) = complaints(f"{SCENE}{text}\n")
    assert sentence == f"here/p.yaml:{place}: {complaint.text}"
    assert complaint.location == location
    assert word in sentence


def test_part_mistakes_come_all_at_once():
    parts = "{1: wall, 2: wall, 3: {material: glas}, x: 1}"
    text = f"{SCENE}parts: {parts}\nwant: nothing\nheights: {{by: given, bulge_m: 1}}\n"
    assert [each.location for each in complaints(text)[1]] == [
        ("want",), ("parts", "x"), ("heights", "bulge_m"), ("parts", 2, "name"), ("parts", 3, "material"),
    ]  # fmt: skip
    (complaint,) = complaints("scene: {height: a.npy, segments: b.png}\nheights: {by: given}\n")[1]
    assert (complaint.location, complaint.line) == (("heights",), 2)


def test_override_keeps_the_name_of_a_part():
    config = parse(f"{SCENE}parts: {{1: wall}}\nheights: given\n", "parts.1.height_m=2 mm", "parts.6.name=x")
    assert config.parts == {1: PartChoice(name="wall", height_m=0.002), 6: PartChoice(name="x")}
    config = parse(f"{SCENE}parts: {{1: wall}}\nheights: given\n", "heights.bulge_m=2 mm")
    assert config.heights == HeightChoice(by="given", bulge_m=0.002)
    config = parse("scene: builtin/brick\nrender: proxy\n", "render.stiffness_n_per_m=500")
    assert config.render is not None and config.render.method.model_dump()["stiffness_n_per_m"] == 500
    (sentence,), (complaint,) = complaints(f"{SCENE}parts: {{1: a}}\n", "parts.4.name=a")
    assert sentence.startswith("--set parts.4.name=a: 'a' is the name of part 1 as well")
    assert complaint == Complaint(("parts", 4, "name"), complaint.text, None, None)

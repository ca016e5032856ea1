"""Schemas, lists of parts and losses by a cure: else an editor or a person is told something else than is done."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from jsonschema import Draft202012Validator

from command_line import tangible
from tangible_authoring.editor_schema import for_editors
from tangible_authoring.fixing import losses
from tangible_authoring.listed_parts import MAX_CELLS, ListedPart, list_rows
from tangible_authoring.renumbering import Moved, moves
from tangible_core.data import PartMap
from tangible_core.parts import PartChoice, PartHeights
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.pipeline.config.schema import json_schema, materials_schema
from tangible_core.plugins.registry import default_registry
from tangible_core.preflight.verdict import Change
from tangible_core.scene.formats.pictures import DARKEST, LIGHTEST, MAX_CHROMA, STEPS, distinct_colours
from tangible_report.numbered_parts import Before


def test_schema_is_printed_or_written_beside_a_file_once(tmp_path: Path):
    answer = tangible("schema", "mine.yaml", cwd=tmp_path)
    assert answer.returncode == 2 and "mine.yaml" in answer.stderr
    assert not list(tmp_path.iterdir())
    assert json.loads(tangible("schema", cwd=tmp_path).stdout) == json_schema()
    for words, schema, name in (((), json_schema(), "tangible"), (("--materials",), materials_schema(), "materials")):
        file = tmp_path / f"{name}.yaml"
        file.write_text("scene: builtin/brick\n")
        for _ in range(2):
            assert tangible("schema", file, *words, cwd=tmp_path).returncode == 0
        assert json.loads((tmp_path / f"{name}.schema.json").read_text()) == for_editors(schema)
        assert file.read_text() == f"# yaml-language-server: $schema={name}.schema.json\nscene: builtin/brick\n"


def test_new_file_names_the_schema_next_to_it(tmp_path: Path):
    assert tangible("new", "builtin/brick", "--out", "mine.yaml", cwd=tmp_path).returncode == 0
    assert (tmp_path / "mine.yaml").read_text().startswith("# yaml-language-server: $schema=tangible.schema.json\n")
    assert json.loads((tmp_path / "tangible.schema.json").read_text()) == for_editors(json_schema())


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"scene": {"photos": "a.png"}}, "'photos' was unexpected"),
        ({"scene": 3}, "3 is not of type 'string', 'object'"),
        ({"depth": {"use": "zncc", "windw_px": 3}}, "'windw_px' was unexpected"),
        ({"depth": {"use": "znc"}}, "'znc' is not one of"),
        ({"depth": {}}, "'use' is a required property"),
        ({"workspace": {"width_m": "80 furlong"}}, "'80 furlong' does not match"),
        ({"workspace": {"width_m": 80}}, "80 is greater than the maximum of 10"),
    ],
)
def test_schema_for_editors_explains_the_alternative_that_was_meant(wrong: dict, said: str):
    file = {"scene": "builtin/brick", **wrong}
    (error,) = Draft202012Validator(for_editors(json_schema())).iter_errors(file)
    assert said in error.message
    assert not Draft202012Validator(json_schema()).is_valid(file)


def test_schema_for_editors_has_all_facts_in_descriptions():
    schema = for_editors(json_schema())
    width = schema["properties"]["workspace"]["properties"]["width_m"]["description"]
    assert width.endswith("\n\nIn m, at least 1e-06, at most 10, 0.08 by default.")
    use = schema["properties"]["depth"]["allOf"][1]["then"]["properties"]["use"]
    assert len(use["enum"]) == len([text for text in use["enumDescriptions"] if text])


def test_rows_have_place_share_height_and_material_of_each_part():
    labels = np.zeros((100, 2 * MAX_CELLS + 100), np.int32)
    labels[:, 900:], labels[99, 1], labels[40:60, 500:600] = 1, 2, 3
    heights = PartHeights((0.001, 0.002, 0.0, 0.003), ("a", "b", "c", "d"))
    choices = {1: PartChoice(name=" sea ", material="wood"), 3: PartChoice(name="sun")}
    rows = list_rows(PartMap(labels, (0, 1, 2, 3)), heights, choices)
    cells = labels.size
    assert rows == (
        ListedPart(0, "", "", (90_000 - 2001) / cells, 0.001, "a", ""),
        ListedPart(1, "sea", "on the right", 22_400 / cells, 0.002, "b", "wood"),
        ListedPart(2, "", "at the lower left", 1 / cells, 0.0, "c", ""),
        ListedPart(3, "sun", "in the middle", 2000 / cells, 0.003, "d", ""),
    )
    flat = list_rows(PartMap(labels, (0, 1, 2, 3)), None, {})
    assert {(each.height_m, each.why) for each in flat} == {(None, "")}


def test_each_colour_is_the_farthest_of_all_from_those_before_it():
    """By a search through all colours of the cube that are neither too dark, nor too light, nor glaring."""
    steps = np.rint(np.linspace(0, 255, STEPS))
    cube = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), -1).reshape(-1, 3).astype(np.uint8)
    lab = cv2.cvtColor(cube[None].astype(np.float32) / 255, cv2.COLOR_RGB2LAB)[0]
    chroma = np.hypot(lab[:, 1], lab[:, 2])
    cube, lab = (
        each[(lab[:, 0] >= DARKEST) & (lab[:, 0] <= LIGHTEST) & (chroma <= MAX_CHROMA)] for each in (cube, lab)
    )
    chosen = distinct_colours(30)
    at = [int(np.flatnonzero((cube == each).all(axis=1))[0]) for each in chosen]
    assert np.hypot(lab[at[0], 1], lab[at[0], 2]) == np.hypot(lab[:, 1], lab[:, 2]).max()
    for number in range(1, 30):
        nearest = np.linalg.norm(lab[:, None] - lab[at[:number]], axis=2).min(axis=1)
        assert nearest[at[number]] > nearest.max() - 1e-3


def test_moves_are_those_of_parts_that_the_file_names():
    """Three parts were 0, 1, 2, 3: the second was cut in two, the third is gone."""
    before = [Before(0, 0), Before(1, 1), Before(None, 1), Before(3, 3)]
    written = {
        0: "wall",
        1: {"name": "head"},
        2: {"height_m": "1 mm"},
        3: {"name": "foot", "material": "wood"},
        9: "old",
    }
    assert moves(written, before) == [Moved(2, None, ""), Moved(9, None, "old")]
    later = [Before(0, 0), Before(None, 1), Before(1, 1), Before(3, 3)]
    assert moves(written, later) == [Moved(1, 2, "head"), Moved(2, None, ""), Moved(9, None, "old")]
    assert moves(written, []) == []


TEXT = """\
scene: builtin/brick
want: touch
workspace: {smooth_m: 2 mm, relief_m: 5 mm, width_m: 80 mm}
relief: {slope: 2}
render: {use: proxy, stiffness_n_per_m: 800, damping_n_s_per_m: 0.5}
"""


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("workspace.smooth_m", "0.007", "blurs 3.5 times as much (`workspace.smooth_m: 7 mm` in place of 2 mm)"),
        ("workspace.relief_m", "0.002", "is 40 % as high (`workspace.relief_m: 2 mm` in place of 5 mm)"),
        ("relief.slope", "0.9", "has no slope above 0.9, so that steep edges become ramps (`relief.slope: 0.9` in"),
        ("render.stiffness_n_per_m", "400", "is 50 % as stiff (`render.stiffness_n_per_m: 400 N/m` in place of 800"),
        ("workspace.width_m", "0.04", "is 50 % as wide (`workspace.width_m: 40 mm` in place of 80 mm)"),
        ("workspace.smooth_m", "0.001", "blurs less"),
        ("workspace.relief_m", "0.00525", "is 1.1 times as high (`workspace.relief_m: 5.25 mm` in place of 5 mm)"),
        ("workspace.relief_m", "0.0052", "is 104 % as high (`workspace.relief_m: 5.2 mm` in place of 5 mm)"),
        ("relief.slope", "3", "may be steeper"),
        ("render.damping_n_s_per_m", "0.25", "is damped 50 % as much (`render.damping_n_s_per_m: 0.25 N s/m` in"),
        ("safety.stiffness_margin", "0.4", "may be only 50 % as stiff (`safety.stiffness_margin: 0.4` in place of"),
        ("safety.stiffness_margin", "0.96", "may be 1.2 times as stiff (`safety.stiffness_margin: 0.96` in place of"),
        ("safety.max_force_n", "2.5", "is changed (`safety.max_force_n: 2.5 N`)"),
        ("materials.fit", "device", "has materials that are felt more gently than they are, where the device cannot"),
        ("safety.coupling", "auto", "is felt through a spring, which makes hard things softer (`safety.coupling: a"),
    ],
)  # fmt: skip
def test_cure_is_said_with_what_it_takes_away(key: str, value: str, said: str):
    config = parse_config(TEXT, Path("p.yaml"), default_registry())
    (sentence,) = losses(config, {key: Change(key, value, "at most")})
    assert sentence.startswith(said)

"""A schema that is not written beside its file, or a file that is changed otherwise, leaves an editor without help."""

import json
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from command_line import tangible
from tangible_authoring.editor_schema import for_editors
from tangible_core.pipeline.config.schema import json_schema, materials_schema


def test_schema_is_printed(tmp_path: Path):
    assert json.loads(tangible("schema", cwd=tmp_path).stdout) == json_schema()


def test_schema_is_written_beside_a_file_which_names_it_once(tmp_path: Path):
    for words, schema, name in (((), json_schema(), "tangible"), (("--materials",), materials_schema(), "materials")):
        file = tmp_path / f"{name}.yaml"
        file.write_text("scene: builtin/brick\n")
        for _ in range(2):
            assert tangible("schema", file, *words, cwd=tmp_path).returncode == 0
        assert json.loads((tmp_path / f"{name}.schema.json").read_text()) == for_editors(schema)
        assert file.read_text() == f"# yaml-language-server: $schema={name}.schema.json\nscene: builtin/brick\n"


def test_schema_beside_a_file_that_is_not_there_is_refused(tmp_path: Path):
    answer = tangible("schema", "mine.yaml", cwd=tmp_path)
    assert answer.returncode == 2 and "mine.yaml" in answer.stderr
    assert not list(tmp_path.iterdir())


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

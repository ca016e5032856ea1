"""A schema that is not written beside its file, or a file that is changed otherwise, leaves an editor without help."""

import json
from pathlib import Path

from command_line import tangible
from tangible_core.pipeline.config.schema import json_schema, materials_schema


def test_schema_is_printed(tmp_path: Path):
    assert json.loads(tangible("schema", cwd=tmp_path).stdout) == json_schema()
    assert "## depth" in tangible("schema", "--markdown", cwd=tmp_path).stdout


def test_schema_is_written_beside_a_file_which_names_it_once(tmp_path: Path):
    for words, schema, name in (((), json_schema(), "tangible"), (("--materials",), materials_schema(), "materials")):
        file = tmp_path / f"{name}.yaml"
        file.write_text("scene: builtin/brick\n")
        for _ in range(2):
            assert tangible("schema", file, *words, cwd=tmp_path).returncode == 0
        assert json.loads((tmp_path / f"{name}.schema.json").read_text()) == schema
        assert file.read_text() == f"# yaml-language-server: $schema={name}.schema.json\nscene: builtin/brick\n"


def test_schema_beside_a_file_that_is_not_there_is_refused(tmp_path: Path):
    answer = tangible("schema", "mine.yaml", cwd=tmp_path)
    assert answer.returncode == 2 and "mine.yaml" in answer.stderr
    assert not list(tmp_path.iterdir())


def test_new_file_beside_a_schema_names_it(tmp_path: Path):
    for name, names_it in (("before", False), ("after", True)):
        assert tangible("new", "builtin/brick", "--out", f"{name}.yaml", cwd=tmp_path).returncode == 0
        assert ("$schema=tangible.schema.json\n" in (tmp_path / f"{name}.yaml").read_text()) == names_it
        assert tangible("schema", "before.yaml", cwd=tmp_path).returncode == 0

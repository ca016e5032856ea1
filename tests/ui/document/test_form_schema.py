"""The page's own tests of forms, over the schema of all methods that are installed here."""

import json
from pathlib import Path

from page_files import WEB, node
from tangible_core.pipeline.config.schema import json_schema


def test_form_has_a_control_with_default_and_bounds_for_every_option(tmp_path: Path, monkeypatch):
    schema = tmp_path / "schema.json"
    schema.write_text(json.dumps(json_schema(None, None)))
    monkeypatch.setenv("TANGIBLE_SCHEMA", str(schema))
    done = node("test/run.mjs", "--test-name-pattern", "every option", cwd=WEB)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "# pass 0" not in done.stdout

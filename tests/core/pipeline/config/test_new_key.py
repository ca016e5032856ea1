"""A new key of the pipeline file is one field of the model: everything but its stage follows from that."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[4]
MODEL = Path("tangible_core/pipeline/config/model.py")
BLOCK = '''
from ...scene.workspace import Section


class Grain(Section):
    """Grains on the surface."""

    shape: Literal["round", "sharp"]
    """Shape of a grain."""
    size_m: Annotated[float, Field(gt=0, le=0.01)] = 0.001
    """Diameter of a grain."""


class PipelineConfig(BaseModel):
'''
FIELD = '''
    grain: Annotated[Grain | None, Block("A word alone is `shape` (`grain: round`), or:", word="shape")] = None
    """Grains that are strewn over the surface."""
    workspace: Annotated[Workspace, Block()] ='''
PROGRAM = """
import json, sys
from pathlib import Path
import numpy as np
import tangible_core
from tangible_core import Pipeline, Scene
from tangible_core.cli.completing import keys
from tangible_core.errors import ConfigError
from tangible_core.pipeline.config.editing import edit_text
from tangible_authoring.schema_page import schema_page
from tangible_core.pipeline.config.model import KEYS
from tangible_core.pipeline.config.keys.key import Forms
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.plugins.registry import default_registry

registry, path = default_registry(), Path("p.yaml")

def complaints(make):
    try:
        make()
    except ConfigError as error:
        return str(error).splitlines()

def parse(text, *overrides):
    return parse_config(text, path, registry, overrides)

text = "scene: builtin/brick\\ngrain: {shape: round, size_m: 2 mm}\\n"
scene = Scene.heights(np.eye(4))
forms = Forms(registry, "tangible-images")
properties = {name: KEYS[name].schema_of_field(forms) for name in ("title", "grain", "workspace")}
print(json.dumps({
    "home": tangible_core.__file__,
    "completed": parse(text).as_data(),
    "again": parse(parse(text).as_yaml()).as_data() == parse(text).as_data(),
    "word": parse("scene: builtin/brick\\ngrain: sharp\\n").as_data()["grain"],
    "overridden": parse("scene: builtin/brick\\ngrain: sharp\\n", "grain.size_m=3 mm").as_data()["grain"],
    "edited": edit_text("scene: builtin/brick\\ngrain: sharp  # mine\\n", path, {"grain.size_m": 0.003}),
    "wrong": complaints(lambda: parse(text.replace("2 mm", "2 m").replace("round", "rond"))),
    "unknown": complaints(lambda: parse("scene: builtin/brick\\ngrian: round\\n")),
    "argument": complaints(lambda: Pipeline(scene, grain={"shape": "rond"}, cached=False)),
    "in_python": Pipeline(scene, grain="sharp", cached=False).config.grain.size_m,
    "offered": keys(type("Context", (), {"params": {}}), "grain"),
    "schema": properties["grain"],
    "page": schema_page({"properties": properties, "$defs": forms.definitions}),
}))
"""


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Return the answers of a copy of the core, in which one file has one more key."""
    copy = tmp_path_factory.mktemp("copy")
    shutil.copytree(ROOT / "tangible_core", copy / "tangible_core", ignore=shutil.ignore_patterns("__pycache__"))
    model = (copy / MODEL).read_text(encoding="utf-8")
    for before, after in (("\nclass PipelineConfig(BaseModel):\n", BLOCK), (FIELD[FIELD.rindex("\n") :], FIELD)):
        assert model.count(before) == 1
        model = model.replace(before, after)
    (copy / MODEL).write_text(model, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(copy), os.environ.get("PYTHONPATH", "")])}
    command = [sys.executable, "-c", PROGRAM]
    done = subprocess.run(command, capture_output=True, text=True, cwd=copy, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert Path(found["home"]).is_relative_to(copy)
    return found


def test_new_key_is_read_and_completed(answers: dict[str, Any]):
    assert list(answers["completed"])[:5] == ["scene", "language", "want", "grain", "workspace"]
    assert answers["completed"]["grain"] == {"shape": "round", "size_m": 0.002}
    assert answers["again"]


def test_new_key_has_a_shorthand_that_overrides_and_edits_keep(answers: dict[str, Any]):
    assert answers["word"] == {"shape": "sharp", "size_m": 0.001}
    assert answers["overridden"] == {"shape": "sharp", "size_m": 0.003}
    assert answers["edited"] == "scene: builtin/brick\ngrain: {shape: sharp, size_m: 0.003}  # mine\n"


def test_new_key_has_complaints_with_line_and_column(answers: dict[str, Any]):
    shape, size = answers["wrong"]
    assert shape.startswith("p.yaml:2:9: grain.shape: Input should be 'round' or 'sharp', not 'rond' (did you mean")
    assert size.startswith("p.yaml:2:22: grain.size_m: ")
    assert "unknown key 'grian' (did you mean 'grain'?)" in answers["unknown"][0]


def test_new_key_is_an_argument_of_the_pipeline(answers: dict[str, Any]):
    assert answers["in_python"] == 0.001
    assert answers["argument"][0].startswith("grain.shape: Input should be 'round' or 'sharp', not 'rond'")


def test_new_key_is_offered_by_the_shell(answers: dict[str, Any]):
    assert answers["offered"] == ["grain=", "grain.shape=", "grain.size_m="]


def test_new_key_stands_in_the_schema_and_on_the_page(answers: dict[str, Any]):
    block, words, null = answers["schema"]["anyOf"]
    assert block["properties"]["size_m"]["unit"] == "m"
    assert (words, null) == ({"enum": ["round", "sharp"]}, {"type": "null"})
    section = answers["page"].partition("## grain\n\n")[2]
    assert section.startswith("Grains that are strewn over the surface. A word alone is `shape` (`grain: round`), or:")
    assert "| `size_m` | number > 0 ≤ 0.01 or `6 mm` | `0.001` | Diameter of a grain. |" in section

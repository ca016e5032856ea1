"""The schema of pipeline files. Otherwise an editor would mark a right file as wrong, or a form lack an option."""

import json
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from ruamel.yaml import YAML

from tangible_authoring.editor_schema import for_editors
from tangible_core.errors import UnknownMethod
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.pipeline.config.schema import json_schema, materials_schema, method_schema, stage_schema
from tangible_core.plugins.registry import Registry, default_registry

ROOT = Path(__file__).parents[4]


@pytest.fixture(scope="module", params=[dict, for_editors], ids=["program", "editors"])
def validator(request: pytest.FixtureRequest) -> Draft202012Validator:
    schema = request.param(json_schema())
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


@pytest.mark.parametrize(
    "path",
    sorted(set(ROOT.glob("configs/*.yaml")) - set(ROOT.glob("configs/compare-*.yaml"))),
    ids=lambda path: path.name,
)
def test_schema_accepts_the_sample_configurations(validator: Draft202012Validator, path: Path):
    validator.validate(YAML(typ="safe").load(path))


@pytest.mark.parametrize(
    "wrong",
    [
        {},
        {"scene": "builtin/nothing"},
        {"scene": "builtin/brick", "depht": "luminance"},
        {"scene": "builtin/brick", "depth": {"use": "luminance", "no": 1}},
        {"scene": "builtin/brick", "render": {"use": "penalty-gradient", "stiffness_n_per_m": -1}},
        {"scene": "builtin/brick", "materials": {"one": "ice"}},
        {"scene": "builtin/brick", "materials": {"rules": [{"colour": "bleu", "material": "ice"}]}},
        {"scene": "builtin/brick", "workspace": {"width_m": 0}},
        {"scene": "builtin/brick", "parts": ["wall"]},
        {"scene": "builtin/brick", "parts": {"one": "wall"}},
        {"scene": "builtin/brick", "parts": {"1": {"nam": "wall"}}},
        {"scene": "builtin/brick", "parts": {"1": {"height_m": -1}}},
        {"scene": "builtin/brick", "heights": {"round_m": 0.001}},
        {"scene": "builtin/brick", "heights": "gess"},
        {"scene": "builtin/brick", "title": ["a"]},
        {"scene": "builtin/brick", "language": "?"},
    ],
)
def test_schema_refuses_what_the_program_refuses(validator: Draft202012Validator, wrong: dict):
    assert not validator.is_valid(wrong)


@pytest.mark.parametrize(
    "right",
    [
        {"parts": {"1": "wall", "7": {"name": "helmet", "height_m": "4.2 mm", "material": "glass"}, "8": None}},
        {"heights": {"by": "given", "round_m": "6 mm", "detail_m": 0}, "title": "Astronaut", "language": "pt-BR"},
        {"heights": "guess", "parts": None},
        {
            "heights": None,
            "materials": {"rules": [{"part": "helmet", "material": "ice"}, {"part": 4, "material": "ice"}]},
        },
    ],
)
def test_schema_accepts_parts_in_every_form(validator: Draft202012Validator, right: dict):
    validator.validate({"scene": {"photo": "a.png", "segments": "parts.png"}, **right})


@pytest.mark.parametrize("kind", ["depth", "texture", "render", "device"])
def test_every_shipped_method_has_a_described_form_and_a_default_in_json(kind: str):
    whole, stage, registry = json_schema(), stage_schema(kind), default_registry()
    Draft202012Validator.check_schema(stage)
    names, *forms = stage["anyOf"]
    assert whole["properties"][kind]["anyOf"] == [names, *forms]
    assert stage["$defs"].items() <= whole["$defs"].items()
    shipped = metadata.distribution("tangible-images").entry_points.select(group=f"tangible.{kind}")
    assert set(names["enum"]) == {point.name for point in shipped}
    for form in forms:
        for name, option in form["properties"].items():
            assert name == "use" or option.get("description"), f"{form['title']}.{name}"
    for name in registry.names(kind):
        config = parse_config(f"scene: builtin/brick\n{kind}: {name}\n", Path("p.yaml"), registry)
        assert json.loads(json.dumps(config.as_data(), allow_nan=False))[kind]["use"] == name


def test_form_has_titles_and_units():
    schema = json_schema()
    (proxy,) = (form for form in schema["properties"]["render"]["anyOf"] if form.get("title") == "proxy")
    stiffness = proxy["properties"]["stiffness_n_per_m"]
    assert (stiffness["title"], stiffness["unit"]) == ("Stiffness", "N/m")
    workspace = schema["properties"]["workspace"]["properties"]
    assert {name: option.get("unit") for name, option in workspace.items()} == {
        "width_m": "m", "relief_m": "m", "smooth_m": "m", "finest_m": "m", "holes": None,
        "scale": None, "exaggeration": None, "low_m": "m", "high_m": "m",
    }  # fmt: skip
    assert schema["properties"]["depth"]["anyOf"][1]["title"] == "auto"
    assert schema["$defs"]["VirtualHand"]["title"] == "Virtual hand"
    titles = [option["title"] for name, option in _options(schema) if name != "use"]
    assert len(titles) > 150 and all(title.strip() and "_" not in title for title in titles)


def _options(node: object) -> Iterator[tuple[str, dict]]:
    if isinstance(node, dict):
        options = node.get("properties", {}) if "properties" in node and "anyOf" not in node else {}
        if "scene" not in options:
            yield from options.items()
        for each in node.values():
            yield from _options(each)
    elif isinstance(node, list):
        for each in node:
            yield from _options(each)


def test_method_schema_imports_no_other_method():
    mock = Draft202012Validator(method_schema("device", "mock"))
    assert mock.is_valid({"use": "mock", "path": "circle", "hand": {"mass_kg": "90 g"}})
    assert not mock.is_valid({"use": "mock", "path": "circle", "hand": {"mass_kg": "90 m"}})
    loaded = list[str]()

    class Watched(Registry):
        def load(self, kind: str, name: str) -> Any:
            loaded.append(name)
            return super().load(kind, name)

    assert (method_schema("depth", "zncc", Watched())["title"], loaded) == ("zncc", ["zncc"])
    with pytest.raises(UnknownMethod, match="did you mean 'depth'"):
        stage_schema("depht")
    with pytest.raises(UnknownMethod, match="did you mean 'zncc'"):
        method_schema("depth", "znc")


def test_shipped_library_fits_the_schema_of_materials_and_a_new_material_needs_all_values():
    schema = materials_schema()
    Draft202012Validator.check_schema(schema)
    materials = Draft202012Validator(schema)
    materials.validate(YAML(typ="safe").load(ROOT / "tangible_core/materials/materials.yaml"))
    needed = ("stiffness_n_per_m", "damping_n_s_per_m", "static_friction", "dynamic_friction")
    for right in ({"ice": {"grain_m": 0.002}}, {"felt": dict.fromkeys(needed, 1)}):
        assert materials.is_valid(right), right
    for ice in ({"grain_m": 0}, {"texture": "rough"}, {"sorce": "guess"}):
        assert not materials.is_valid({"ice": ice}), ice
    assert not materials.is_valid({"felt": {"grain_m": 0.002}})
    for name, value in schema["$defs"]["material"]["properties"].items():
        assert value.get("description"), name

"""JSON Schema of a pipeline file, for completion in editors, and the same as a page to read."""

from collections.abc import Iterable
from typing import Any, NamedTuple, cast

from pydantic import BaseModel

from ...data.quantities import title_of, unit_of
from ...errors import TangibleError, UnknownMethod
from ...legibility.choice import SimplifyChoice
from ...materials.assignment import library
from ...materials.files import MaterialBlock
from ...parts import HeightChoice, PartChoice
from ...plugins.registry import Registry, default_registry
from ...scene.scene_files import BUILTINS, SceneFiles
from .config import PRODUCTS, SECTIONS, STAGES
from .parts_said import Inscription
from .scene_readers import scene_readers

_DIALECT = "https://json-schema.org/draft/2020-12/schema"


def json_schema(registry: Registry | None = None, distribution: str | None = "tangible-images") -> dict[str, Any]:
    """One schema for the whole file. A form has in it a `title` in words and the `unit` of every option.

    It takes the import of every method: see `stage_schema` and `method_schema`.
    distribution: only methods of this one, or of all that are installed when None. A broken plugin has no schema and
    takes nobody down.
    """
    registry = registry or default_registry()
    definitions: dict[str, Any] = {}
    return {
        "$schema": _DIALECT,
        "title": "Tangible Images pipeline",
        "type": "object",
        "required": ["scene"],
        "additionalProperties": False,
        "properties": {
            "scene": {
                "anyOf": [
                    {"enum": sorted(BUILTINS)},
                    *(_schema(each, definitions) for each in (SceneFiles, *scene_readers(distribution))),
                ]
            },
            **_schema(Inscription, definitions)["properties"],
            "want": {"enum": list(PRODUCTS), "default": "surface"},
            "parts": _parts(definitions),
            "heights": _heights(definitions),
            "simplify": {"anyOf": [_schema(SimplifyChoice, definitions), {"type": "null"}]},
            "workspace": _schema(SECTIONS["workspace"], definitions),
            "mapping": _schema(SECTIONS["mapping"], definitions),
            "materials": _materials(definitions),
            **{kind: _stage(kind, registry, distribution, definitions) for kind in STAGES},
            "export": _exporters(registry, distribution, definitions),
            "safety": _schema(SECTIONS["safety"], definitions),
        },
        "$defs": definitions,
    }


def stage_schema(
    kind: str, registry: Registry | None = None, distribution: str | None = "tangible-images"
) -> dict[str, Any]:
    """The schema of one stage alone (depth, texture, render, device), or of the list of exporters (export): what
    `json_schema` says of it, a whole schema.

    Raises: UnknownMethod for a stage that there is not.
    """
    if kind not in (known := (*STAGES, "export")):
        raise UnknownMethod("stage", kind, known)
    definitions: dict[str, Any] = {}
    registry = registry or default_registry()
    if kind == "export":
        stage = _exporters(registry, distribution, definitions)
    else:
        stage = _stage(kind, registry, distribution, definitions)
    return {"$schema": _DIALECT, "title": title_of(kind), **stage, "$defs": definitions}


def method_schema(kind: str, name: str, registry: Registry | None = None) -> dict[str, Any]:
    """The schema of one method's block alone; no other method is imported.

    Raises: UnknownMethod or BrokenMethod.
    """
    definitions: dict[str, Any] = {}
    form = _method_form(name, (registry or default_registry()).load(kind, name), definitions)
    return {"$schema": _DIALECT, **form, "$defs": definitions}


def materials_schema() -> dict[str, Any]:
    """The schema of a file of materials: of those that are shipped, only what changes must be said."""
    block = MaterialBlock.model_json_schema()
    change = {name: part for name, part in block.items() if name != "required"}
    return {
        "$schema": _DIALECT,
        "title": "Tangible Images materials",
        "type": "object",
        "properties": {name: {"$ref": "#/$defs/change"} for name in library()},
        "additionalProperties": {"$ref": "#/$defs/material"},
        "$defs": {"material": block, "change": change},
    }


def _materials(definitions: dict[str, Any]) -> dict[str, Any]:
    by_label = {"type": "object", "patternProperties": {"^[0-9]+$": {"type": "string"}}, "additionalProperties": False}
    return {"anyOf": [_schema(SECTIONS["materials"], definitions), by_label]}


def _parts(definitions: dict[str, Any]) -> dict[str, Any]:
    part = {"anyOf": [{"type": "string"}, {"type": "null"}, _schema(PartChoice, definitions)]}
    by_number = {"type": "object", "patternProperties": {"^[0-9]+$": part}, "additionalProperties": False}
    return {"anyOf": [by_number, {"type": "null"}], "title": "Parts", "description": PARTS}


def _heights(definitions: dict[str, Any]) -> dict[str, Any]:
    block = _schema(HeightChoice, definitions)
    return {"anyOf": [block, {"enum": block["properties"]["by"]["enum"]}, {"type": "null"}]}


def _stage(kind: str, registry: Registry, distribution: str | None, definitions: dict[str, Any]) -> dict[str, Any]:
    forms = [_method_form(name, cls, definitions) for name, cls in _methods(kind, registry, distribution)]
    return {"anyOf": [{"enum": _stage_names(kind, registry, distribution)}, *forms]}


def _exporters(registry: Registry, distribution: str | None, definitions: dict[str, Any]) -> dict[str, Any]:
    """A list: of one picture, several things are written."""
    each = _stage("export", registry, distribution, definitions)
    return {"anyOf": [{"type": "array", "items": each}, {"type": "null"}], "description": EXPORT}


def _method_form(name: str, cls: type[BaseModel], definitions: dict[str, Any]) -> dict[str, Any]:
    form = _schema(cls, definitions)
    form["title"] = name
    form["properties"] = {"use": {"const": name}, **form.get("properties", {})}
    form["required"] = ["use", *form.get("required", [])]
    return form


def _schema(model: type[BaseModel], definitions: dict[str, Any]) -> dict[str, Any]:
    schema = model.model_json_schema(ref_template="#/$defs/{model}")
    definitions.update(schema.pop("$defs", {}))
    return schema


def _stage_names(kind: str, registry: Registry, distribution: str | None) -> list[str]:
    """Names of the kind's methods that load, of one distribution or of all."""
    return [name for name, _ in _methods(kind, registry, distribution)]


def _methods(kind: str, registry: Registry, distribution: str | None) -> Iterable[tuple[str, type[BaseModel]]]:
    for name in registry.names(kind):
        try:
            if distribution in (None, registry.find(kind, name).distribution):
                yield name, registry.load(kind, name)
        except TangibleError:
            continue


class Option(NamedTuple):
    """An option of a method, in words."""

    name: str
    unit: str
    values: str
    """What may be written, with bounds."""
    default: str
    meaning: str


def options_of(model: type[BaseModel]) -> list[Option]:
    """All options of a method, those of a block below it as `block.option`."""
    blocks: dict[str, Any] = {}
    form = _schema(model, blocks)
    return [
        Option(
            name, unit_of(name), _type(option).replace("`", ""), _default(option).strip("`"),
            " ".join(option.get("description", "").split()),
        )
        for name, option in _options(form, blocks)
    ]  # fmt: skip


def markdown(schema: dict[str, Any]) -> str:
    """The schema as a reference page: every block, method and option."""
    lines = ["# The pipeline file", "", PREFACE, ""]
    properties, blocks = schema["properties"], schema["$defs"]
    lines += ["## scene", "", f"A builtin name ({_names(properties['scene']['anyOf'][0]['enum'])}), or files:", ""]
    lines += _table(properties["scene"]["anyOf"][1], blocks)
    for reader in properties["scene"]["anyOf"][2:]:
        lines += [f"Or {_described(reader, blocks)}", "", *_table(reader, blocks)]
    lines += ["## title, language", "", "What the whole is called, and in which language its parts are named.", ""]
    inscription = {"properties": {name: properties[name] for name in Inscription.model_fields}}
    lines += _table(inscription, blocks)
    lines += ["## want", "", f"What to make: {_names(properties['want']['enum'])}.", ""]
    lines += ["## parts", "", f"{PARTS} A word alone is a name (`{{0: wall, 6: helmet}}`), or ([more](parts.md)):", ""]
    lines += _table(properties["parts"]["anyOf"][0]["patternProperties"]["^[0-9]+$"]["anyOf"][2], blocks)
    lines += ["## heights", "", f"{HEIGHTS} A word alone is `by` (`heights: given`), or:", ""]
    lines += _table(properties["heights"]["anyOf"][0], blocks)
    lines += ["## simplify", "", f"{SIMPLIFY} `simplify: {{}}` takes the usual rules ([more](legibility.md)):", ""]
    lines += _table(properties["simplify"]["anyOf"][0], blocks)
    lines += ["## workspace", "", *_table(properties["workspace"], blocks)]
    lines += ["## mapping", "", *_table(properties["mapping"], blocks)]
    lines += ["## materials", "", "A map from label to material (`{0: ice, 1: sand}`), or:", ""]
    lines += _table(properties["materials"]["anyOf"][0], blocks)
    for kind in STAGES:
        lines += [f"## {kind}", "", *_forms(properties[kind], blocks)]
    lines += ["## export", "", f"{EXPORT} [More](export.md).", ""]
    lines += _forms(properties["export"]["anyOf"][0]["items"], blocks)
    lines += ["## safety", "", "Between every law and every device ([why](safety.md)).", ""]
    lines += _table(properties["safety"], blocks)
    return "\n".join(lines).rstrip() + "\n"


def _forms(stage: dict[str, Any], blocks: dict[str, Any]) -> list[str]:
    """Every method of a kind, with its options."""
    lines: list[str] = []
    for form in stage["anyOf"][1:]:
        summary = form.get("description", "").split("\n")[0]
        lines += [f"### {form['properties']['use']['const']}", "", summary, "", *_table(form, blocks)]
    return lines


PARTS = (
    "What is said of the connected parts of the segments, by number: parts are numbered from 0 in the order of their "
    "first pixels, row by row. With it, materials are one a part."
)
HEIGHTS = (
    "The relief is made of parts, each of one height, with rounded rims and a little of the picture's light, in place "
    "of depth or brightness; `null` switches it off."
)
SIMPLIFY = (
    "Parts that are too narrow or too small for fingers go to those beside them, before relief, materials and labels "
    "are made of the parts; each keeps its number."
)
EXPORT = (
    "What `tangible export` writes: a list of names of exporters, `[stl, swell]`, or of blocks with options, "
    "`[{use: pins, display: monarch}]`."
)
PREFACE = (
    "Generated by `tangible schema --markdown` from the classes themselves; `tangible schema` prints the same as JSON "
    "Schema, which editors use for completion: start a file with\n"
    "`# yaml-language-server: $schema=tangible.schema.json`.\n\n"
    "Relative paths are relative to the file itself. A number whose name ends with a unit may be written with another "
    "one of its kind, such as `6 mm`, `0.8 N/mm`, `250 ms`; without a unit, it is in that of the name."
)


def _names(values: Iterable[Any]) -> str:
    return ", ".join(f"`{value}`" for value in values)


def _described(form: dict[str, Any], blocks: dict[str, Any]) -> str:
    """Return the first sentence of a block's description, to go on after a word."""
    said = blocks[form["$ref"].rpartition("/")[2]]["description"] if "$ref" in form else form["description"]
    return f"{said[0].lower()}{said[1:].partition(chr(10))[0]}"


def _table(form: dict[str, Any], blocks: dict[str, Any]) -> list[str]:
    rows = [
        f"| `{name}` | {_type(option)} | {_default(option)} | {_cell(option)} |"
        for name, option in _options(form, blocks)
    ]
    return ["| key | values | default | meaning |", "|---|---|---|---|", *rows, ""] if rows else ["No options.", ""]


def _options(form: dict[str, Any], blocks: dict[str, Any], prefix: str = "") -> Iterable[tuple[str, dict[str, Any]]]:
    """Options by name, those of a block below it as `block.option`."""
    for name, option in form.get("properties", {}).items():
        if name == "use":
            continue
        inner = _inner(option)
        yield f"{prefix}{name}", {**option, "default": None} if inner else option
        for block in inner:
            yield from _options(blocks[block], blocks, f"{prefix}{name}.")


def _inner(option: dict[str, Any]) -> list[str]:
    """The blocks that an option is, may be, or is a list of."""
    forms = (option, *option.get("anyOf", ()), option.get("items", {}))
    return [each["$ref"].split("/")[-1] for each in forms if "$ref" in each]


def _cell(option: dict[str, Any]) -> str:
    return " ".join(option.get("description", "").split()).replace("|", "\\|")


def _default(option: dict[str, Any]) -> str:
    default = option.get("default")
    return "" if default is None else f"`{default}`"


def _type(option: dict[str, Any]) -> str:
    if forms := option.get("anyOf", option.get("oneOf")):
        return " or ".join(_type(each) for each in cast("list[dict[str, Any]]", forms))
    if "enum" in option:
        return _names(option["enum"])
    if "const" in option:
        return f"`{option['const']}`"
    if "examples" in option:
        return f"`{option['examples'][0]}`"
    bounds = [f"{sign} {option[word]}" for word, sign in BOUNDS.items() if word in option]
    return " ".join([option.get("type", "block"), *bounds])


BOUNDS = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}

"""JSON Schema of a pipeline file, for completion in editors and for the page's form."""

from typing import Any

from ...data.options import field_texts
from ...data.units import option_title
from ...errors import UnknownName
from ...materials.assignment import library
from ...materials.files import MaterialBlock
from ...plugins.registry import Registry, default_registry
from .keys import MethodBlock, MethodList
from .keys.key import Forms
from .model import KEYS, PipelineConfig

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def json_schema(registry: Registry | None = None, distribution: str | None = "tangible-images") -> dict[str, Any]:
    """Return one schema for the whole file; `distribution` limits it to methods of this one."""
    forms, texts = Forms(registry or default_registry(), distribution), field_texts(PipelineConfig)
    return {
        "$schema": DIALECT,
        "title": "Tangible Images pipeline",
        "type": "object",
        "required": [name for name in KEYS if PipelineConfig.model_fields[name].is_required()],
        "additionalProperties": False,
        "properties": {name: {**key.schema(forms), "description": texts.get(name, "")} for name, key in KEYS.items()},
        "$defs": forms.definitions,
    }


def stage_schema(
    kind: str, registry: Registry | None = None, distribution: str | None = "tangible-images"
) -> dict[str, Any]:
    """Return the schema of one stage alone (depth, texture, render, device), or of the list of exporters (export)."""
    if kind not in (stages := [name for name, key in KEYS.items() if isinstance(key, MethodBlock | MethodList)]):
        raise UnknownName("stage", kind, stages)
    forms = Forms(registry or default_registry(), distribution)
    return {
        "$schema": DIALECT,
        "title": option_title(kind),
        **KEYS[kind].schema(forms),
        "description": field_texts(PipelineConfig).get(kind, ""),
        "$defs": forms.definitions,
    }


def method_schema(kind: str, name: str, registry: Registry | None = None) -> dict[str, Any]:
    """Return the schema of one method's block alone; no other method is imported."""
    forms = Forms(registry or default_registry(), None)
    form = forms.of_method(name, forms.registry.load(kind, name))
    return {"$schema": DIALECT, **form, "$defs": forms.definitions}


def materials_schema() -> dict[str, Any]:
    """Return the schema of a file of materials; a shipped material needs only what changes."""
    block = MaterialBlock.model_json_schema()
    change = {name: part for name, part in block.items() if name != "required"}
    return {
        "$schema": DIALECT,
        "title": "Tangible Images materials",
        "type": "object",
        "properties": {name: {"$ref": "#/$defs/change"} for name in library()},
        "additionalProperties": {"$ref": "#/$defs/material"},
        "$defs": {"material": block, "change": change},
    }

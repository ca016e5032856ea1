"""The schema of a file in the form that editors serve best; it accepts what the schema of the program accepts."""

from collections.abc import Mapping, Sequence
from typing import Any, cast

Schema = dict[str, Any]
BOUNDS = {"minimum": "at least", "exclusiveMinimum": "above", "maximum": "at most", "exclusiveMaximum": "below"}


# Of alternatives, editors explain the first that fits as badly as the others, and they show the description alone.
def for_editors(schema: Schema) -> Schema:
    """Return the schema with its alternatives told apart, and with all facts of an option in its description."""
    return _rewrite(schema, schema.get("$defs", {}))


def _rewrite(node: Any, defs: Mapping[str, Schema]) -> Any:
    if isinstance(node, list):
        return [_rewrite(item, defs) for item in cast("list[Any]", node)]
    if not isinstance(node, dict):
        return node
    own = {key: _rewrite(value, defs) for key, value in cast(Schema, node).items()}
    for name, option in (own.get("properties") or {}).items():
        if name != "use" and isinstance(option, dict) and (facts := _facts(node["properties"][name])):
            option["description"] = f"{option.get('description', '')}\n\n{facts}".strip()
    if isinstance(own.get("pattern"), str) and "examples" in own:
        own["patternErrorMessage"] = f"Write a number with a unit, such as {own['examples'][0]}."
    if isinstance(own.get("anyOf"), list):
        own |= _by_type(own.pop("anyOf"), [_types(schema, defs) for schema in node["anyOf"]])
    return own


def _facts(option: Schema) -> str:
    number = next((schema for schema in (option, *option.get("anyOf", ())) if BOUNDS.keys() & schema.keys()), option)
    facts = [f"in {option['unit']}"] if "unit" in option else []
    facts += [f"{word} {number[key]:g}" for key, word in BOUNDS.items() if key in number]
    default = option.get("default")
    if isinstance(default, int | float | str) and default != "":
        facts.append(f"{f'{default:g}' if isinstance(default, float) else str(default).lower()} by default")
    text = ", ".join(facts)
    return f"{text[:1].upper()}{text[1:]}." if text else ""


def _types(node: Schema, defs: Mapping[str, Schema]) -> tuple[str, ...]:
    if "$ref" in node:
        return _types(defs[node["$ref"].rpartition("/")[2]], defs)
    if "anyOf" in node:
        return tuple(dict.fromkeys(kind for schema in node["anyOf"] for kind in _types(schema, defs)))
    kind = node.get("type", "string")  # names alone are an enumeration without a type
    return ("number" if kind == "integer" else kind,)


def _by_type(alternatives: Sequence[Schema], types: Sequence[tuple[str, ...]]) -> Schema:
    groups: dict[str, list[Schema]] = {}
    for alternative, kinds in zip(alternatives, types, strict=True):
        for kind in kinds:
            groups.setdefault(kind, []).append(alternative)
    branches = [{"if": {"type": kind}, "then": _one(group)} for kind, group in groups.items()]
    return {"type": list(groups), "allOf": branches} if len(groups) > 1 else _one(list(alternatives))


def _one(group: list[Schema]) -> Schema:
    """Return one schema for alternatives of one type: the method that `use:` names, the block that a key marks."""
    names = [schema.get("properties", {}).get("use", {}).get("const") for schema in group]
    if not all(names):
        one, *marked = group
        if not all(schema.get("required") for schema in marked):
            return {"anyOf": group}
        for schema in marked:
            one = {"if": {"required": schema["required"][:1]}, "then": schema, "else": one}
        return one
    about = [str(schema.get("description", "")).partition("\n")[0] for schema in group]
    use = {"enum": names, "enumDescriptions": about, "markdownEnumDescriptions": about}
    branches = [
        {"if": {"properties": {"use": {"const": name}}, "required": ["use"]}, "then": schema}
        for name, schema in zip(names, group, strict=True)
    ]
    return {"type": "object", "required": ["use"], "properties": {"use": use}, "allOf": branches}

"""Files of materials: YAML in, checked materials out; every complaint at once, each with file:line:column."""

from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

import numpy as np

from .data import Material
from .errors import MaterialError, did_you_mean
from .source import Source, Tree, parse_source, read_text

VALUES = tuple(each.name for each in fields(Material) if each.name not in ("name", "source"))
REQUIRED = ("stiffness_n_per_m", "damping_n_s_per_m", "static_friction", "dynamic_friction")


def read_materials(path: Path, base: Mapping[str, Material]) -> Mapping[str, Material]:
    """The base, and what a file adds to it or changes.

    Raises: ConfigError as `parse_materials`, or if there is no such file.
    """
    return parse_materials(read_text(path), path, base)


def parse_materials(text: str, path: Path, base: Mapping[str, Material]) -> Mapping[str, Material]:
    """The base, and what a text adds to it or changes; `path` is what complaints name.

    Raises: ConfigError with every complaint, one a line.
    """
    source = parse_source(text, path, "a library is a mapping from names to materials, such as `ice: {...}`")
    for name, block in source.tree.items():
        _check(source, name, block, base)
    source.settle()
    made = {name: _material(name, block, base, path) for name, block in source.tree.items()}
    return MappingProxyType({**base, **made})


def _check(source: Source, name: Any, block: Any, base: Mapping[str, Material]) -> None:
    before = len(source.complaints)
    if not isinstance(name, str):
        return source.complain((name,), f"{name!r} is no name; write it in quotes")
    if not isinstance(block, dict):
        return source.complain((name,), f"{name}: a material is a mapping from keys to values, not {block!r}")
    for key, value in cast(Tree, block).items():
        _check_value(source, name, key, value)
    if missing := [key for key in REQUIRED if key not in block and name not in base]:
        are = "is" if len(missing) == 1 else "are"
        source.complain((name,), f"{name}: {', '.join(missing)} {are} missing{did_you_mean(name, base)}")
    if len(source.complaints) == before:
        try:
            _material(name, cast(Tree, block), base, source.path)
        except MaterialError as error:
            source.complain((name,), str(error))
    return None


def _check_value(source: Source, name: str, key: Any, value: Any) -> None:
    place = (name, key)
    if key == "source":
        _check_source(source, name, value)
    elif key not in VALUES:
        keys = (*VALUES, "source")
        what = f"unknown key {key!r}{did_you_mean(str(key), keys)}; known: {', '.join(keys)}"
        source.complain(place, f"{name}: {what}")
    elif isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value < np.inf:
        source.complain(place, f"{name}: {key} is a number >= 0, not {value!r}")


def _check_source(source: Source, name: str, value: Any) -> None:
    if isinstance(value, dict):
        known = (*VALUES, "others")
        for key in cast(Tree, value):
            if key not in known:
                what = f"source of {key!r}, which is no value{did_you_mean(str(key), known)}"
                source.complain((name, "source", key), f"{name}: {what}")
    elif not isinstance(value, str):
        source.complain((name, "source"), f"{name}: source is a text, or a mapping from keys to texts, not {value!r}")


def _material(name: str, block: Tree, base: Mapping[str, Material], path: Path) -> Material:
    values = {key: float(block[key]) for key in VALUES if key in block}
    source = block.get("source")
    if isinstance(source, dict):
        source = "; ".join(f"{key}: {text}" for key, text in cast(Tree, source).items())
    if name not in base:
        return Material(name, **values, source=source or "guess")
    kept = base[name]
    changed = f"{', '.join(values)}: {path.name}; " if values else ""
    return replace(kept, **values, source=source or changed + kept.source)

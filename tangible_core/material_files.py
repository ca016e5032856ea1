"""Files of materials: YAML in, checked materials out; every complaint at once, each with file:line:column."""

from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

import numpy as np
from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError

from .data import Material
from .errors import MaterialError, did_you_mean

_Block = dict[Any, Any]
"""The parser's own mapping: a dict that knows where its parts stand."""

_Place = tuple[int, int]
_Complaint = tuple[_Place, str]

VALUES = tuple(each.name for each in fields(Material) if each.name not in ("name", "source"))
REQUIRED = ("stiffness_n_per_m", "damping_n_s_per_m", "static_friction", "dynamic_friction")


def read_materials(path: Path, base: Mapping[str, Material]) -> Mapping[str, Material]:
    """The base, and what a file adds to it or changes.

    Raises: MaterialError as `parse_materials`, or if there is no such file.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        near = did_you_mean(path.name, (each.name for each in path.parent.glob("*.y*ml")))
        raise MaterialError(f"{path}: there is no such file{near}") from error
    except (OSError, UnicodeDecodeError) as error:
        raise MaterialError(f"{path}: cannot be read as text: {error}") from error
    return parse_materials(text, str(path), base)


def parse_materials(text: str, file: str, base: Mapping[str, Material]) -> Mapping[str, Material]:
    """The base, and what a text adds to it or changes; `file` is what complaints name.

    Raises: MaterialError with every complaint, one a line.
    """
    tree = _parse(text, file)
    if wrong := [f"{file}:{line + 1}:{column + 1}: {what}" for (line, column), what in _complaints(tree, base)]:
        raise MaterialError("\n".join(wrong))
    return MappingProxyType({**base, **{name: _material(name, block, base, file) for name, block in tree.items()}})


def _parse(text: str, file: str) -> _Block:
    try:
        tree = cast(Any, YAML(typ="rt")).load(text)  # of ruamel's loaders, the one that knows places
    except MarkedYAMLError as error:
        mark: Any = cast(Any, error).problem_mark
        raise MaterialError(f"{file}:{mark.line + 1}:{mark.column + 1}: {cast(Any, error).problem}") from error
    except YAMLError as error:
        raise MaterialError(f"{file}: {str(error).splitlines()[0]}") from error
    if not isinstance(tree, dict):
        raise MaterialError(f"{file}:1:1: a library is a mapping from names to materials, such as `ice: {{...}}`")
    return cast(_Block, tree)


def _complaints(tree: _Block, base: Mapping[str, Material]) -> Iterator[_Complaint]:
    for name, block in tree.items():
        at = _place(tree, name)
        if not isinstance(name, str):
            yield at, f"{name!r} is no name; write it in quotes"
        elif not isinstance(block, dict):
            yield at, f"{name}: a material is a mapping from keys to values, not {block!r}"
        elif wrong := list(_complaints_of(name, cast(_Block, block), at, base)):
            yield from wrong
        else:
            try:
                _material(name, cast(_Block, block), base, "")
            except MaterialError as error:
                yield at, str(error)


def _complaints_of(name: str, block: _Block, at: _Place, base: Mapping[str, Material]) -> Iterator[_Complaint]:
    for key, value in block.items():
        if key == "source":
            yield from _complaints_of_source(name, value, _place(block, key))
        elif key not in VALUES:
            keys = (*VALUES, "source")
            what = f"unknown key {key!r}{did_you_mean(str(key), keys)}; known: {', '.join(keys)}"
            yield _place(block, key), f"{name}: {what}"
        elif isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value < np.inf:
            yield _place(block, key), f"{name}: {key} is a number >= 0, not {value!r}"
    if missing := [key for key in REQUIRED if key not in block and name not in base]:
        are = "is" if len(missing) == 1 else "are"
        yield at, f"{name}: {', '.join(missing)} {are} missing{did_you_mean(name, base)}"


def _complaints_of_source(name: str, source: Any, at: _Place) -> Iterator[_Complaint]:
    if isinstance(source, dict):
        known = (*VALUES, "others")
        for key in cast(_Block, source):
            if key not in known:
                what = f"source of {key!r}, which is no value{did_you_mean(str(key), known)}"
                yield _place(cast(_Block, source), key), f"{name}: {what}"
    elif not isinstance(source, str):
        yield at, f"{name}: source is a text, or a mapping from keys to texts, not {source!r}"


def _material(name: str, block: _Block, base: Mapping[str, Material], file: str) -> Material:
    values = {key: float(block[key]) for key in VALUES if key in block}
    source = block.get("source")
    if isinstance(source, dict):
        source = "; ".join(f"{key}: {text}" for key, text in cast(_Block, source).items())
    if name not in base:
        return Material(name, **values, source=source or "guess")
    kept = base[name]
    changed = f"{', '.join(values)}: {Path(file).name}; " if values else ""
    return replace(kept, **values, source=source or changed + kept.source)


def _place(block: _Block, key: Any) -> _Place:
    """Line and column of a key, from 0; those of the block where the key is merged in from elsewhere."""
    marks = cast(Any, block).lc
    return marks.key(key) if key in (marks.data or ()) else (marks.line, marks.col)

"""Changes to single keys of a YAML text; all other lines keep their order, form and comments."""

import json
import re
from collections.abc import Mapping
from copy import deepcopy
from enum import Enum
from pathlib import Path
from typing import Any, Final, cast

from ruamel.yaml import YAML
from ruamel.yaml.nodes import MappingNode, ScalarNode

from ...errors import ConfigError, quoted, wrong_argument
from ..paths import CONTROLS
from .bounds import MAX_DEPTH
from .source import Location, Shorthand, expand_shorthand, find_key, no_shorthand, parse_value, plain_tree

Node = Any  # a key or a value with its position in the text


class _Remove(Enum):
    REMOVE = "remove"


REMOVE: Final = _Remove.REMOVE
"""The value that removes a key."""

# Keys from the top of the file, as `render.stiffness_n_per_m` or a tuple, to values of JSON or `REMOVE`.
Changes = Mapping[str | Location, Any]


def change_text(text: str, path: Path, changes: Changes, shorthand: Shorthand = no_shorthand) -> str:
    """Return the text with these keys changed, one after the other.

    Another `use` clears the other options of its block; a block whose last option is removed is removed as well. Where
    a change cannot be made in its place (a value that an alias shares), the text is written anew without its comments.
    path: the file's name in complaints.
    Raises: ConfigError if the text is not YAML, a key leads into a list, or the values exceed the limits of a file;
    ArgumentError for a value that JSON cannot express.
    """
    target = plain_tree(text, path)
    for key, value in changes.items():
        parts = tuple(key.split(".")) if isinstance(key, str) else tuple(key)
        if not 0 < len(parts) <= MAX_DEPTH or "" in parts:
            raise ConfigError(f"{quoted(key)}: is not a key; write one such as render.stiffness_n_per_m")
        value, before = _with_label_keys(value), deepcopy(target)
        _change(target, parts, value, shorthand)
        if _canonical(before) != _canonical(target):
            text = _edit(text, parts, value, shorthand)
    if _holds(text, path, target):
        return text
    text = _as_lines(target)
    if _canonical(plain_tree(text, path)) != _canonical(target):
        raise ConfigError(f"{path}: {quoted(list(changes))} cannot be changed key by key; change the text itself")
    return text


def _with_label_keys(value: Any, depth: int = 0) -> Any:
    """Return a value of JSON with the labels of material maps as whole numbers; keys in JSON are words."""
    if depth > MAX_DEPTH:
        raise ConfigError(f"more than {MAX_DEPTH} blocks are nested")
    if isinstance(value, dict):
        return {
            find_key(key, {}): _with_label_keys(part, depth + 1) for key, part in cast("dict[Any, Any]", value).items()
        }
    if isinstance(value, list | tuple):
        return [_with_label_keys(part, depth + 1) for part in cast("list[Any]", value)]
    return value


def _holds(text: str, path: Path, target: dict[Any, Any]) -> bool:
    try:
        return _canonical(plain_tree(text, path)) == _canonical(target)
    except ConfigError:
        return False


def _canonical(node: Any) -> Any:
    """Return a form to compare by: 1 differs from true and 1.0, NaN equals NaN, and the order of keys is ignored."""
    if isinstance(node, dict):
        return {repr(key): _canonical(value) for key, value in cast("dict[Any, Any]", node).items()}
    if isinstance(node, list | tuple):
        return [_canonical(value) for value in cast("list[Any]", node)]
    return repr(node)


def _change(tree: dict[Any, Any], parts: Location, value: Any, shorthand: Shorthand) -> None:
    blocks = [tree]
    for depth, part in enumerate(parts[:-1]):
        node, key = blocks[-1], find_key(part, blocks[-1])
        if isinstance(node.get(key), list):
            raise ConfigError(f"{'.'.join(map(str, parts))}: {part} is a list; set it as a whole")
        if not isinstance(node.get(key), dict):
            block = expand_shorthand(node.get(key), shorthand(parts[: depth + 1]))
            if value is REMOVE and not block:
                return
            node[key] = block
        blocks.append(node[key])
    last, key = blocks[-1], find_key(parts[-1], blocks[-1])
    if value is REMOVE:
        _remove(blocks, parts)
    else:
        if key == "use" and last.get("use") != value:
            last.clear()
        last[key] = value


def _remove(blocks: list[dict[Any, Any]], parts: Location) -> None:
    """Remove a key, and the blocks around it that hold nothing else."""
    for block, part in zip(reversed(blocks), reversed(parts), strict=True):
        if block.pop(find_key(part, block), REMOVE) is REMOVE or block:
            return


def _edit(text: str, parts: Location, value: Any, shorthand: Shorthand) -> str:
    node: Any = cast(Any, YAML(typ="rt")).compose(text)
    above: list[tuple[Node, int]] = []
    for depth, part in enumerate(parts):
        index = _index(node, part)
        rest = parts[depth + 1 :]
        if index is None:
            return text if value is REMOVE else _append(text, node, part, _nest(rest, value))
        above.append((node, index))
        if not rest:
            break
        _, below = node.value[index]
        if not isinstance(below, MappingNode):
            block = expand_shorthand(below.value, shorthand(parts[: depth + 1]))
            _change(block, rest, value, no_shorthand)
            return _replace(text, node.value[index], block) if block else _cut(text, above)
        node = below
    if value is REMOVE:
        return _cut(text, above)
    if parts[-1] == "use" and len(parts) > 1:
        return _replace_method(text, above, value)
    node, index = above[-1]
    return _replace(text, node.value[index], value)


def _index(node: Any, part: Any) -> int | None:
    entries: list[Any] = cast(Any, node).value if isinstance(node, MappingNode) else []
    return next((i for i, (key, _) in enumerate(entries) if key.value == str(part)), None)


def _nest(parts: Location, value: Any) -> Any:
    for part in reversed(parts):
        value = {find_key(part, {}): value}
    return value


def _replace_method(text: str, above: list[tuple[Node, int]], value: Any) -> str:
    """Return the text with another method, without the options of the method before."""
    node, index = above[-1]
    if node.flow_style:
        around, at = above[-2]
        return _replace(text, around.value[at], {"use": value})
    for i in range(len(node.value) - 1, -1, -1):  # from the end, so that earlier positions stay valid
        entry = node.value[i]
        text = _replace(text, entry, value) if i == index else _cut_lines(text, entry)
    return text


def _replace(text: str, entry: tuple[Node, Node], value: Any) -> str:
    """Return the text with another value of a key. A block of lines becomes one line; the key's comment stays."""
    key, old = entry
    start, end = old.start_mark.index, _end(old, text)
    if start != end and (isinstance(old, ScalarNode) or old.flow_style):
        return text[:start] + on_one_line(value) + text[end:]
    colon = text.index(":", key.end_mark.index) + 1
    beside = text[colon : _line_end(text, colon)] if start != end else text[colon:start]
    end = _line_end(text, end) if start != end else end
    return f"{text[:colon]} {on_one_line(value)}{beside}{text[end:]}"


def _append(text: str, node: Node | None, part: Any, value: Any) -> str:
    """Return the text with one more key at the end of a block."""
    line = f"{on_one_line(find_key(part, {}))}: {on_one_line(value)}"
    if node is not None and node.flow_style:
        at = _entry_end(node.value[-1], text) if node.value else node.start_mark.index + 1
        return f"{text[:at]}{', ' if node.value else ''}{line}{text[at:]}"
    newline = "\r\n" if "\r\n" in text else "\n"
    last = _entry_end(node.value[-1], text) if node is not None else len(text)
    at = _line_end(text, last)
    indent = " " * node.value[0][0].start_mark.column if node is not None else ""
    before = "" if not text[:at] or text[:at].endswith("\n") else newline
    after = "" if text[at:].startswith(("\n", "\r\n")) else newline
    return f"{text[:at]}{before}{indent}{line}{after}{text[at:]}"


def _cut(text: str, above: list[tuple[Node, int]]) -> str:
    """Return the text without a key, and without the blocks around it that hold nothing else."""
    while len(above) > 1 and len(above[-1][0].value) == 1:
        above = above[:-1]
    node, index = above[-1]
    key, _ = node.value[index]
    if not node.flow_style:
        return _cut_lines(text, node.value[index])
    start, end = key.start_mark.index, _entry_end(node.value[index], text)
    if index + 1 < len(node.value):
        return text[:start] + text[node.value[index + 1][0].start_mark.index :]
    before = _entry_end(node.value[index - 1], text) if index else start
    if text[before:start].strip() == ",":
        return text[:before] + text[end:]
    return text[:start] + text[end:]


def _cut_lines(text: str, entry: tuple[Node, Node]) -> str:
    key, _ = entry
    start = key.start_mark.index - key.start_mark.column
    end = _line_end(text, _entry_end(entry, text))
    return text[:start] + text[end:].removeprefix("\r").removeprefix("\n")


def _line_end(text: str, start: int) -> int:
    """Return the end of the line at a position, before its line break."""
    end = text.find("\n", start)
    end = len(text) if end < 0 else end
    return end - 1 if end > start and text[end - 1] == "\r" else end


def _entry_end(entry: tuple[Node, Node], text: str) -> int:
    """Return the end of a key and its value; a key without a value ends with its colon."""
    key, value = entry
    is_empty = value.start_mark.index == value.end_mark.index
    return _end(value, text) if not is_empty else text.index(":", key.end_mark.index) + 1


def _end(node: Node, text: str) -> int:
    """Return the end of a value, without the blank lines and comments after a block."""
    start, end = node.start_mark.index, node.end_mark.index
    if isinstance(node, ScalarNode) or not node.value or node.flow_style:
        return start + len(text[start:end].rstrip())
    last = node.value[-1]
    return _entry_end(last, text) if isinstance(node, MappingNode) else _end(last, text)


def _as_lines(tree: dict[Any, Any], indent: str = "") -> str:
    """Return a tree as YAML, one key a line."""
    return "".join(f"{indent}{on_one_line(key)}:{_below(value, indent + '  ')}\n" for key, value in tree.items())


def _below(value: Any, indent: str) -> str:
    if isinstance(value, dict) and value:
        return "\n" + _as_lines(cast("dict[Any, Any]", value), indent).removesuffix("\n")
    return f" {on_one_line(value)}"


def on_one_line(value: Any) -> str:
    """Return a value as YAML on one line. Raises: ArgumentError for a value that JSON cannot express."""
    if isinstance(value, dict):
        entries = cast("dict[Any, Any]", value).items()
        return f"{{{', '.join(f'{on_one_line(key)}: {on_one_line(part)}' for key, part in entries)}}}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(on_one_line, cast('list[Any]', value)))}]"
    if isinstance(value, str):
        return value if _is_plain(value) else f'"{"".join(map(_escape, value))}"'
    if value is None or isinstance(value, bool | int | float):
        return _NUMBERS.get(str(value), str(value))
    raise wrong_argument("value", value, "a value that JSON can express")


def json_in_yaml(value: Any) -> str:
    r"""Return a value as JSON that YAML reads as the same value: YAML breaks lines at more characters.

    >>> json_in_yaml(["\x85", "\N{SLIGHTLY SMILING FACE}"])
    '["\\u0085", "\U0001f642"]'
    """
    text = json.dumps(value, ensure_ascii=False)
    return CONTROLS.sub(lambda control: f"\\u{ord(control[0]):04x}", text)


_NUMBERS = {"None": "null", "True": "true", "False": "false", "nan": ".nan", "inf": ".inf", "-inf": "-.inf"}
_MAX_PLAIN = 100
_PLAIN = re.compile(r"[\w./~]([\w./~ +-]*[\w./~])?")


def _is_plain(text: str) -> bool:
    """Return True if a text means itself in YAML without quotes."""
    return len(text) <= _MAX_PLAIN and bool(_PLAIN.fullmatch(text)) and text.isprintable() and parse_value(text) == text


def _escape(character: str) -> str:
    if character in '"\\':
        return f"\\{character}"
    return character if character.isprintable() else f"\\U{ord(character):08x}"

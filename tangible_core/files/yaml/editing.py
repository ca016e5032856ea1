"""Changes to a YAML text that leave the rest of it as it was written, with its comments and in its order."""

import re
from collections.abc import Mapping
from copy import deepcopy
from enum import Enum
from pathlib import Path
from typing import Any, Final, cast

from ruamel.yaml import YAML
from ruamel.yaml.nodes import MappingNode, ScalarNode

from ...errors import ConfigError, quoted, wrong_argument
from .bounds import MOST_DEPTH
from .source import Location, Shorthand, key_of, no_shorthand, parse_source, parse_value, plain, spelt_out

Node = Any
"""A key or a value that knows where it stands in the text."""


class _Remove(Enum):
    REMOVE = "remove"


REMOVE: Final = _Remove.REMOVE
"""What a change says where a key is to go."""

Changes = Mapping[str | Location, Any]
"""Keys from the top of the file, as `render.stiffness_n_per_m` or as a tuple, and what JSON can say, or `REMOVE`."""


def change_text(text: str, path: Path, changes: Changes, shorthand: Shorthand = no_shorthand) -> str:
    """A text in which these keys say that, one after the other; whatever else it says, it says as before.

    Another `use` clears the other options of its block; a block whose last option is removed goes with it. What cannot
    be changed in its place (a value that is shared by an alias) is written anew, and the comments are lost.
    path: what complaints name.
    Raises: ConfigError if the text is no YAML, a key leads into a list, or what is set is more than a file may hold;
    ArgumentError for what JSON cannot say.
    """
    meant = _tree(text, path)
    for key, value in changes.items():
        parts = tuple(key.split(".")) if isinstance(key, str) else tuple(key)
        if not 0 < len(parts) <= MOST_DEPTH or "" in parts:
            raise ConfigError(f"{quoted(key)}: is no key; write such as render.stiffness_n_per_m")
        value, before = _labelled(value), deepcopy(meant)
        _change(meant, parts, value, shorthand)
        if _canonical(before) != _canonical(meant):
            text = _spliced(text, parts, value, shorthand)
    if _says(text, path, meant):
        return text
    text = _written(meant)
    if _canonical(_tree(text, path)) != _canonical(meant):
        raise ConfigError(f"{path}: {quoted(list(changes))} cannot be changed key by key; change the text itself")
    return text


def on_one_line(value: Any) -> str:
    """A value as it stands in YAML, whatever characters it holds. Raises: ArgumentError for what JSON cannot say."""
    return _flow(value)


def _labelled(value: Any, depth: int = 0) -> Any:
    """JSON's keys are words; labels of a material map are whole numbers."""
    if depth > MOST_DEPTH:
        raise ConfigError(f"more than {MOST_DEPTH} blocks are nested")
    if isinstance(value, dict):
        return {key_of(key, {}): _labelled(each, depth + 1) for key, each in cast("dict[Any, Any]", value).items()}
    if isinstance(value, list | tuple):
        return [_labelled(each, depth + 1) for each in cast("list[Any]", value)]
    return value


def _tree(text: str, path: Path) -> dict[Any, Any]:
    return plain(parse_source(text, path, "it is a mapping", empty=True).tree)


def _says(text: str, path: Path, meant: dict[Any, Any]) -> bool:
    try:
        return _canonical(_tree(text, path)) == _canonical(meant)
    except ConfigError:
        return False


def _canonical(node: Any) -> Any:
    """Two that are equal say the same: 1 is neither true nor 1.0, NaN is NaN, and keys have no order."""
    if isinstance(node, dict):
        return {repr(key): _canonical(value) for key, value in cast("dict[Any, Any]", node).items()}
    if isinstance(node, list | tuple):
        return [_canonical(value) for value in cast("list[Any]", node)]
    return repr(node)


def _change(tree: dict[Any, Any], parts: Location, value: Any, shorthand: Shorthand) -> None:
    """The same change to plain values."""
    blocks = [tree]
    for depth, part in enumerate(parts[:-1]):
        node, key = blocks[-1], key_of(part, blocks[-1])
        if isinstance(node.get(key), list):
            raise ConfigError(f"{'.'.join(map(str, parts))}: {part} is a list; set it as a whole")
        if not isinstance(node.get(key), dict):
            block = spelt_out(node.get(key), shorthand(parts[: depth + 1]))
            if value is REMOVE and not block:
                return
            node[key] = block
        blocks.append(node[key])
    last, key = blocks[-1], key_of(parts[-1], blocks[-1])
    if value is REMOVE:
        _remove(blocks, parts)
    else:
        if key == "use" and last.get("use") != value:
            last.clear()
        last[key] = value


def _remove(blocks: list[dict[Any, Any]], parts: Location) -> None:
    """A key, and the blocks around it that hold nothing else."""
    for block, part in zip(reversed(blocks), reversed(parts), strict=True):
        if block.pop(key_of(part, block), REMOVE) is REMOVE or block:
            return


def _spliced(text: str, parts: Location, value: Any, shorthand: Shorthand) -> str:
    """The text with one change in its place, where there is one."""
    node: Any = _composed(text)
    above: list[tuple[Node, int]] = []
    for depth, part in enumerate(parts):
        index = _index(node, part)
        rest = parts[depth + 1 :]
        if index is None:
            return text if value is REMOVE else _added(text, node, part, _nested(rest, value))
        above.append((node, index))
        if not rest:
            break
        _, below = node.value[index]
        if not isinstance(below, MappingNode):
            block = spelt_out(below.value, shorthand(parts[: depth + 1]))
            _change(block, rest, value, no_shorthand)
            return _replaced(text, node.value[index], block) if block else _removed(text, above)
        node = below
    if value is REMOVE:
        return _removed(text, above)
    if parts[-1] == "use" and len(parts) > 1:
        return _used(text, above, value)
    node, index = above[-1]
    return _replaced(text, node.value[index], value)


def _composed(text: str) -> Any:
    return cast(Any, YAML(typ="rt")).compose(text)


def _index(node: Any, part: Any) -> int | None:
    entries: list[Any] = cast(Any, node).value if isinstance(node, MappingNode) else []
    return next((i for i, (key, _) in enumerate(entries) if key.value == str(part)), None)


def _nested(parts: Location, value: Any) -> Any:
    for part in reversed(parts):
        value = {key_of(part, {}): value}
    return value


def _used(text: str, above: list[tuple[Node, int]], value: Any) -> str:
    """Another method: what is said of the one before goes."""
    node, index = above[-1]
    if node.flow_style:
        around, at = above[-2]
        return _replaced(text, around.value[at], {"use": value})
    for i in range(len(node.value) - 1, -1, -1):  # from the end, so that what stands before keeps its place
        entry = node.value[i]
        text = _replaced(text, entry, value) if i == index else _without_lines(text, entry)
    return text


def _replaced(text: str, entry: tuple[Node, Node], value: Any) -> str:
    """Another value of a key. What was a block of lines becomes one, and the comment beside the key stays."""
    key, old = entry
    start, end = old.start_mark.index, _end(old, text)
    if start != end and (isinstance(old, ScalarNode) or old.flow_style):
        return text[:start] + _flow(value) + text[end:]
    colon = text.index(":", key.end_mark.index) + 1
    beside = text[colon : _line_end(text, colon)] if start != end else text[colon:start]
    end = _line_end(text, end) if start != end else end
    return f"{text[:colon]} {_flow(value)}{beside}{text[end:]}"


def _added(text: str, node: Node | None, part: Any, value: Any) -> str:
    """One more key at the end of a block."""
    said = f"{_flow(key_of(part, {}))}: {_flow(value)}"
    if node is not None and node.flow_style:
        at = _entry_end(node.value[-1], text) if node.value else node.start_mark.index + 1
        return f"{text[:at]}{', ' if node.value else ''}{said}{text[at:]}"
    newline = "\r\n" if "\r\n" in text else "\n"
    last = _entry_end(node.value[-1], text) if node is not None else len(text)
    at = _line_end(text, last)
    indent = " " * node.value[0][0].start_mark.column if node is not None else ""
    before = "" if not text[:at] or text[:at].endswith("\n") else newline
    after = "" if text[at:].startswith(("\n", "\r\n")) else newline
    return f"{text[:at]}{before}{indent}{said}{after}{text[at:]}"


def _removed(text: str, above: list[tuple[Node, int]]) -> str:
    """Without a key, and without the blocks around it that hold nothing else."""
    while len(above) > 1 and len(above[-1][0].value) == 1:
        above = above[:-1]
    node, index = above[-1]
    key, _ = node.value[index]
    if not node.flow_style:
        return _without_lines(text, node.value[index])
    start, end = key.start_mark.index, _entry_end(node.value[index], text)
    if index + 1 < len(node.value):
        return text[:start] + text[node.value[index + 1][0].start_mark.index :]
    before = _entry_end(node.value[index - 1], text) if index else start
    if text[before:start].strip() == ",":
        return text[:before] + text[end:]
    return text[:start] + text[end:]


def _without_lines(text: str, entry: tuple[Node, Node]) -> str:
    key, _ = entry
    start = key.start_mark.index - key.start_mark.column
    end = _line_end(text, _entry_end(entry, text))
    return text[:start] + text[end:].removeprefix("\r").removeprefix("\n")


def _line_end(text: str, start: int) -> int:
    """Where the line ends in which this stands, before its line break."""
    end = text.find("\n", start)
    end = len(text) if end < 0 else end
    return end - 1 if end > start and text[end - 1] == "\r" else end


def _entry_end(entry: tuple[Node, Node], text: str) -> int:
    """Where a key and its value end: one that says nothing ends with its colon."""
    key, value = entry
    said = value.start_mark.index != value.end_mark.index
    return _end(value, text) if said else text.index(":", key.end_mark.index) + 1


def _end(node: Node, text: str) -> int:
    """Where a value ends, without what follows a block of lines."""
    start, end = node.start_mark.index, node.end_mark.index
    if isinstance(node, ScalarNode) or not node.value or node.flow_style:
        return start + len(text[start:end].rstrip())
    last = node.value[-1]
    return _entry_end(last, text) if isinstance(node, MappingNode) else _end(last, text)


def _written(tree: dict[Any, Any], indent: str = "") -> str:
    """A text that says this, a key a line."""
    return "".join(f"{indent}{_flow(key)}:{_below(value, indent + '  ')}\n" for key, value in tree.items())


def _below(value: Any, indent: str) -> str:
    if isinstance(value, dict) and value:
        return "\n" + _written(cast("dict[Any, Any]", value), indent).removesuffix("\n")
    return f" {_flow(value)}"


def _flow(value: Any) -> str:
    """A value on one line."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{_flow(key)}: {_flow(each)}' for key, each in cast('dict[Any, Any]', value).items())}}}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_flow, cast('list[Any]', value)))}]"
    if isinstance(value, str):
        return value if _is_plain(value) else f'"{"".join(map(_escaped, value))}"'
    if value is None or isinstance(value, bool | int | float):
        return _NUMBERS.get(str(value), str(value))
    raise wrong_argument("value", value, "what JSON can say")


_NUMBERS = {"None": "null", "True": "true", "False": "false", "nan": ".nan", "inf": ".inf", "-inf": "-.inf"}
_MOST_PLAIN = 100
"""Characters of a word without quotes."""
_PLAIN = re.compile(r"[\w./~]([\w./~ +-]*[\w./~])?")


def _is_plain(text: str) -> bool:
    """Whether it says itself without quotes."""
    return (
        len(text) <= _MOST_PLAIN and bool(_PLAIN.fullmatch(text)) and text.isprintable() and parse_value(text) == text
    )


def _escaped(character: str) -> str:
    if character in '"\\':
        return f"\\{character}"
    return character if character.isprintable() else f"\\U{ord(character):08x}"

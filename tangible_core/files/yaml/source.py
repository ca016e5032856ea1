"""YAML parsed with the place of each key and value: all complaints at once, each with file:line:column."""

import re
import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

from pydantic import BaseModel, ValidationError
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap
from ruamel.yaml.error import YAMLError

from ...data.option_errors import Location as Location
from ...data.option_errors import has, sentences_about
from ...errors import Complaint, ConfigError, did_you_mean, quoted, shown
from ..paths import as_path, what_is_missing
from ..reading import MAX_TEXT_BYTES, in_words, read_bytes
from .bounds import MAX_DEPTH, MAX_DIGITS, BoundedConstructor, BoundedScanner, check_events

CONFLICT = re.compile(r"(<{7}|>{7}|={7}|\|{7})( |$)")
# Cures by a part of what the parser says; the first one counts.
CURES = {
    "\\t": "{text}; indent with spaces, not tabs",
    "mapping values are not allowed": "{text}; a text with a colon and a space stands in quotes, keys in one column",
    "could not find expected ':'": "{text}; a line is `key: value`, and what belongs to a key is indented",
    "cannot start any token": "{text}; a text that begins with this character stands in quotes",
    "undefined alias": "{text}; a text that begins with * stands in quotes",
    "unexpected end of stream": "{text}; end what was opened, such as quotes",
    "duplicate key": "{text}; remove one of them",
    "expected <block end>": "this line is indented unlike those above it; begin all lines of a block in one column",
}
Tree = dict[Any, Any]  # the parser's own mapping: a dict with the line and column of its parts
# The option that a bare word stands for where a block is expected, by location; "" for none.
Shorthand = Callable[[Location], str]


def no_shorthand(place: Location) -> str:
    """Return "": in this file a bare word never stands for a block."""
    return ""


@dataclass
class Source:
    """A parsed file that is being checked, and the complaints so far."""

    path: Path
    tree: Tree
    complaints: list[tuple[str, Complaint]] = field(default_factory=list[tuple[str, Complaint]])
    """Each complaint as a sentence that begins with its place, and as a record for programs."""
    overridden: dict[tuple[str, ...], str] = field(default_factory=dict[tuple[str, ...], str])
    """The texts of overrides, by location."""

    def override(self, text: str, shorthand: Shorthand = no_shorthand, place: Location = ()) -> None:
        """Apply `key.key=value`; a block with another `use` starts without the options of the method before."""
        keys, value = parse_override(text)
        parts: Location = place or keys
        node: Any = self.tree
        for depth, part in enumerate(parts[:-1], 1):
            key = part if isinstance(node, list) else find_key(part, node)
            below = cast(Any, node)[key] if has(node, key) else None
            if not has(node, key):
                self.overridden.setdefault(tuple(map(str, parts[:depth])), text)
            if isinstance(below, list) and not has(below, parts[depth]):
                raise _override_error(text, keys, f"{part} is a list; set it as a whole: {part}=[...]")
            if not isinstance(below, dict | list):
                cast(Any, node)[key] = CommentedMap(expand_shorthand(below, shorthand(parts[:depth])))
            node = cast(Any, node)[key]
        if parts[-1] == "use" and node.get("use") != value:
            node.clear()
        node[find_key(parts[-1], node)] = value
        self.overridden[tuple(map(str, parts))] = text

    def place(self, location: Location) -> str:
        """Return file:line:column of the deepest part of a location that the file has; for an override, its text."""
        if text := self._find_override(location):
            return _as_typed(text)
        line, column = self._mark(location)
        return f"{self.path}:{line}:{column}"

    def _find_override(self, location: Location) -> str | None:
        """Return the override that set this location or a block around it."""
        ends = range(len(location), 0, -1)
        texts = (self.overridden.get(tuple(str(part) for part in location[:end])) for end in ends)
        return next(filter(None, texts), None)

    def _mark(self, location: Location) -> tuple[int, int]:
        """Return line and column, from 1, of the deepest part of a location that the file has."""
        node: Any = self.tree
        line, column = 0, 0
        for part in location:
            if not isinstance(node, dict | list) or not has(node, part):
                continue
            marks = cast(Any, node).lc
            if marks.data and part in marks.data:
                line, column = marks.key(part) if isinstance(node, dict) else marks.item(part)
            node = cast(Any, node)[part]
        return line + 1, column + 1

    def complain(self, location: Location, text: str) -> None:
        """Add a complaint at a location."""
        mark = (None, None) if self._find_override(location) else self._mark(location)
        if tuple(map(str, location)) in self.overridden:  # its text names the key as it was typed
            text = text.removeprefix(f"{'.'.join(map(str, location))}: ")
        complaint = Complaint(tuple(map(_word_or_number, location)), text, *mark)
        self.complaints.append((f"{self.place(location)}: {text}", complaint))

    def settle(self) -> None:
        """Raise a ConfigError with every complaint, one a line, if there are any."""
        if self.complaints:
            raise self.error

    @property
    def error(self) -> ConfigError:
        """The error with every complaint, one a line."""
        return ConfigError(
            *(sentence for sentence, _ in self.complaints), complaints=(complaint for _, complaint in self.complaints)
        )

    def check_keys(self, keys: Iterable[str]) -> None:
        """Complain about every key of the file that is not one of these."""
        names = list(keys)
        for key in self.tree:
            if key not in names:
                hint = did_you_mean(str(key), names)
                self.complain((key,), f"unknown key {quoted(key)}{hint}; known: {', '.join(names)}")

    def items(self, key: str) -> list[Any]:
        """Return the list under a key of the file; [] after a complaint if it is not a list of at least one."""
        block = self.tree.get(key)
        if isinstance(block, list) and block:
            return cast("list[Any]", block)
        wrong = f"is a list of at least one, not {quoted(block)}" if key in self.tree else "is missing"
        self.complain((key,), f"`{key}:` {wrong}")
        return []

    def model(self, location: Location, model: type[BaseModel], block: Any) -> Any:
        """Return a block as a model, its paths relative to this file; None after complaints if it does not fit."""
        try:
            return _relative_to(self.path.parent, model.model_validate(plain(block)))
        except ConfigError as error:
            self.complain(location, str(error))
            return None
        except ValidationError as error:
            for where, sentence in sentences_about(error, model, plain(block), location):
                self.complain(where, sentence)
            return None


def read_text(path: Path) -> str:
    """Read the text of a YAML file. Raises: ConfigError; if there is no such file, with a similar name that exists."""
    try:
        return read_bytes(path, MAX_TEXT_BYTES).decode("utf-8-sig")
    except FileNotFoundError as error:
        missing = what_is_missing(path, (file.name for file in path.parent.glob("*.y*ml")))
        raise ConfigError(f"{path}: {missing}") from error
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read as text: {getattr(error, 'strerror', None) or error}") from error


def parse_source(text: str, path: Path, what: str, overrides: Iterable[str] = (), *, empty: bool = False) -> Source:
    """Parse a YAML text into a source that is ready to be checked."""
    try:
        tree = parse_value(text)
    except YAMLError as error:
        mark, problem = _conflict(text) or (_error_mark(error), _problem(error))
        place = ":".join(map(str, (path, *mark)))
        raise ConfigError(f"{place}: {problem}", complaints=[Complaint((), problem, *mark)]) from error
    if tree is None and empty:
        tree = CommentedMap()
    what = f"the file is empty; {what}" if tree is None else what
    if not isinstance(tree, dict):
        raise ConfigError(f"{path}:1:1: {what}", complaints=[Complaint((), what, 1, 1)])
    source = Source(path, cast(Tree, tree))
    for override in overrides:
        source.override(override)
    return source


def parse_override(text: str) -> tuple[tuple[str, ...], Any]:
    """Return the keys and the value of `key.key=value`. Raises: ConfigError if the text has another form."""
    keys, equals, value = text.partition("=")
    parts = tuple(keys.strip().split("."))
    if not equals or not all(parts) or len(parts) > MAX_DEPTH:
        raise _override_error(text, (), "write key.key=value, such as render.stiffness_n_per_m=500")
    try:
        return parts, parse_value(value)
    except YAMLError as error:
        raise _override_error(text, parts, f"{quoted(value)} is not a YAML value: {_problem(error)}") from error


def parse_value(text: str) -> Any:
    """Parse a YAML text into the parser's own values. Raises: YAMLError."""
    if len(text) > MAX_TEXT_BYTES:
        raise YAMLError(f"it holds more than {in_words(MAX_TEXT_BYTES)}")
    yaml: Any = YAML(typ="rt")  # the one loader of ruamel that keeps lines and columns
    yaml.Constructor = BoundedConstructor
    parser: Any = YAML(typ="rt")
    parser.Scanner = BoundedScanner
    with warnings.catch_warnings(action="ignore"):  # about anchors that occur twice
        try:
            check_events(parser.parse(text))
            return yaml.load(text)
        except YAMLError:
            raise
        except Exception as error:  # the parser is not made for hostile input
            raise YAMLError(f"it cannot be parsed: {error}") from error


def _problem(error: YAMLError) -> str:
    problem = getattr(error, "problem", None) or getattr(error, "context", None) or error
    text = shown(str(problem).strip().splitlines()[0], 200)
    return next((cure for part, cure in CURES.items() if part in text), "{text}").format(text=text)


def _conflict(text: str) -> tuple[tuple[int, int], str] | None:
    """Return the place of the first mark of a merge conflict, and what to do about it."""
    lines = text.splitlines()
    line = next((number for number, line in enumerate(lines, 1) if CONFLICT.match(line)), 0)
    return ((line, 1), "a merge has left both versions here; keep one, and remove the marks") if line else None


def _error_mark(error: YAMLError) -> tuple[int, int] | tuple[()]:
    """Return line and column, from 1, of a parser's error; () if it has none."""
    mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
    return (mark.line + 1, mark.column + 1) if mark else ()


def _override_error(override: str, location: Location, problem: str) -> ConfigError:
    return ConfigError(f"{_as_typed(override)}: {problem}", complaints=[Complaint(location, problem)])


def _as_typed(override: str) -> str:
    return f"--set {shown(override)}"


def expand_shorthand(value: Any, option: str) -> dict[str, Any]:
    """Return the block that replaces a value: with the value as this option, if a bare word may stand for it."""
    return {option: value} if option and isinstance(value, str) else {}


def find_key(part: Any, node: Mapping[Any, Any]) -> Any:
    """Return a key as the tree has it: a word, or a whole number for the labels of a material map."""
    if not isinstance(part, str) or part in node:
        return part
    return int(part) if part.isdecimal() and len(part) <= MAX_DIGITS else part


def _word_or_number(part: Any) -> str | int:
    """Return a key as JSON can express it."""
    return int(part) if isinstance(part, int) and not isinstance(part, bool) else str(part)


def _relative_to(folder: Path, model: BaseModel) -> BaseModel:
    paths = {name: as_path(value) for name, value in model if isinstance(value, Path) and not value.is_absolute()}
    return model.model_copy(update={name: (folder / value).absolute() for name, value in paths.items()})


def plain(node: Any) -> Any:
    """Return plain Python values in place of the parser's own types."""
    if isinstance(node, dict):
        return {key: plain(value) for key, value in cast("dict[Any, Any]", node).items()}
    if isinstance(node, list):
        return [plain(value) for value in cast("list[Any]", node)]
    for kind in (bool, int, float, str):
        if isinstance(node, kind):
            return kind(node)
    return node


def plain_tree(text: str, path: Path) -> dict[Any, Any]:
    """Return a YAML text as plain values; an empty text is an empty mapping."""
    return plain(parse_source(text, path, "it is a mapping", empty=True).tree)

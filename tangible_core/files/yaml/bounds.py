"""Limits on a YAML text: its depth, its size with aliases expanded, and the length of its numbers."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, cast, final

from ruamel.yaml.comments import TaggedScalar
from ruamel.yaml.constructor import RoundTripConstructor
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.scanner import RoundTripScanner

from ...errors import quoted

MAX_DEPTH = 20  # the most levels of nested blocks; files for this program need six
TOO_DEEP = f"more than {MAX_DEPTH} blocks are nested"
# The most keys, values and blocks with aliases expanded: enough for a rule for each of 4,096 segments.
MAX_NODES = 40_000
MAX_DIGITS = 64  # the most characters of a number, with its sign, point and exponent

_TAG = "tag:yaml.org,2002:"
# Tags of which the parser makes plain values; of others, also that of a text, it makes objects of its own.
_PLAIN = (None, *(_TAG + kind for kind in ("int", "float", "bool", "null")))
_NUMBERS = ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float")


@dataclass
class _Block:
    """A mapping or a list that is not closed yet."""

    anchor: str | None
    is_mapping: bool
    parts: int = 0
    nodes: int = 1


@final
@dataclass
class _Count:
    open: list[_Block] = field(default_factory=list[_Block])
    # The number of nodes that an alias to each closed anchor stands for.
    nodes_of: dict[str, int] = field(default_factory=dict[str, int])


def check_events(events: Iterable[Any]) -> None:
    """Check the events of a parser one after the other, before a tree is built from them."""
    count = _Count()
    for event in events:
        kind, tag = type(event).__name__, getattr(event, "tag", None)
        if tag == f"{_TAG}set" or (kind == "ScalarEvent" and tag not in _PLAIN):
            raise _refusal(
                event, f"a value cannot have the tag {quoted(tag)}; leave it out, and write the value itself"
            )
        if kind in ("MappingStartEvent", "SequenceStartEvent"):
            _open(count, event, kind == "MappingStartEvent")
        elif kind in ("MappingEndEvent", "SequenceEndEvent"):
            block = count.open.pop()
            _add(count, event, block.nodes, block.anchor)
        elif kind == "AliasEvent":
            _alias(count, event)
        elif kind == "ScalarEvent":
            _add(count, event, 1, event.anchor)


def _open(count: _Count, event: Any, is_mapping: bool) -> None:
    if count.open and _is_key(count.open[-1]):
        raise _refusal(event, "a key must be a word or a number, not a list or a mapping")
    if len(count.open) >= MAX_DEPTH:
        raise _refusal(event, TOO_DEEP)
    count.open.append(_Block(event.anchor, is_mapping))


def _alias(count: _Count, event: Any) -> None:
    if any(block.anchor == event.anchor for block in count.open):
        raise _refusal(event, "an alias refers to a block that contains it")
    nodes = count.nodes_of.get(event.anchor, 1)  # the parser reports an unknown anchor
    if nodes > 1 and count.open and _is_key(count.open[-1]):
        raise _refusal(event, "a key must be a word or a number, not a list or a mapping")
    _add(count, event, nodes, None)


def _add(count: _Count, event: Any, nodes: int, anchor: str | None) -> None:
    """Add a complete node to the open blocks around it."""
    if anchor is not None:
        count.nodes_of[anchor] = nodes
    if not count.open:
        return
    count.open[-1].parts += 1
    count.open[-1].nodes += nodes
    if sum(block.nodes for block in count.open) > MAX_NODES:
        raise _refusal(event, f"there are more than {MAX_NODES} values, aliases expanded")


def _is_key(block: _Block) -> bool:
    return block.is_mapping and block.parts % 2 == 0


def _refusal(event: Any, problem: str) -> MarkedYAMLError:
    return MarkedYAMLError(None, None, problem, event.start_mark)


@final
class BoundedScanner(RoundTripScanner):
    """A scanner that refuses the first bracket that is too deep.

    The parser's events come too late for it: to find a key, the scanner reads a thousand characters ahead, in a time
    that grows with the square of the open brackets.
    """

    def fetch_flow_collection_start(self, TokenClass: Any, to_push: str) -> None:
        """Read an opening bracket. Raises: MarkedYAMLError if it is too deep."""
        scanner: Any = self
        if len(scanner.flow_context) >= MAX_DEPTH:
            raise MarkedYAMLError(None, None, TOO_DEEP, scanner.reader.get_mark())
        cast(Any, super()).fetch_flow_collection_start(TokenClass, to_push)


@final
class BoundedConstructor(RoundTripConstructor):
    """A constructor that limits the length of numbers, keeps dates as text, and gives the place of other errors."""

    def construct_non_recursive_object(self, node: Any, tag: str | None = None) -> Any:
        """Return the value of a node."""
        if node.tag in _NUMBERS and len(node.value) > MAX_DIGITS:
            raise MarkedYAMLError(None, None, f"a number of more than {MAX_DIGITS} digits", node.start_mark)
        try:
            value: Any = cast(Any, super()).construct_non_recursive_object(node, tag)
            is_mark = isinstance(value, TaggedScalar)  # `<<` in place of a value
            return str(cast(Any, value).value) if is_mark else value
        except YAMLError:
            raise
        except Exception as error:  # such as ValueError, for `!!int word`
            raise MarkedYAMLError(None, None, f"it cannot be parsed: {error}", node.start_mark) from error


_bounded: Any = BoundedConstructor
_bounded.add_constructor("tag:yaml.org,2002:timestamp", _bounded.construct_yaml_str)  # YAML 1.2 has no dates

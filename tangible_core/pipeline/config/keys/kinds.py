"""Keys with methods, with parts by number, and with the scene."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, cast

from pydantic import BaseModel
from ruamel.yaml.comments import CommentedMap

from ....data.part_words import FROM_ONE
from ....errors import MAX_QUOTED, BrokenMethod, ConfigError, TangibleError, quoted
from ....files.yaml.source import Location
from ....parts import PartChoice
from ....plugins.interfaces import KINDS
from ....scene.scene import Scene
from ....scene.scene_files import BUILTINS, SceneFiles, unknown_scene
from ..methods import NamedMethod, choose, named_method
from ..scene_readers import find_scene_reader, scene_reader_points, scene_readers
from .block import by_number
from .key import Forms, Key, Reading, Unchecked


@dataclass(frozen=True)
class MethodBlock(Key, Unchecked):
    """A key with one method of the kind that it is named after."""

    stands_last = True

    def read(self, reading: Reading, block: Any) -> Any:
        return choose(reading.source, (self.name,), self.name, block, reading.registry)

    def take(self, reading: Reading, value: Any) -> Any:
        return _take_method((self.name,), self.name, reading, value)

    def write(self, value: NamedMethod[Any]) -> Any:
        return value.as_written(self.name)

    def word_option(self, depth: int) -> str:
        return "use" if depth == 1 else ""

    def settings(self) -> Iterable[str]:
        return (f"{self.name}.use=",)

    def models(self, value: NamedMethod[Any] | None) -> Mapping[Location, BaseModel]:
        return {} if value is None else {(self.name,): value.method}

    def schema(self, forms: Forms) -> dict[str, Any]:
        return forms.of_kind(self.name)


@dataclass(frozen=True)
class MethodList(Key, Unchecked):
    """A key with a list of methods of the kind that it is named after."""

    stands_last = True

    def read(self, reading: Reading, block: Any) -> Any:
        if block is None:
            return ()
        if not isinstance(block, list):
            names = ", ".join(reading.registry.names(self.name))
            return reading.source.complain(
                (self.name,),
                f"{self.name}: takes a list of {_plural(self.name)}, such as [{{use: ...}}], not {quoted(block)}; "
                f"installed: {names}",
            )
        entries = enumerate(cast("list[Any]", block))
        methods = [
            choose(reading.source, (self.name, at), self.name, method, reading.registry) for at, method in entries
        ]
        return tuple(method for method in methods if method is not None)

    def take(self, reading: Reading, value: Any) -> Any:
        methods = [value] if isinstance(value, str) else value
        return tuple(_take_method((self.name, at), self.name, reading, method) for at, method in enumerate(methods))

    def write(self, value: Iterable[NamedMethod[Any]]) -> Any:
        return [method.as_written(self.name) for method in value]

    def word_option(self, depth: int) -> str:
        return "use" if depth == 2 else ""

    def models(self, value: Iterable[NamedMethod[Any]]) -> Mapping[Location, BaseModel]:
        return {(self.name, index): method.method for index, method in enumerate(value)}

    def schema(self, forms: Forms) -> dict[str, Any]:
        return {"anyOf": [{"type": "array", "items": forms.of_kind(self.name)}, {"type": "null"}]}


def _take_method(place: Location, kind: str, reading: Reading, method: Any) -> NamedMethod[Any] | None:
    """Return a method with its name, from an object or from what a file may have; None after a complaint."""
    if isinstance(method, str | Mapping):
        block = dict(cast("Mapping[str, Any]", method)) if isinstance(method, Mapping) else method
        return choose(reading.source, place, kind, block, reading.registry)
    try:
        return named_method(kind, method, reading.registry)
    except ConfigError as error:
        return reading.source.complain(place, str(error))


def _plural(kind: str) -> str:
    return f"{KINDS[cast(Any, kind)].__name__.lower()}s"


def find_or_add(methods: list[Any], name: str) -> int:
    """Find a method in a list of a file by its name, or its number from 0; a method that is not there is added.

    >>> find_or_add(["stl", {"use": "swell"}], "swell")
    1
    """
    if name.isdecimal() and int(name) < len(methods):
        return int(name)
    for index, entry in enumerate(methods):
        if name == (cast("dict[Any, Any]", entry).get("use") if isinstance(entry, dict) else entry):
            return index
    methods.append(CommentedMap(use=name))
    return len(methods) - 1


EXAMPLE = "{1: wall, 7: {name: helmet, height_m: 4 mm}}"


@dataclass(frozen=True)
class PartsBlock(Key, Unchecked):
    """The key with a name, a height and a material for parts, by number."""

    def read(self, reading: Reading, block: Any) -> Any:
        source = reading.source
        if not isinstance(block, dict | None):
            example = f"takes a mapping from the number of a part to its name, such as {EXAMPLE}"
            source.complain((self.name,), f"{self.name}: {example}, not {quoted(block)}")
            return {}
        parts: dict[int, PartChoice] = {}
        for key, part in cast("dict[Any, Any]", block or {}).items():
            number, place = _number(key), (self.name, key)
            if number is None or number in parts:
                source.complain(place, f"{self.name}.{key}: {_no_number(key) if number is None else 'is there twice'}")
            elif isinstance(part, PartChoice):
                parts[number] = part
            elif not isinstance(part, str | dict | None):
                expected = "takes the name of a part, or {name: ..., height_m: ..., material: ...}"
                source.complain(place, f"{self.name}.{key}: {expected}, not {quoted(part)}")
            elif (choice := source.model(place, PartChoice, {} if part is None else part)) is not None:
                parts[number] = choice
        return parts

    def take(self, reading: Reading, value: Any) -> Any:
        if not isinstance(value, Mapping):
            return self.read(reading, value)
        blocks = dict[Any, Any]()
        for key, part in cast("Mapping[Any, Any]", value).items():
            if isinstance(key, str):  # only JSON's keys have to be words
                reading.source.complain((self.name, key), f"{self.name}.{key}: {_no_number(key)}")
            else:
                blocks[key] = dict(cast("Mapping[Any, Any]", part)) if isinstance(part, Mapping) else part
        return self.read(reading, blocks)

    def write(self, value: Mapping[int, PartChoice]) -> Any:
        return {number: part.model_dump(mode="json", exclude_defaults=True) for number, part in value.items()}

    def word_option(self, depth: int) -> str:
        return "name" if depth == 2 else ""

    def settings(self) -> Iterable[str]:
        """Return nothing: numbers of parts cannot be guessed."""
        return ()

    def schema(self, forms: Forms) -> dict[str, Any]:
        part = {"anyOf": [{"type": "string"}, {"type": "null"}, forms.of(PartChoice)]}
        return {"anyOf": [by_number(part), {"type": "null"}], "title": "Parts"}


def _no_number(key: Any) -> str:
    if quoted(key).strip("'") == "0":
        return f"numbers of parts are {FROM_ONE}, not 0"
    return f"the number of a part is a whole number from 1, not {quoted(key)}; such as {EXAMPLE}"


def _number(key: Any) -> int | None:
    """Return the number of a part, which JSON has as a word; None for any other key."""
    if isinstance(key, str) and key.isdecimal() and len(key) < MAX_QUOTED:
        key = int(key)
    return int(key) if isinstance(key, int) and not isinstance(key, bool) and key > 0 else None


@dataclass(frozen=True)
class SceneBlock(Key, Unchecked):
    """The key with the scene."""

    note: str = f"A builtin name ({', '.join(f'`{name}`' for name in sorted(BUILTINS))}), or files:"
    missing = "`scene:` is missing; name a builtin (builtin/motorcycle) or files {left:, right:}"

    def read(self, reading: Reading, block: Any) -> Any:
        source = reading.source
        try:
            reader = find_scene_reader(block)
        except BrokenMethod as error:
            return source.complain((self.name,), f"{self.name}: {error}")
        if reader is not None:
            return self._files(reading, reader, block)
        if not isinstance(block, str):
            return source.model((self.name,), SceneFiles, block)
        return block if block in BUILTINS else source.complain((self.name,), unknown_scene(block))

    def _files(self, reading: Reading, reader: Any, block: Any) -> SceneFiles | None:
        """Return the files that the block of a scene reader stands for; None after a complaint."""
        options = reading.source.model((self.name,), reader, block)
        try:
            return options and options.files()
        except TangibleError as error:
            return reading.source.complain((self.name,), f"{self.name}: {error}")

    def write(self, value: str | SceneFiles | Scene) -> Any:
        files = value.files if isinstance(value, Scene) else value
        if files is None:
            raise ConfigError(
                "scene: is made of arrays, and a file names files; save them, and make the scene of their paths"
            )
        return files if isinstance(files, str) else files.model_dump(mode="json", exclude_none=True)

    def settings(self) -> Iterable[str]:
        return (f"{self.name}=", *(f"{self.name}.{key}=" for key in scene_reader_points()))

    def models(self, value: Any) -> Mapping[tuple[str], BaseModel]:
        return {(self.name,): value} if isinstance(value, BaseModel) else {}

    def schema(self, forms: Forms) -> dict[str, Any]:
        blocks = (SceneFiles, *scene_readers(forms.distribution))
        return {"anyOf": [{"enum": sorted(BUILTINS)}, *map(forms.of, blocks)]}

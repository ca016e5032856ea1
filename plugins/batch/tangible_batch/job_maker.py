"""From a row of a manifest to a job, with a key for all that its result depends on."""

import hashlib
import re
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any, cast

from tangible_core.errors import ConfigError, TangibleError
from tangible_core.pipeline.config.editing import REMOVE, edit_text, read_values
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.pipeline.engine.keys import method_identities
from tangible_core.plugins.registry import default_registry

from .farm import LONGEST_S
from .job import Job
from .manifest import FILES, SceneRow, file_of

SCENES = "scenes"
SAFE = re.compile(r"[^\w.+-]")
MOST_IN_NAME = 60
"""Characters: four bytes each, and a digest, are still a name to any file system."""
CHUNK = 4


@dataclass(frozen=True)
class BatchOptions:
    """What is done with each scene."""

    retry: bool = False
    """Make again what failed before."""
    sheets: bool = False
    """Draw a whole report of each."""
    cache: Path | None = None
    """Folder for what scenes have in common; None for none."""
    chunk: int = CHUNK
    """Scenes that are handed out together, at most."""
    timeout_s: float = LONGEST_S
    """One that takes longer is ended, and fails."""


class JobMaker:
    """Makes jobs of rows, each with the key by which a later batch knows that it would be the same."""

    def __init__(self, text: str, path: Path, out: Path, threads: int | None, options: BatchOptions) -> None:
        """Raises: ConfigError for a text that is no YAML."""
        self._text, self._path, self._out, self._threads, self._options = text, path, out, threads, options
        self._place = str(path)
        self._other = _without_files(text, path)
        self._own = _own_files(text, path)
        self._head = hashlib.sha256(f"{text}\n{path.parent}\n{_code(text, path)} {options.sheets}".encode())

    def __call__(self, row: SceneRow) -> Job:
        """The job of a row."""
        key = self._head.copy()
        for each in row.sets:
            key.update(f"{each}\n{_state(file_of(each))}".encode(errors="surrogateescape"))
        brings = _brings_a_scene(row)
        for own in () if brings else self._own:
            key.update(_state(own).encode())
        cache = str(self._options.cache.absolute()) if self._options.cache else ""
        return Job(
            row.id, key.hexdigest()[:16], self._other if brings else self._text, self._place, row.sets,
            str(self._out / SCENES / folder_name(row.id)), self._threads, self._options.sheets, cache,
        )  # fmt: skip

    def check(self, row: SceneRow) -> None:
        """Raises: ConfigError for what is wrong in the file itself, and in every scene therefore."""
        text = self._other if _brings_a_scene(row) else self._text
        here = _complaints(text, self._path, row.sets)
        if shared := [line for place, line in _complaints(self._text, self._path, ()).items() if place in here]:
            raise ConfigError(*shared)


def folder_name(name: str) -> str:
    """Of a scene: whatever a file system might not take is left out, and then a digest keeps it apart from others.

    >>> folder_name("vase-12.front"), folder_name("a/b")
    ('vase-12.front', 'a_b-c14cddc0')
    """
    plain = SAFE.sub("_", name).strip(".")[:MOST_IN_NAME]
    digest = hashlib.sha256(name.encode(errors="surrogateescape")).hexdigest()
    return plain if plain == name else f"{plain}-{digest[:8]}"


def _brings_a_scene(row: SceneRow) -> bool:
    return any(each.startswith("scene.") for each in row.sets)


def _complaints(text: str, path: Path, sets: tuple[str, ...]) -> dict[object, str]:
    """Lines of complaint by what they are about: the number of its line in the text changes with a scene's files."""
    try:
        parse_config(text, path, default_registry(), sets)
    except ConfigError as error:
        places = [(each.location, each.text) for each in error.complaints]
        return dict(zip(places, map(str, error.args), strict=False))
    except TangibleError as error:
        return {str(error): str(error)}
    return {}


def _code(text: str, path: Path) -> str:
    """What results depend on beside the file and its pictures: the code of the methods that it names."""
    try:
        methods = method_identities(parse_config(text, path, default_registry()))
    except TangibleError:  # a row may say what is missing
        methods = ""
    return f"{metadata.version('tangible-images')} {methods}"


def _scene(text: str, path: Path) -> dict[str, Any]:
    """What the file says of its own scene's files and options; nothing of one that has a name alone."""
    scene = read_values(text, path).get("scene")
    return cast("dict[str, Any]", scene) if isinstance(scene, dict) else {}


def _own_files(text: str, path: Path) -> list[Path]:
    named = {f"scene.{name}": value for name, value in _scene(text, path).items()}
    return [path.parent / value for key, value in named.items() if key in FILES and isinstance(value, str)]


def _without_files(text: str, path: Path) -> str:
    """The pipeline file without its own scene's files, in place of which a row names others; other options stay."""
    if options := _scene(text, path):
        return edit_text(text, path, {key: REMOVE for name in options if (key := f"scene.{name}") in FILES})
    return edit_text(text, path, {"scene": REMOVE}) if "scene" in read_values(text, path) else text


def _state(file: Path | None) -> str:
    """Size and time of the last change."""
    if file is None:
        return ""
    try:
        found = file.stat()
    except (OSError, ValueError):
        return "not there"
    return f"{found.st_size} {found.st_mtime_ns}"

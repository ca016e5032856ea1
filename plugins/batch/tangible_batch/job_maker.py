"""Jobs for the rows of a manifest, each with a key of all that its result depends on."""

import hashlib
import re
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any, cast

from tangible_core.errors import ConfigError, TangibleError
from tangible_core.pipeline.config import REMOVE, edit_text, parse_config, read_values
from tangible_core.pipeline.engine import method_identities
from tangible_core.plugins.registry import default_registry

from .farm import LONGEST_S
from .job import Job
from .manifest import FILES, SceneRow, setting_file

SCENES = "scenes"
SAFE = re.compile(r"[^\w.+-]")
MAX_IN_NAME = 60
"""The most characters of a folder's name: four bytes each, with a digest, are allowed on any file system."""


@dataclass(frozen=True)
class BatchOptions:
    """Options for all scenes of a batch."""

    retry: bool = False
    """Repeat scenes that failed before."""
    sheets: bool = False
    cache: Path | None = None
    """Folder for results that scenes have in common; None for none."""
    chunk: int = 4
    """The most scenes that are sent to a worker together."""
    timeout_s: float = LONGEST_S
    """Time limit of a scene, seconds; a scene that takes longer is ended, and fails."""


class JobMaker:
    """A maker of jobs from rows; the key of a job tells a later batch whether its result would be the same."""

    def __init__(self, text: str, path: Path, out: Path, threads: int | None, options: BatchOptions) -> None:
        """Read a pipeline file. Raises: ConfigError for a text that is not YAML."""
        self._text, self._path, self._out, self._threads, self._options = text, path, out, threads, options
        self._place = str(path)
        self._other = _without_files(text, path)
        self._own = _own_files(text, path)
        self._head = hashlib.sha256(f"{text}\n{path.parent}\n{_code(text, path)} {options.sheets}".encode())

    def __call__(self, row: SceneRow) -> Job:
        """Return the job of a row."""
        key = self._head.copy()
        for setting in row.sets:
            key.update(f"{setting}\n{_state(setting_file(setting))}".encode(errors="surrogateescape"))
        has_scene = _has_scene(row)
        for own in () if has_scene else self._own:
            key.update(_state(own).encode())
        cache = str(self._options.cache.absolute()) if self._options.cache else ""
        return Job(
            row.id, key.hexdigest()[:16], self._other if has_scene else self._text, self._place, row.sets,
            str(self._out / SCENES / folder_name(row.id)), self._threads, self._options.sheets, cache,
        )  # fmt: skip

    def check(self, row: SceneRow) -> None:
        """Check the file itself. Raises: ConfigError for mistakes that all scenes share."""
        text = self._other if _has_scene(row) else self._text
        here = _complaints(text, self._path, row.sets)
        if in_common := [line for place, line in _complaints(self._text, self._path, ()).items() if place in here]:
            raise ConfigError(*in_common)


def folder_name(name: str) -> str:
    """Return the folder name of a scene: unsafe characters become `_`, and a digest then keeps the name unique.

    >>> folder_name("vase-12.front"), folder_name("a/b")
    ('vase-12.front', 'a_b-c14cddc0')
    """
    plain = SAFE.sub("_", name).strip(".")[:MAX_IN_NAME]
    digest = hashlib.sha256(name.encode(errors="surrogateescape")).hexdigest()
    return plain if plain == name else f"{plain}-{digest[:8]}"


def _has_scene(row: SceneRow) -> bool:
    return any(setting.startswith("scene.") for setting in row.sets)


def _complaints(text: str, path: Path, sets: tuple[str, ...]) -> dict[object, str]:
    """Return error messages by their places in the tree, as their line numbers change with a scene's files."""
    try:
        parse_config(text, path, default_registry(), sets)
    except ConfigError as error:
        places = [(complaint.location, complaint.text) for complaint in error.complaints]
        return dict(zip(places, map(str, error.args), strict=False))
    except TangibleError as error:
        return {str(error): str(error)}
    return {}


def _code(text: str, path: Path) -> str:
    """Return the version of the program and the code of the file's methods, on which results depend."""
    try:
        methods = method_identities(parse_config(text, path, default_registry()))
    except TangibleError:  # a row may add what is missing
        methods = ""
    return f"{metadata.version('tangible-images')} {methods}"


def _scene(text: str, path: Path) -> dict[str, Any]:
    """Return the files and options of the file's own scene; none for a scene that is a name alone."""
    scene = read_values(text, path).get("scene")
    return cast("dict[str, Any]", scene) if isinstance(scene, dict) else {}


def _own_files(text: str, path: Path) -> list[Path]:
    options = {f"scene.{name}": value for name, value in _scene(text, path).items()}
    return [path.parent / value for key, value in options.items() if key in FILES and isinstance(value, str)]


def _without_files(text: str, path: Path) -> str:
    """Return the pipeline file without the files of its scene, as a row names others; other options stay."""
    if options := _scene(text, path):
        return edit_text(text, path, {key: REMOVE for name in options if (key := f"scene.{name}") in FILES})
    return edit_text(text, path, {"scene": REMOVE}) if "scene" in read_values(text, path) else text


def _state(file: Path | None) -> str:
    """Return the size and modification time of a file, as text for the key."""
    if file is None:
        return ""
    try:
        state = file.stat()
    except (OSError, ValueError):
        return "not there"
    return f"{state.st_size} {state.st_mtime_ns}"

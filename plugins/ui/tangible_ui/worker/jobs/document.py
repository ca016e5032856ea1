"""Jobs on the document's text: read, check, change and save it; nothing is computed from it."""

from dataclasses import asdict
from hashlib import sha256
from pathlib import Path
from typing import Any, cast

from ruamel.yaml.error import YAMLError

from tangible_core.errors import Complaint, ConfigError, quoted
from tangible_core.files import as_path, write_text
from tangible_core.files.yaml import parse_value, plain, read_text
from tangible_core.materials import load_library
from tangible_core.pipeline import are_pictures
from tangible_core.pipeline.config import (
    REMOVE,
    edit_text,
    json_schema,
    parse_config,
    read_values,
    relocate_text,
    with_overrides,
)
from tangible_core.pipeline.starter import starter
from tangible_core.scene import BUILTINS, kind_of
from tangible_core.scene.formats import MAPS, PICTURES, VIDEOS
from tangible_core.session import SUFFIXES

from ..state import WorkerState
from .table import job


@job(quick=True)
def check(state: WorkerState, text: str, path: Path, sets: list[str]) -> dict[str, Any]:
    """Return what a pipeline file says, alone and with every default filled in, or its errors."""
    values, kinds, complaints = None, (None, None), list[Complaint]()
    try:
        config = state.read_config(text, path, sets)
        values, kinds = config.as_data(), (kind_of(config.scene), config.relief_kind)
    except ConfigError as error:
        complaints = list(error.complaints)
    return {
        "text": text,
        "path": str(path),
        "digest": text_digest(text),
        "said": _parse(text, path),
        "values": values,
        "scene_kind": kinds[0],
        "relief_from": kinds[1],
        "complaints": [complaint._asdict() for complaint in complaints],
    }


@job(quick=True)
def change(
    state: WorkerState,
    text: str,
    path: Path,
    sets: list[str],
    changes: dict[str, Any],
    written: dict[str, str],
    removed: list[str],
) -> dict[str, Any]:
    """Change keys: values, values in YAML, keys to remove; return `check` of the result. Raises: ConfigError."""
    values = {key: _value(key, value) for key, value in written.items()}
    deletions = dict.fromkeys(removed, REMOVE)
    return check(state, edit_text(text, path, {**deletions, **changes, **values}), path, sets)


@job(quick=True)
def overridden(state: WorkerState, text: str, path: Path, sets: list[str]) -> str:
    """Return the text with `key.key=value` changes, each as `--set` takes it. Raises: ConfigError."""
    return with_overrides(text, path, sets)


@job(page=True)
def schema(state: WorkerState) -> dict[str, Any]:
    """Return the JSON Schema of all installed methods."""
    return json_schema(state.registry, None)


@job(page=True)
def library(state: WorkerState, text: str, path: Path, sets: list[str]) -> list[dict[str, Any]]:
    """List the materials that a document can name, with figures and sources. Raises: ConfigError."""
    return [
        asdict(material) for material in load_library(state.read_config(text, path, sets).materials.library).values()
    ]


def text_digest(text: str) -> str:
    """Return the digest by which events name a text."""
    return sha256(text.encode()).hexdigest()[:16]


def _parse(text: str, path: Path) -> dict[str, Any] | None:
    try:
        return read_values(text, path)
    except ConfigError:
        return None


def _value(key: str, text: str) -> Any:
    """Parse a value. Raises: ConfigError if it is not YAML."""
    try:
        return plain(parse_value(text))
    except YAMLError as error:
        sentence = f"{quoted(text)} is not a YAML value: {getattr(error, 'problem', None) or error}"
        location = cast("tuple[str | int, ...]", tuple(key.split(".")))
        raise ConfigError(f"{key}: {sentence}", complaints=[Complaint(location, sentence)]) from error


PIPELINES = (".yaml", ".yml")
# Kind of a file by its ending; an .npz file is read to tell if it is a recording.
KINDS = {
    **dict.fromkeys(PICTURES, "picture"),
    **dict.fromkeys(VIDEOS, "video"),
    **dict.fromkeys(SUFFIXES, "recording"),
    **dict.fromkeys(MAPS, "heights"),
    **dict.fromkeys(PIPELINES, "pipeline"),
}
MOST = 2000  # maximum number of entries that are listed of a folder


@job(page=True)
def folder(state: WorkerState, path: str = "") -> dict[str, Any]:
    """List the folders, and files that can be opened, of a folder (by default the current one). Raises: ConfigError."""
    place = as_path(path).absolute()
    try:
        entries = [
            (entry.name, "folder" if entry.is_dir() else KINDS.get(entry.suffix.lower())) for entry in place.iterdir()
        ]
    except OSError as error:
        raise ConfigError(f"{place}: {error.strerror or error}; name a folder of this machine") from error
    listing = sorted((name, kind) for name, kind in entries if kind and not name.startswith("."))
    return {
        "folder": str(place),
        "parent": str(place.parent),
        "entries": [{"name": name, "kind": kind} for name, kind in listing[:MOST]],
        "more": max(0, len(listing) - MOST),
    }


@job(quick=True)
def begin(state: WorkerState, files: list[Path]) -> dict[str, Any]:
    """Return text and path of a pipeline file, or of a new one for pictures; or the path of a recording."""
    pipelines = [file for file in files if file.suffix.lower() in PIPELINES]
    if len(pipelines) > 1:
        raise ConfigError(f"{', '.join(pipeline.name for pipeline in pipelines)}: open one pipeline file at a time")
    if pipelines:
        path = pipelines[0].expanduser().absolute()
        return {"text": read_text(path), "path": path}
    if len(files) == 1 and _is_recording(files[0]):
        return {"recording": str(files[0].expanduser().absolute())}
    if not are_pictures(files):
        odd = next(file for file in files if not are_pictures([file]))
        raise ConfigError(
            f"{odd.name}: is not a picture, video, height map (.npy, .npz, .pfm), recording (.nc, .npz, .csv) or "
            "pipeline file (.yaml); if it is one, give it the right ending"
        )
    path = Path.cwd() / f"{files[0].stem}.yaml"
    return {"text": starter(files, path).text, "path": path}


def _is_recording(path: Path) -> bool:
    suffix = path.suffix.lower()
    if suffix != ".npz":
        return suffix in SUFFIXES
    import zipfile

    try:
        with zipfile.ZipFile(path) as archive:
            return "time_s.npy" in archive.namelist()
    except (OSError, zipfile.BadZipFile):
        return False


@job(page=True)
def examples(state: WorkerState) -> list[str]:
    """List the built-in scenes."""
    return list(BUILTINS)


@job(quick=True)
def save(state: WorkerState, text: str, path: Path, out: Path) -> None:
    """Write the document of `path` to another place, its paths relative to there. Raises: OutputError, ConfigError."""
    config = parse_config(text, path, state.registry)
    write_text(out, relocate_text(text, path, config, out))


@job(quick=True)
def exchange(state: WorkerState, text: str, path: Path) -> str:
    """Return the text with left and right exchanged. Raises: ConfigError if the scene is not a pair."""
    scene = read_values(text, path).get("scene")
    if not (isinstance(scene, dict) and {"left", "right"} <= scene.keys()):
        raise ConfigError("the scene is not a pair of pictures, left and right")
    return edit_text(text, path, {"scene.left": scene["right"], "scene.right": scene["left"]})

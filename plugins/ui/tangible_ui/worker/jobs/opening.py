"""Jobs that open and save: what lies in a folder, what files mean, the pipeline file on the screen."""

from pathlib import Path
from typing import Any

from tangible_core.errors import ConfigError
from tangible_core.files.source import read_text
from tangible_core.files.writing import write_text
from tangible_core.pipeline.config.config import parse_config
from tangible_core.pipeline.config.editing import edited, moved, said
from tangible_core.pipeline.starter import MAPS, PICTURES, VIDEOS, are_pictures, starter
from tangible_core.scene.scene_files import BUILTINS
from tangible_core.session.recording_files import SUFFIXES

from ..state import Bench, Job

PIPELINES = (".yaml", ".yml")
KINDS = {
    **dict.fromkeys(PICTURES, "picture"),
    **dict.fromkeys(VIDEOS, "video"),
    **dict.fromkeys(SUFFIXES, "recording"),
    **dict.fromkeys(MAPS, "heights"),
    **dict.fromkeys(PIPELINES, "pipeline"),
}
"""What a file is taken for, by the end of its name; whether an .npz is a recording is looked up."""
MOST = 2000
"""Entries that are shown of a folder."""


def folder(bench: Bench, path: Path) -> dict[str, Any]:
    """Folders, and files that can be opened, by name. Raises: ConfigError if it is no folder."""
    try:
        path = path.expanduser().absolute()
        found = [(each.name, "folder" if each.is_dir() else KINDS.get(each.suffix.lower())) for each in path.iterdir()]
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror or error}; name a folder of this machine") from error
    shown = sorted((name, kind) for name, kind in found if kind and not name.startswith("."))
    return {
        "folder": str(path),
        "parent": str(path.parent),
        "entries": [{"name": name, "kind": kind} for name, kind in shown[:MOST]],
        "more": max(0, len(shown) - MOST),
    }


def begin(bench: Bench, files: list[Path]) -> dict[str, Any]:
    """A pipeline file's text, or that of a new one for pictures, and where it stands; or the path of a recording.

    Of a pipeline file and its pictures, the file counts. Raises: ConfigError for what cannot be opened together.
    """
    pipelines = [each for each in files if each.suffix.lower() in PIPELINES]
    if len(pipelines) > 1:
        raise ConfigError(f"{', '.join(each.name for each in pipelines)}: open one pipeline file at a time")
    if pipelines:
        path = pipelines[0].expanduser().absolute()
        return {"text": read_text(path), "path": path}
    if len(files) == 1 and _is_recording(files[0]):
        return {"recording": str(files[0].expanduser().absolute())}
    if not are_pictures(files):
        odd = next(each for each in files if not are_pictures([each]))
        raise ConfigError(
            f"{odd.name}: is no picture, video, height map (.npy, .npz, .pfm), recording (.nc, .npz, .csv) or "
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
        with zipfile.ZipFile(path) as found:
            return "time_s.npy" in found.namelist()
    except (OSError, zipfile.BadZipFile):
        return False


def examples(bench: Bench) -> list[str]:
    """Scenes that are built in."""
    return list(BUILTINS)


def save(bench: Bench, text: str, path: Path, out: Path) -> None:
    """Write a document that stood at `path` to another place; its relative paths lead to the same files from there.

    Raises: OutputError if it cannot be written; ConfigError for what is wrong with it.
    """
    config = parse_config(text, path, bench.registry)
    write_text(out, moved(text, path, config, out))


def exchange(bench: Bench, text: str, path: Path) -> str:
    """The text with left and right in each other's place. Raises: ConfigError if they are no pair."""
    scene = said(text, path).get("scene")
    if not (isinstance(scene, dict) and {"left", "right"} <= scene.keys()):
        raise ConfigError("the scene is no pair of pictures, left and right")
    return edited(text, path, {"scene.left": scene["right"], "scene.right": scene["left"]})


JOBS = {
    "folder": Job(folder, quick=True),
    "begin": Job(begin, quick=True),
    "examples": Job(examples, quick=True),
    "save": Job(save, quick=True),
    "exchange": Job(exchange, quick=True),
}

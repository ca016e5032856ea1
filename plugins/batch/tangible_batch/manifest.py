"""The scenes of a batch: the rows of a manifest, or the pictures and pairs of a folder or a glob."""

import glob
import json
import logging
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from os.path import commonpath
from pathlib import Path
from typing import Any, NamedTuple

from tangible_core.errors import BatchError, quoted, shown, what_is
from tangible_core.files import as_path, read_table
from tangible_core.files.yaml import json_in_yaml
from tangible_core.pipeline import scene_key
from tangible_core.scene import SceneFiles
from tangible_core.scene.formats import MAPS, file_kind

log: logging.Logger = logging.getLogger(__name__)
MANIFESTS = (".csv", ".parquet")
# The keys whose values are files; in a manifest, they are relative to the manifest.
FILES = tuple(f"scene.{name}" for name, field in SceneFiles.model_fields.items() if "Path" in str(field.annotation))
SIDES = (("_left", "_right"), ("_l", "_r"), ("-left", "-right"), ("_L", "_R"))
"""The ends of the names of a pair's two pictures."""
ID = "id"
STILL = ("picture", "heights")  # kinds of files that are felt as they stand
# Beginning of the names of files that macOS writes beside others on foreign disks; they hold no picture.
BESIDE_FILE = "._"
MAX_NAMED = 5  # number of files left out that are named
MAX_IN_REASON = 200  # number of characters of a library's reason in a message


class SceneRow(NamedTuple):
    """A scene: its name, and its changes to the pipeline file."""

    id: str
    sets: tuple[str, ...]  # the changes, `key.key=value` each, as for `--set`


def find_rows(over: str | Sequence[str], besides: Path | None = None) -> Iterator[SceneRow]:
    """Yield the rows of a .csv or .parquet file, or one for each picture or pair of a folder or a glob, in order.

    over: a file, a folder or a glob; or the pictures that a shell has made of a glob. besides: a folder to leave out.
    In a manifest, `id` names the row (by default its number); each other column is a key of the pipeline file, of which
    empty cells change nothing. In a folder, NAME_left and NAME_right are a pair; else videos, then height maps count.
    Raises: BatchError if there is no such file, nothing in it, or two rows have the same name.
    """
    several = () if isinstance(over, str) else tuple(over)
    over = over if isinstance(over, str) else ", ".join(several)
    if len(several) > 1:
        base = Path(commonpath([Path(name).absolute().parent for name in several]))
        yield from _check_names(_pictures(_existing_pictures(several), base), "--over: ")
        return
    path = as_path(over, "--over")
    existing = next((place for place in (path, *path.parents) if place.exists()), path)
    if path.suffix.lower() in MANIFESTS:
        rows = _read_manifest(path)
    elif path.is_dir():
        rows = _pictures(_files(path.rglob("*"), besides), path)
    else:  # a folder that is there may have brackets in its name, which are no pattern
        pattern = str(Path(glob.escape(str(existing)), path.relative_to(existing)))
        names = map(Path, glob.glob(pattern, recursive=True))  # noqa: PTH207 - pathlib refuses absolute patterns
        rows = _pictures(_files(names, besides), existing if existing.is_dir() else existing.parent)
    empty = True
    for row in _check_names(rows, f"{over}: "):
        empty = False
        yield row
    if empty:
        raise BatchError(
            f"{over}: holds no picture and no row; name a folder or a glob of pictures ('archive/*.jpg', in quotes), "
            "or a .csv or .parquet file whose columns are keys of the pipeline file"
        )


def _existing_pictures(names: Iterable[str]) -> list[Path]:
    """Return the pictures and videos of these names, in order. Raises: BatchError for any other file, or none."""
    files = [as_path(name, "--over") for name in names]
    if odd := next((file for file in files if not file.is_file() or file_kind(file) is None), None):
        why = "there is no such file" if not odd.exists() else "is not a picture or a video"
        raise BatchError(f"{odd}: {why}; after --over stand pictures, or one folder, glob, .csv or .parquet file")
    return sorted(files)


def rows_from(rows: Iterable[Mapping[str, Any]], base: Path) -> Iterator[SceneRow]:
    """Yield the rows of mappings from key to value. base: the folder of relative files. Raises: BatchError."""
    return _check_names(_rows(rows, base), "")


def setting_file(setting: str) -> Path | None:
    """Return the file of a row's setting; None if its value is not a file."""
    key, _, value = setting.partition("=")
    return Path(json.loads(value)) if key in FILES else None


def _check_names(rows: Iterable[SceneRow], over: str) -> Iterator[SceneRow]:
    names: set[str] = set()
    for row in rows:
        if row.id in names:
            raise BatchError(f"{over}two rows are called {quoted(row.id)}; give each its own `id`")
        names.add(row.id)
        yield row


def _rows(rows: Iterable[Mapping[str, Any]], base: Path) -> Iterator[SceneRow]:
    for number, row in enumerate(rows):
        values = {str(key): value for key, value in row.items() if value is not None and value != ""}
        name = str(values.pop(ID, number))
        sets = (f"{key}={_text(key, value, base)}" for key, value in values.items())
        yield SceneRow(name, tuple(sets))


def _text(key: str, value: Any, base: Path) -> str:
    """Return a value as YAML; a file with its whole path."""
    if key in FILES:
        return _file_text(base / as_path(value, key))
    try:
        return value if isinstance(value, str) else json_in_yaml(value)
    except (TypeError, ValueError) as error:
        raise BatchError(f"column {quoted(key)}: holds {what_is(value)}; write texts or numbers there") from error


def _file_text(path: Path) -> str:
    return json_in_yaml(str(path.absolute()))


def _files(paths: Iterable[Path], besides: Path | None) -> list[Path]:
    """Return the files among these paths that are not in the folder `besides`, in order."""
    left_out = None if besides is None else besides.absolute()
    return sorted(
        path for path in paths if path.is_file() and not (left_out and path.absolute().is_relative_to(left_out))
    )


def _read_manifest(path: Path) -> Iterator[SceneRow]:
    try:
        lines = (row for _, row in read_table(path)[1]) if path.suffix.lower() == ".csv" else _parquet(path)
        yield from _rows(lines, path.absolute().parent)
    except OSError as error:
        raise BatchError(f"{path}: cannot be read: {error.strerror or error}; name an existing manifest") from error
    except UnicodeDecodeError as error:
        raise BatchError(f"{path}: is not a table: {error}; save it as CSV in UTF-8") from error
    except ValueError as error:
        raise BatchError(f"{path}: {error}") from error


def _parquet(path: Path) -> Iterator[dict[str, Any]]:
    from .extra import need

    parquet: Any = need("pyarrow.parquet")
    try:
        for part in parquet.ParquetFile(path).iter_batches(4096):
            yield from part.to_pylist()
    except Exception as error:  # a damaged file can provoke any
        if getattr(error, "errno", None):  # the system's own
            raise
        why = shown(str(error), MAX_IN_REASON)
        raise BatchError(f"{path}: is not a Parquet file, or is damaged: {why}; write it again") from error


def _pictures(files: list[Path], base: Path) -> Iterator[SceneRow]:
    """Yield a row for each picture or pair, or without any for each video; two of one name keep their suffixes."""
    kinds = {file: file_kind(file) for file in files if not file.name.startswith(BESIDE_FILE)}
    arrays = {file for file in kinds if file.suffix.lower() in MAPS}  # labels and other maps lie beside pictures
    scenes = list(_scene_files(sorted(file for file, kind in kinds.items() if kind in STILL and file not in arrays)))
    if not scenes:  # phones save a short film of the same name next to each photo
        scenes = [(file, "", {"scene.video": file}) for file, kind in kinds.items() if kind == "video"]
    if not scenes:
        scenes = [(file, "", {"scene.height": file}) for file, kind in kinds.items() if kind == "heights"]
    used_files = {path for _, _, parts in scenes for path in parts.values()}
    if scenes and (others := [shown(file.name) for file in files if file not in used_files]):
        more = f" and {len(others) - MAX_NAMED} more" if len(others) > MAX_NAMED else ""
        log.warning("%s: left out: %s", base, ", ".join(others[:MAX_NAMED]) + more)
    names = [_name(file, base).removesuffix(end) for file, end, _ in scenes]
    count = Counter(names)
    for name, (file, _, parts) in zip(names, scenes, strict=True):
        whole = name if count[name] == 1 else name + file.suffix
        yield SceneRow(whole, tuple(f"{key}={_file_text(path)}" for key, path in parts.items()))


def _scene_files(pictures: list[Path]) -> Iterator[tuple[Path, str, dict[str, Path]]]:
    """Yield the first picture of each scene, the end of its name as a left view, and the scene's files by key."""
    rights = {right for file in pictures if (right := _right_view(file)) in pictures}
    for left in (file for file in pictures if file not in rights):
        right = _right_view(left)
        if right in rights:
            end = next(end for end, _ in SIDES if left.stem.endswith(end))
            yield left, end, {"scene.left": left, "scene.right": right}
        else:
            yield left, "", {f"scene.{scene_key(left)}": left}


def _name(file: Path, base: Path) -> str:
    """Return the name of a file relative to a folder, without its suffix."""
    file = file.absolute() if base.is_absolute() else file
    return str((file.relative_to(base) if file.is_relative_to(base) else Path(file.name)).with_suffix(""))


def _right_view(left: Path) -> Path | None:
    """Return the path of the right view if this is a left one."""
    ends = next((ends for ends in SIDES if left.stem.endswith(ends[0])), None)
    return left.with_name(left.stem.removesuffix(ends[0]) + ends[1] + left.suffix) if ends else None

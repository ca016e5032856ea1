"""Saving of parts: label pictures as a page uploads them, `parts.png`, and the document's entries."""

import hashlib
import itertools
import logging
import os
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np
from jaxtyping import Int32, Shaped, UInt16

from tangible_authoring.label_picture import label_picture
from tangible_core.data import PartMap, label_of_number, shown_number, with_units
from tangible_core.errors import ConfigError, quoted
from tangible_core.files import MAX_PIXELS, atomic_write, sole_writer, write_text
from tangible_core.files.yaml import read_text, with_parts
from tangible_core.pipeline.config import REMOVE, PipelineConfig, edit_text, read_values
from tangible_core.scene import BUILTINS, Scene, SceneFiles, builtin_files
from tangible_core.scene.formats import MAX_LABELS

from .opening import Opened

NAME = "parts.png"
GZIP = 31  # window bits with which zlib takes gzip files alone
PNG = b"\x89PNG\r\n\x1a\n"
AFTER_SIZE = len(PNG) + 4 + 4 + 13 + 4  # offset of a PNG's second chunk; the first one holds its size
_TEXT, _PIXELS = b"tEXt", b"IDAT"


def unpack(path: Path, shape: tuple[int, int]) -> UInt16[np.ndarray, "h w"]:
    """Unpack labels of a page: uint16, little-endian, row by row, as gzip. Raises: ConfigError for anything else."""
    size = 2 * shape[0] * shape[1]
    wrong = f"the labels that were sent are not a gzip of {shape[1]} x {shape[0]} numbers of two bytes; send them again"
    if not 0 < size <= 2 * MAX_PIXELS:
        raise ConfigError(wrong)
    try:
        unpacking = zlib.decompressobj(GZIP)
        with path.open("rb") as file:
            content = unpacking.decompress(file.read(size + size // 1000 + 1024), size + 1)
    except (zlib.error, OSError) as error:
        raise ConfigError(wrong) from error
    if len(content) != size or not unpacking.eof:
        raise ConfigError(wrong)
    return np.frombuffer(content, "<u2").reshape(shape).astype(np.uint16, copy=False)


def as_png(labels: Int32[np.ndarray, "h w"], document: str) -> bytes:
    """Return a PNG of labels, marked with the name of its pipeline file. Raises: ConfigError for too many labels."""
    count = int(labels.max(initial=0)) + 1
    if count > MAX_LABELS:
        raise ConfigError(f"these are {count} parts, and at most {MAX_LABELS} are allowed; join some of them")
    picture = label_picture(np.ascontiguousarray(labels))
    return picture[:AFTER_SIZE] + _chunk(_TEXT, _mark(picture, document)) + picture[AFTER_SIZE:]


def is_ours(path: Path, document: str) -> bool:
    """Return True if the file is as `as_png` made it for this pipeline file: nobody has painted in it since."""
    try:
        picture = path.read_bytes()
    except OSError:
        return False
    return (_TEXT, _mark(picture, document)) in _chunks(picture)


def _mark(picture: bytes, document: str) -> bytes:
    """Return the mark of a PNG's pixels and of the file that it belongs to."""
    digest = hashlib.sha256(document.encode(errors="surrogateescape"))
    for kind, data in _chunks(picture):
        if kind == _PIXELS:
            digest.update(data)
    return b"Tangible Images\0parts " + digest.hexdigest().encode()


def _chunks(picture: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Yield kind and data of each chunk of a PNG; nothing for other data."""
    at = len(PNG) if picture.startswith(PNG) else len(picture)
    while at + 8 <= len(picture):
        size, kind = struct.unpack_from(">I4s", picture, at)
        yield kind, picture[at + 8 : at + 8 + size]
        at += 12 + size


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


log: logging.Logger = logging.getLogger(__name__)
# Maximum number of keys that are changed one by one, each in its place; beyond it the whole block is rewritten.
MAX_EDITED = 200
SAID = ("name", "height_m", "material")


def warn_of_numbers(config: PipelineConfig, before: Opened, parts: PartMap) -> None:
    """Warn of materials that are chosen by the number of a segment or part that has moved."""
    rules, by = config.materials.rules, config.materials.by
    segments = {rule.segment for rule in rules if rule.segment is not None} | set(by if isinstance(by, dict) else ())
    part_numbers = {rule.part for rule in rules if isinstance(rule.part, int)}
    labels = np.array(before.parts.segments)[before.parts.labels]
    there = before.scene.segments is not None  # otherwise a method computes the segments

    def is_elsewhere(number: int, before: Int32[np.ndarray, "h w"]) -> bool:
        now = parts.labels[before == label_of_number(number)]  # a slightly moved border does not make it another part
        return not now.size or shown_number(int(np.bincount(now).argmax())) != number

    elsewhere = {segment for segment in segments if not there or is_elsewhere(segment, labels)}
    elsewhere |= {part for part in part_numbers if is_elsewhere(part, before.parts.labels)}
    if elsewhere:
        log.warning(
            "materials: are chosen by the numbers %s, which is now another part or none; name the parts, and choose by "
            "name ({part: NAME, material: ...})",
            ", ".join(map(str, sorted(elsewhere))),
        )


def number_parts(
    parts: Sequence[Mapping[str, Any]], labels: Sequence[int], numbers: Int32[np.ndarray, "h w"]
) -> tuple[dict[int, dict[str, Any]], dict[str, list[int]]]:
    """Return the entries by number of the part, and the numbers that each label became. Raises: ConfigError."""
    if not all(type(part.get("label")) is int for part in parts):
        raise ConfigError("parts: each entry needs the number of its label")
    by_label = {part["label"]: part for part in parts}
    if len(by_label) < len(parts):
        raise ConfigError("a label has two entries; give each label one")
    of_label: dict[int, list[int]] = {}
    for number, label in enumerate(labels):
        of_label.setdefault(label, []).append(number)
    if missing := sorted(by_label.keys() - of_label.keys()):
        raise ConfigError(f"label {missing[0]}: has a name or a height, and no pixel; leave it out, or paint it")
    sizes = np.bincount(numbers.ravel(), minlength=len(labels))
    names = {str(part.get("name") or "").strip().casefold() for part in parts}
    choices: dict[int, dict[str, Any]] = {}
    for label, entry in by_label.items():
        largest_first = sorted(of_label[label], key=lambda number: (-sizes[number], number))
        for place, number in enumerate(largest_first):
            choices[number] = {key: entry[key] for key in SAID if entry.get(key) not in (None, "")}
            if place and (name := choices[number].get("name")):
                choices[number]["name"] = _another(name, names)
    return choices, {str(label): own_numbers for label, own_numbers in of_label.items()}


def document_with_parts(
    text: str,
    path: Path,
    place: Path,
    choices: Mapping[int, Mapping[str, Any]],
    heights: Mapping[str, Any] | None,
    words: Mapping[str, str | None],
) -> str:
    """Return the document's text with these parts; order and other comments stay. Raises: ConfigError."""
    now = read_values(text, path)
    changes: dict[Any, Any] = dict(_scene(now, path, place))
    changes |= {("heights", key): value for key, value in (heights or {}).items()}
    changes |= {(key,): value or REMOVE for key, value in words.items() if value is not None}
    entries = ((number, entry) for number, entry in sorted(choices.items()) if entry)
    short = {
        shown_number(number): entry["name"] if set(entry) == {"name"} else dict(entry) for number, entry in entries
    }
    before = now.get("parts")
    before = before if isinstance(before, dict) else {}
    if not before or len(short.keys() | before.keys()) > MAX_EDITED:
        return _with_block(edit_text(text, path, changes), path, short)
    changes |= {("parts", key): REMOVE for key in before if key not in map(str, short)}
    changes |= {("parts", str(key)): value for key, value in short.items() if before.get(str(key)) != value}
    return edit_text(text, path, changes)


def _with_block(text: str, path: Path, parts: Mapping[int, Any]) -> str:
    """Return the text with a line for each part; on one line, in a document that is written so."""
    if not parts:
        return edit_text(text, path, {("parts",): REMOVE})
    try:
        return with_parts(text, path, with_units(parts))
    except ConfigError:
        bare = edit_text(text, path, {("parts",): REMOVE})
        return edit_text(bare, path, {("parts", str(number)): value for number, value in parts.items()})


def _another(name: str, names: set[str]) -> str:
    """Return the name with a number, so that no other part has it."""
    others = (f"{name.strip()} {number}" for number in itertools.count(2))
    new_name = next(other for other in others if other.casefold() not in names)
    names.add(new_name.casefold())
    return new_name


def compact(labels: UInt16[np.ndarray, "h w"]) -> tuple[np.ndarray, Int32[np.ndarray, "h w"]]:
    """Return the distinct labels, and the index of each pixel's label among them."""
    values = np.flatnonzero(np.bincount(labels.ravel(), minlength=1))
    places = np.zeros(int(values[-1]) + 1, np.int32)
    places[values] = np.arange(values.size, dtype=np.int32)
    return values, places[labels]


def _scene(now: Mapping[str, Any], path: Path, place: Path) -> dict[tuple[str, ...], Any]:
    """Return the changes of the scene's keys: a built-in scene becomes its files."""
    segments = place.name if place.parent == path.parent else str(place)
    scene = now.get("scene")
    if isinstance(scene, dict):
        return {("scene", "segments"): segments}
    if not isinstance(scene, str) or scene not in BUILTINS:
        raise ConfigError(f"scene: {quoted(scene)}: parts can be drawn in files and in built-in scenes alone")
    files = builtin_files(scene).model_dump(mode="json", exclude_defaults=True)
    return {("scene",): {**files, "segments": segments}}


def undo_framing(labels: Int32[np.ndarray, "h w"], config: PipelineConfig) -> Shaped[np.ndarray, "H W"]:
    """Return labels in the frame of the scene's files: rotated back, the cropped margin filled by nearest labels."""
    files = config.scene
    if not isinstance(files, SceneFiles) or (files.crop is None and not files.rotate):
        return labels
    labels = np.rot90(labels, files.rotate // 90)
    if files.crop is None:
        return labels
    alone = {"crop": None, "rotate": 0, "segments": None, "disparity": None, "depth": None, "truth": None}
    rows, columns = Scene.read(files.model_copy(update=alone), config.folder).shape
    x, y, width, height = files.crop
    return np.pad(labels, ((y, rows - y - height), (x, columns - x - width)), mode="edge")


def is_in_file(path: Path, opened: str) -> bool:
    """Return True if the document's file exists with the text that was last read from it or written to it."""
    try:
        return path.is_file() and read_text(path) == opened
    except ConfigError:
        return False


def folder_of_photograph(config: PipelineConfig, uploads: Path) -> Path | None:
    """Return the folder of a document's picture; None for a built-in scene, an upload, or one to read alone."""
    files = config.scene
    picture = (files.photo or files.left) if isinstance(files, SceneFiles) else None
    if picture is None:
        return None
    folder = (config.folder / picture).absolute().parent
    is_upload = folder.resolve().is_relative_to(uploads.resolve())
    return None if is_upload or not os.access(folder, os.W_OK) else folder


def new_file(config: PipelineConfig, path: Path, drawn: Path, beside: bool) -> Path:
    """Return the path of a new pipeline file: next to the photograph, else in a new folder below `drawn`."""
    names = itertools.chain([path.stem], (f"{path.stem}-{number}" for number in itertools.count(2)))
    folder = folder_of_photograph(config, drawn.parent) if beside else None
    if folder is None:
        return next(drawn / name / f"{name}.yaml" for name in names if not os.path.lexists(drawn / name))
    return next(folder / f"{name}.yaml" for name in names if not os.path.lexists(folder / f"{name}.yaml"))


def place_next_to(path: Path) -> Path:
    """Return a path for labels next to a pipeline file: a new one, or one that was written for that very file."""
    names = itertools.chain([NAME], (f"{Path(NAME).stem}-{number}.png" for number in itertools.count(2)))
    places = (path.parent / name for name in names)
    return next(place for place in places if not os.path.lexists(place) or is_ours(place, path.name))


def keep_replaced(place: Path, picture: bytes, store: Path, texts: Sequence[str], path: Path) -> dict[str, str]:
    """Keep the picture that is about to be replaced, for texts that name it: undo finds it by content in the store."""
    before = place.read_bytes() if place.is_file() else picture
    if before == picture:
        return {}
    stored = store / hashlib.sha256(before).hexdigest()[:16] / NAME
    new_texts: dict[str, str] = {}
    for text in dict.fromkeys(texts):
        scene = read_values(text, path).get("scene") if place.name in text else None
        if isinstance(scene, dict) and path.parent / str(cast("dict[str, Any]", scene).get("segments")) == place:
            new_texts[text] = edit_text(text, path, {("scene", "segments"): str(stored)})
    if new_texts:
        with atomic_write(stored) as file:
            file.write(before)
    return new_texts


def write(place: Path, picture: bytes, document: Path, text: str) -> None:
    """Write the labels and the document, both or neither. Raises: OutputError."""
    with sole_writer(place), atomic_write(place) as file:
        file.write(picture)
        file.flush()  # a full disk shows before the document is touched
        write_text(document, text)

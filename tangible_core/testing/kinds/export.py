"""Checks of an exporter, and tests that a file is whole, by the structure of its format."""

import json
import struct
import time
import zipfile
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import chdir, contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from math import isfinite
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import patch
from xml.etree import ElementTree

import numpy as np

from ...data import Record, Work, digest_of
from ...data.products import EXPORTABLE
from ...errors import BrokenMethod, TangibleError
from ...plugins.interfaces import Exporter
from ..checks import Check, CheckFailure, checks_in, coarse_variants, demand, exact_variants
from .exporter_inputs import plain_work, works

STEM = "still-life"
ASPECTS = (1e-3, 0.7, 1.0, 4 / 3, 1e3)  # widths over lengths of pictures that exporters must accept
WIDTHS_M = (1e-6, 10.0)
A_DAY_S = 86_400.0


def needs_are_products(method: Exporter) -> None:
    """Check that `needs` names each product once, and only products that exporters can get."""
    odd = [need for need in method.needs if need not in EXPORTABLE]
    demand(not odd, f"needs names {', '.join(odd)}; an exporter may need {', '.join(EXPORTABLE)}")
    demand(len(set(method.needs)) == len(method.needs), "needs names a product twice")


def width_is_a_length(method: Exporter) -> None:
    """Check that `picture_width_m` is None or a length of 1e-6 to 10 m, for a picture of any shape."""
    low, high = WIDTHS_M
    for aspect in ASPECTS:
        width_m = method.picture_width_m(aspect)
        fine = width_m is None or (isfinite(width_m) and low <= width_m <= high)
        demand(fine, f"picture_width_m({aspect:g}) is {width_m!r}; a width is from {low:g} to {high:g} m, or None")


def plain_scene_is_written(method: Exporter) -> None:
    """Check that a plain scene of three parts becomes whole files, named by the stem, whose paths `write` returns."""
    with _write(method, plain_work(method)) as files:
        demand(files, "write returns no path; it must return those of all files that it wrote")


def nothing_else_is_left(method: Exporter) -> None:
    """Check that `write` returns the path of every file that it wrote, and writes none outside of its folder."""
    with TemporaryDirectory() as place:
        folder = Path(place) / "files"
        folder.mkdir()
        current = folder.with_name("current")
        current.mkdir()
        with chdir(current):
            paths = method.write(plain_work(method), folder / STEM)
        strays = {path for path in Path(place).rglob("*") if path not in (folder, current)} - set(paths)
        names = ", ".join(sorted(path.name for path in strays))
        demand(not strays, f"it leaves {names}, which write does not return; remove files that are not exported")


def same_work_same_files(method: Exporter) -> None:
    """Check that two runs, a day apart, write the same names and the same bytes: files are compared and archived."""
    first = _write_to_memory(method, plain_work(method))
    with patch("time.time", _tomorrow):
        second = _write_to_memory(type(method)(**dict(method)), plain_work(method))
    demand(first.keys() == second.keys(), f"two runs write {', '.join(first)}, and then {', '.join(second)}")
    unequal = [name for name in first if first[name] != second[name]]
    demand(not unequal, f"{', '.join(unequal)} differs from run to run; leave out the time, and seed what is random")
    with_date = [name for name, data in first.items() if any(day in data for day in _today())]
    demand(not with_date, f"{', '.join(with_date)} contains the date of its writing; leave the date out")


def work_is_not_written_to(method: Exporter) -> None:
    """Check that the input products and picture are not changed: other exporters read them too."""
    work = plain_work(method)
    picture = np.array(work.picture)
    work = replace(work, picture=picture)
    before = _digest(work)
    with _write(method, work):
        demand(_digest(work) == before, "write changes its input; work on a copy")


def every_work_is_answered(method: Exporter) -> None:
    """Check that any work, flat, tiny, without parts, in any script, gives whole files or a TangibleError."""
    for name, work in works(method):
        _write_or_refuse(method, work, name)


def every_picture_type_is_taken(method: Exporter) -> None:
    """Check that 8 and 16 bits, floats, RGBA, grey and any memory layout give whole files, or a TangibleError."""
    plain = plain_work(method)
    assert plain.picture is not None
    with _write(method, plain) as files:
        count = len(files)
    for name, picture in exact_variants(plain.picture):
        with _write(method, replace(plain, picture=picture)) as files:
            demand(len(files) == count, f"a picture of {name} gives {len(files)} files, of 8 bits {count}")
    for name, picture in coarse_variants(plain.picture):
        _write_or_refuse(method, replace(plain, picture=picture), f"a picture of {name}")


def _write_or_refuse(method: Exporter, work: Work, name: str) -> None:
    try:
        with _write(method, work):
            pass
    except (CheckFailure, BrokenMethod) as error:
        raise CheckFailure(f"{name}: {error}") from error
    except TangibleError:
        return
    except Exception as error:
        raise CheckFailure(f"{name}: raises {type(error).__name__}: {error}; raise a TangibleError") from error


@contextmanager
def _write(method: Exporter, work: Work) -> Generator[Sequence[Path]]:
    """Write the files of a work to a temporary folder, and demand that each is whole."""
    with TemporaryDirectory() as place:
        stem = Path(place) / STEM
        files = method.write(work, stem)
        for file in files:
            demand(isinstance(file, Path), f"write returns {file!r}; it must return a tuple of Path")  # pyright: ignore[reportUnnecessaryIsInstance]
            fits = file.parent == stem.parent and file.name.startswith(stem.name)
            demand(fits, f"write returns {file}, which is not the stem with an ending")
            demand(file.is_file() and not file.is_symlink(), f"write returns {file.name}, but there is no such file")
            demand_whole(file)
        demand(len(set(files)) == len(files), "write returns a path twice")
        yield files


def _write_to_memory(method: Exporter, work: Work) -> Mapping[str, bytes]:
    with _write(method, work) as files:
        return {path.name: path.read_bytes() for path in files}


def _digest(work: Work) -> str:
    parts: list[Record | np.ndarray | None] = [*work.products.values(), work.picture]
    return " ".join(digest_of(part) for part in parts if part is not None)


def _tomorrow(now: float = time.time()) -> float:
    return now + A_DAY_S


def _today() -> list[bytes]:
    days = (datetime.now(UTC), datetime.now().astimezone())
    return [day.strftime(form).encode() for day in days for form in ("%Y-%m-%d", "%Y%m%d", "D:%Y%m%d", "%a %b %d %Y")]


CHECKS: tuple[Check, ...] = checks_in(__name__)  # what stands below are no checks


def demand_whole(path: Path) -> None:
    """Demand that a file is neither empty nor truncated, and of the format that its ending names."""
    demand(path.stat().st_size > 0, f"{path.name} is empty")
    if (read := READERS.get(path.suffix.lower())) is not None:
        read(path)


def _json(path: Path) -> None:
    def refuse(word: str) -> None:
        raise ValueError(f"{path.name} contains {word}, which is not JSON")

    json.loads(path.read_text(encoding="utf-8"), parse_constant=refuse)


def _picture(path: Path) -> None:
    from PIL import Image

    with Image.open(path) as image:
        image.load()


def _zip(path: Path) -> None:
    with zipfile.ZipFile(path) as archive:
        demand(archive.testzip() is None, f"{path.name}: {archive.testzip()} within it is damaged")


def _stl(path: Path) -> None:
    """Compare the size of a binary STL with the number of triangles that it states."""
    data = path.read_bytes()
    (count,) = struct.unpack_from("<I", data, 80)
    demand(len(data) == 84 + 50 * count, f"{path.name} states {count} triangles, but has {len(data)} bytes")


def _glb(path: Path) -> None:
    data = path.read_bytes()
    magic, _, length = struct.unpack_from("<4sII", data)
    demand(magic == b"glTF", f"{path.name} does not begin as a GLB does")
    demand(length == len(data), f"{path.name} states {length} bytes, but has {len(data)}")


def _pdf(path: Path) -> None:
    data = path.read_bytes()
    demand(data.startswith(b"%PDF-"), f"{path.name} does not begin as a PDF does")
    demand(data.rstrip().endswith(b"%%EOF"), f"{path.name} does not end as a PDF does")


def _text(path: Path) -> None:
    path.read_text(encoding="utf-8")


READERS: dict[str, Callable[[Path], object]] = {
    ".json": _json, ".svg": ElementTree.parse, ".xml": ElementTree.parse, ".png": _picture, ".tif": _picture,
    ".tiff": _picture, ".jpg": _picture, ".zip": _zip, ".3mf": _zip, ".stl": _stl, ".glb": _glb, ".pdf": _pdf,
    ".txt": _text, ".html": _text, ".csv": _text,
}  # fmt: skip

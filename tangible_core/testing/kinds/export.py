"""Checks of an exporter."""

import time
from collections.abc import Generator, Mapping, Sequence
from contextlib import chdir, contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from math import isfinite
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import patch

import numpy as np

from ...data import Record, Work, digest_of
from ...data.products import EXPORTABLE
from ...errors import BrokenMethod, TangibleError
from ...plugins.interfaces import Exporter
from ..checks import Check, CheckFailure, demand
from ..variants import coarse_variants, exact_variants
from .exporter_inputs import plain_work, works
from .whole_files import demand_whole

STEM = "still-life"
ASPECTS = (1e-3, 0.7, 1.0, 4 / 3, 1e3)
"""Width through length, of pictures that there may be."""
WIDTHS_M = (1e-6, 10.0)
A_DAY_S = 86_400.0


def needs_are_products(method: Exporter) -> None:
    """`needs` names products that a pipeline makes and that are records; each once."""
    odd = [each for each in method.needs if each not in EXPORTABLE]
    demand(not odd, f"needs names {', '.join(odd)}; an exporter may need {', '.join(EXPORTABLE)}")
    demand(len(set(method.needs)) == len(method.needs), "needs names a product twice")


def width_is_a_length(method: Exporter) -> None:
    """For a picture of any shape, `width_m` is None or a length of 1e-6 to 10 m."""
    low, high = WIDTHS_M
    for aspect in ASPECTS:
        found = method.picture_width_m(aspect)
        fine = found is None or (isfinite(found) and low <= found <= high)
        demand(fine, f"width_m({aspect:g}) is {found!r}; a width is from {low:g} to {high:g} m, or None")


def plain_scene_is_written(method: Exporter) -> None:
    """A plain scene of three parts becomes whole files, named by the stem with endings, and their paths are given.

    It reads no product that is not in its `needs`.
    """
    with _written(method, plain_work(method)) as files:
        demand(files, "write gives no path; it gives those of all files that it wrote")


def nothing_else_is_left(method: Exporter) -> None:
    """Every file that was written is among the paths that `write` gives, and none lies outside of its folder."""
    with TemporaryDirectory() as place:
        folder = Path(place) / "files"
        folder.mkdir()
        beside = folder.with_name("beside")
        beside.mkdir()
        with _within(beside):
            given = method.write(plain_work(method), folder / STEM)
        left = {path for path in Path(place).rglob("*") if path not in (folder, beside)} - set(given)
        names = ", ".join(sorted(path.name for path in left))
        demand(not left, f"it leaves {names}, which it does not name; remove what is not to be handed on")


def same_work_same_files(method: Exporter) -> None:
    """Written twice, a day apart, the files have the same names and the same bytes: they are compared and kept."""
    first = _bytes_of(method, plain_work(method))
    with patch("time.time", _tomorrow):
        second = _bytes_of(type(method)(**dict(method)), plain_work(method))
    demand(first.keys() == second.keys(), f"two runs give {', '.join(first)}, and then {', '.join(second)}")
    changed = [name for name in first if first[name] != second[name]]
    demand(not changed, f"{', '.join(changed)} differs from run to run; leave out the time, and seed what is random")
    dated = [name for name, data in first.items() if any(day in data for day in _today())]
    demand(not dated, f"{', '.join(dated)} says on which day it was written; leave the date out")


def work_is_not_written_to(method: Exporter) -> None:
    """The products and the picture that come in are the same bytes afterwards: other exporters read them too."""
    work = plain_work(method)
    picture = np.array(work.picture)
    work = replace(work, picture=picture)
    before = _digest(work)
    with _written(method, work):
        demand(_digest(work) == before, "write changes what it was given; work on a copy")


def every_work_is_answered(method: Exporter) -> None:
    """Whatever there is, flat, tiny, without parts, in any script: whole files, or a TangibleError that says why not.

    A BrokenMethod is no such answer.
    """
    for what, work in works(method):
        _answered(method, work, what)


def every_picture_type_is_taken(method: Exporter) -> None:
    """8 and 16 bits, floats, RGBA, grey, and any memory layout: whole files, or a TangibleError that says why not."""
    plain = plain_work(method)
    assert plain.picture is not None
    with _written(method, plain) as files:
        expected = len(files)
    for name, picture in exact_variants(plain.picture):
        with _written(method, replace(plain, picture=picture)) as files:
            demand(len(files) == expected, f"a picture of {name} gives {len(files)} files, of 8 bits {expected}")
    for name, picture in coarse_variants(plain.picture):
        _answered(method, replace(plain, picture=picture), f"a picture of {name}")


def _answered(method: Exporter, work: Work, what: str) -> None:
    try:
        with _written(method, work):
            pass
    except (CheckFailure, BrokenMethod) as error:
        raise CheckFailure(f"{what}: {error}") from error
    except TangibleError:
        return
    except Exception as error:
        raise CheckFailure(f"{what}: raises {type(error).__name__}: {error}; raise a TangibleError") from error


@contextmanager
def _written(method: Exporter, work: Work) -> Generator[Sequence[Path]]:
    """The files of a work, each of which is whole, while they are there."""
    with TemporaryDirectory() as place:
        stem = Path(place) / STEM
        files = method.write(work, stem)
        for each in files:
            demand(isinstance(each, Path), f"write gives {each!r}; it gives a tuple of Path")  # pyright: ignore[reportUnnecessaryIsInstance]
            fits = each.parent == stem.parent and each.name.startswith(stem.name)
            demand(fits, f"write gives {each}, which is not the stem that it was given with an ending")
            demand(each.is_file() and not each.is_symlink(), f"write gives {each.name}, and there is no such file")
            demand_whole(each)
        demand(len(set(files)) == len(files), "write gives a path twice")
        yield files


def _bytes_of(method: Exporter, work: Work) -> Mapping[str, bytes]:
    with _written(method, work) as files:
        return {path.name: path.read_bytes() for path in files}


def _digest(work: Work) -> str:
    parts: list[Record | np.ndarray | None] = [*work.products.values(), work.picture]
    return " ".join(digest_of(each) for each in parts if each is not None)


def _tomorrow(now: float = time.time()) -> float:
    return now + A_DAY_S


def _today() -> list[bytes]:
    """As files write it."""
    days = (datetime.now(UTC), datetime.now().astimezone())
    return [day.strftime(form).encode() for day in days for form in ("%Y-%m-%d", "%Y%m%d", "D:%Y%m%d", "%a %b %d %Y")]


@contextmanager
def _within(folder: Path) -> Generator[None]:
    """With this folder as the current one."""
    with chdir(folder):
        yield


CHECKS: tuple[Check, ...] = (
    needs_are_products,
    width_is_a_length,
    plain_scene_is_written,
    nothing_else_is_left,
    same_work_same_files,
    work_is_not_written_to,
    every_work_is_answered,
    every_picture_type_is_taken,
)

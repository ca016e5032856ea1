"""`parts`: divide a picture into parts to name, correct and paint over; list the parts of a pipeline file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tangible_core.cli import Json, NoCache, Sets, completing, is_quiet, show
from tangible_core.errors import ConfigError

if TYPE_CHECKING:
    from tangible_report.numbered_parts import Before

    from ..listed_parts import ListedPart


def parts(
    pictures: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE...",
            help="A picture, left and right, or a pipeline file whose parts are listed and drawn.",
            show_default=False,
            autocompletion=completing.scenes,
        ),
    ],
    out: Annotated[Path | None, typer.Option("--out", help="Folder for the files [default: the current one].")] = None,
    method: Annotated[str, typer.Option("--method", help="Texture method [default: that of `tangible new`].")] = "",
    count: Annotated[int, typer.Option("--count", help="The most parts.")] = 12,
    smallest: Annotated[
        float, typer.Option("--smallest", help="Width of the smallest part, mm, on a surface of 80 mm.")
    ] = 5.0,
    sets: Sets = None,
    renumber: Annotated[
        bool, typer.Option("--renumber", help="Correct the numbers of parts in the pipeline file.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Overwrite existing files.")] = False,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Divide a picture into parts, which get names and heights.

    Writes a label picture to paint on, a picture with the parts' numbers, and a pipeline file that runs as it stands.
    For a pipeline file, it lists the parts and draws their numbers and names.
    """
    from tangible_core.pipeline import are_pictures

    if are_pictures(pictures):
        _divide(pictures, out or Path(), method, count, smallest, sets or [], force, as_json, no_cache)
    else:
        _list(pictures, out, sets or [], renumber, force, as_json, no_cache)


def _divide(
    pictures: Sequence[Path],
    folder: Path,
    method: str,
    count: int,
    smallest: float,
    sets: Sequence[str],
    force: bool,
    as_json: bool,
    no_cache: bool,
) -> None:
    from tangible_core.pipeline.engine import Cache

    from ..first_parts import check_free, files_beside, first_parts

    file = folder / f"{pictures[0].stem}.yaml"
    check_free(files_beside(file), pictures, force)  # before the work, which takes time
    first = first_parts(
        pictures,
        file,
        method=method,
        overrides=sets,
        most=count,
        smallest_mm=smallest,
        cache=None if no_cache else Cache(),
    )
    files = first.write(force)
    if as_json:
        summary = {"title": first.title, "method": first.method, "parts": [part._asdict() for part in first.listed]}
        show.print_json({**summary, "files": [str(path) for path in files]})
        return
    if is_quiet():
        return
    show.sentence(_summary(" and ".join(picture.name for picture in pictures), len(first.listed)))
    _print(first.listed)
    for path in files:
        show.plain(f"written: {path}")
    show.plain(NEXT.format(labels=files[0], numbered=files[1], file=files[2]))


NEXT = """
Next:
  look at {numbered}, and write names and heights into {file}
  tangible ui {file}        shows the parts on a page in the browser, to be named there and felt with the mouse
  tangible run {file}       makes what can be felt, and draws it
  tangible parts {file}     lists and numbers the parts again, when you have painted over {labels}"""


def _list(
    files: Sequence[Path],
    out: Path | None,
    sets: Sequence[str],
    renumber: bool,
    force: bool,
    as_json: bool,
    no_cache: bool,
) -> None:
    from ..first_parts import NUMBERED
    from ..renumbering import draw_numbers

    if len(files) > 1:
        raise ConfigError(f"{', '.join(map(str, files))}: name one picture, left and right, or one pipeline file")
    (file,) = files
    path = (file.parent if out is None else out) / NUMBERED
    result = draw_numbers(file, path, sets, renumber=renumber, force=force, with_cache=not no_cache)
    parts = result.parts.parts
    if as_json:
        rows = [{**part._asdict(), "was": was and was.number} for part, was in _with_earlier(parts, result.before)]
        show.print_json({"title": result.title, "parts": rows, "files": [str(path) for path in result.files]})
    elif not is_quiet():
        show.sentence(_summary(result.title, len(parts)))
        _print(parts, result.before if result.moves else None)
        for path in result.files:
            show.plain(f"written: {path}")
    if result.wrong is not None:
        show.flush()
        raise result.wrong


def _with_earlier(
    parts: Sequence[ListedPart], before: Sequence[Before] | None
) -> Iterable[tuple[ListedPart, Before | None]]:
    return zip(parts, before or [None] * len(parts), strict=True)


def _summary(name: str, parts: int) -> str:
    return f"{name} is one part." if parts == 1 else f"{name} is divided into {parts} parts."


def _print(parts: Sequence[ListedPart], before: Sequence[Before] | None = None) -> None:
    from tangible_core.data import shown_number

    rows = [
        (
            str(shown_number(part.number)),
            *([] if was is None else ["new" if was.number is None else str(shown_number(was.number))]),
            show.escape(part.name),
            part.place,
            f"{100 * part.share:.1f}",
            "" if part.height_m is None else f"{1000 * part.height_m:.1f}",
            show.escape(part.material),
        )
        for part, was in _with_earlier(parts, before)
    ]
    numbers = ("part", "was") if before else ("part",)
    show.table((*numbers, "name", "place", "% of the picture", "height mm", "material"), rows)
    show.plain("")

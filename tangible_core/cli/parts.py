"""`parts`: a picture divided into parts, to be named, corrected and painted over; those of a pipeline file, listed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from . import completing
from .loudness import is_quiet
from .options import Json, NoCache, Sets

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..pipeline.listed_parts import ListedPart


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
    count: Annotated[int, typer.Option("--count", help="As many parts, at most.")] = 12,
    smallest: Annotated[float, typer.Option("--smallest", help="Width of the smallest part, mm, of 80 mm.")] = 5.0,
    sets: Sets = None,
    force: Annotated[bool, typer.Option("--force", help="Write over files that are there.")] = False,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Divide a picture into parts, to name and to give heights.

    Writes a label picture to paint on, a picture with the parts' numbers, and a pipeline file that runs as it stands.
    Of a pipeline file, it lists the parts and draws their numbers and names.
    """
    from ..pipeline.starter import are_pictures

    if are_pictures(pictures):
        _divide(pictures, out or Path(), method, count, smallest, sets or [], force, as_json, no_cache)
    else:
        _list(pictures, out, sets or [], force, as_json, no_cache)


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
    from ..pipeline.cache import Cache
    from ..pipeline.first_parts import check_free, files_beside, first_parts
    from . import sentences, show

    file = folder / f"{pictures[0].stem}.yaml"
    check_free(files_beside(file), pictures, force)  # before it takes any time
    found = first_parts(
        pictures,
        file,
        method=method,
        overrides=sets,
        most=count,
        smallest_mm=smallest,
        cache=None if no_cache else Cache(),
    )
    files = found.write(force)
    if as_json:
        said = {"title": found.title, "method": found.method, "parts": _rows(found.listed)}
        show.print_json({**said, "files": [str(path) for path in files]})
        return
    if is_quiet():
        return
    show.sentence(sentences.divided(" and ".join(each.name for each in pictures), len(found.listed)))
    _print(found.listed)
    for path in files:
        show.plain(f"written: {path}")
    show.plain(NEXT.format(labels=files[0], numbered=files[1], file=files[2]))


NEXT = """
Next:
  look at {numbered}, and write names and heights into {file}
  tangible run {file}       makes what can be felt, and draws it
  tangible parts {file}     lists and numbers the parts again, when you have painted over {labels}"""


def _list(
    files: Sequence[Path], out: Path | None, sets: Sequence[str], force: bool, as_json: bool, no_cache: bool
) -> None:
    from ..errors import ConfigError
    from ..files.writing import atomic_write
    from ..pipeline.first_parts import NUMBERED, check_free
    from ..pipeline.listed_parts import list_parts
    from ..pipeline.pipeline import load_pipeline
    from ..report.numbered_parts import is_as_drawn
    from . import sentences, show

    if len(files) > 1:
        raise ConfigError(f"{', '.join(map(str, files))}: name one picture, left and right, or one pipeline file")
    path = (files[0].parent if out is None else out) / NUMBERED
    if not is_as_drawn(path):
        check_free([path], force=force)
    pipeline = load_pipeline(files[0], sets)
    if no_cache:
        pipeline.cache = None
    found = list_parts(pipeline)
    with atomic_write(path) as file:
        file.write(found.numbered)
    if as_json:
        show.print_json({"title": pipeline.config.title, "parts": _rows(found.parts), "files": [str(path)]})
    elif not is_quiet():
        show.sentence(sentences.divided(pipeline.scene.name, len(found.parts)))
        _print(found.parts)
        show.plain(f"written: {path}")
    if found.wrong is not None:
        show.flush()
        raise found.wrong


def _rows(found: Sequence[ListedPart]) -> list[dict[str, Any]]:
    return [each._asdict() for each in found]


def _print(found: Sequence[ListedPart]) -> None:
    from rich.markup import escape

    from . import show

    rows = [
        (
            str(each.number),
            escape(each.name),
            each.place,
            f"{100 * each.share:.1f}",
            "" if each.height_m is None else f"{1000 * each.height_m:.1f}",
            escape(each.material),
        )
        for each in found
    ]
    show.table(("part", "name", "place", "% of the picture", "height mm", "material"), rows)
    show.plain("")

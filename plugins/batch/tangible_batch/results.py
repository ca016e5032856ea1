"""The files of a batch: its rows, and a table and a gallery of all rows."""

import json
from collections.abc import Iterable, Iterator, Mapping
from html import escape
from io import BytesIO
from itertools import islice
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, cast
from urllib.parse import quote

from pydantic import BaseModel, ConfigDict, Field, InstanceOf, ValidationError

from tangible_core.errors import ResultsError, shown
from tangible_core.files import atomic_write, read_rows, without_folders, write_text
from tangible_core.translation import language, localise

from .extra import need
from .job import Row

ROWS, INDEX, GALLERY = "rows.jsonl", "index.parquet", "gallery"
PER_PAGE = 500
PER_PART = 200
HUGE = 1e300
Number = Annotated[float, Field(ge=-HUGE, le=HUGE)]
Text = InstanceOf[str]
"""A text that may hold bytes of a file's name that are not characters, which pydantic's own does not."""


class _Part(BaseModel):
    model_config: ClassVar[ConfigDict] = ConfigDict(strict=True, frozen=True)


class SurfaceSize(_Part):
    """The size of a surface in a row, millimetres."""

    width_mm: Number
    length_mm: Number
    height_mm: Number


class DisparityErrors(_Part):
    """The errors of a disparity map in a row, per cent of the pixels."""

    bad2: Number | None = None


class Forces(_Part):
    """The forces of a session in a row."""

    peak_force_n: Number


class Figures(_Part):
    """The figures in a row."""

    surface: SurfaceSize | None = None
    disparity: DisparityErrors | None = None
    materials: dict[str, Any] | None = None
    force: Forces | None = None


class WrittenRow(_Part):
    """The fields of a row in the file, as far as the gallery shows them; see `Row`."""

    id: Text
    key: Text
    outcome: Literal["ok", "failed"]
    error: Text | None
    seconds: Number | None
    folder: Text
    scene: Text = ""
    figures: Figures | None = None
    notes: list[Text] = []
    files: list[Text] = []
    card: Text = ""


def last_rows(out: Path) -> dict[str, Row]:
    """Return the last row of each scene in the folder. Raises: ResultsError for a damaged file, with the line."""
    rows: dict[str, Row] = {}
    for number, row in read_rows(out / ROWS):
        try:
            rows[WrittenRow.model_validate(row).id] = row
        except ValidationError as error:
            first = error.errors()[0]
            place = shown(".".join(map(str, first["loc"])))
            raise ResultsError(f"{out / ROWS}:{number}: {place}: {first['msg']}; remove the line") from error
    return rows


def rows_of_scenes(out: Path, names: Iterable[str]) -> Iterator[Row]:
    """Return the last row of each of these scenes, in the order of the file; one at a time, as there may be many."""
    scenes = set(names)
    last = {str(row.get("id")): number for number, row in read_rows(out / ROWS)}
    lines = {number for name, number in last.items() if name in scenes}
    return (row for number, row in read_rows(out / ROWS) if number in lines)


def write_index(out: Path, names: Iterable[str]) -> Path:
    """Write the rows of these scenes as a table, a column for each figure. Raises: BatchError, OutputError."""
    arrow, parquet = need("pyarrow"), need("pyarrow.parquet")
    names = list(names)
    columns, texts = dict[str, None](), set[str]()
    for row in rows_of_scenes(out, names):
        for name, value in _flatten("", row):
            columns[name] = None
            texts |= {name} if isinstance(value, str) else set()
    schema = arrow.schema([(name, arrow.string() if name in texts else arrow.float64()) for name in columns])
    rows = (dict(_flatten("", row)) for row in rows_of_scenes(out, names))
    with atomic_write(out / INDEX) as file, parquet.ParquetWriter(file, schema, compression="zstd") as writer:
        while part := list(islice(rows, PER_PART)):
            lines = (
                {name: str(value) if name in texts and value is not None else value for name, value in row.items()}
                for row in part
            )
            writer.write_table(_table("\n".join(map(json.dumps, lines)).encode(), schema))
    return out / INDEX


def _table(lines: bytes, schema: Any) -> Any:
    """Read lines of JSON as a table: made of Python's values, Arrow would import pandas, at 57 MB."""
    reader = need("pyarrow.json")
    whole = reader.ReadOptions(use_threads=False, block_size=len(lines) + 1)
    return reader.read_json(BytesIO(lines), whole, reader.ParseOptions(explicit_schema=schema))


def write_gallery(out: Path, names: Iterable[str]) -> tuple[Path, ...]:
    """Write pages with the cards of these scenes, and the errors of those that failed. Raises: OutputError."""
    names = list(names)
    paths = tuple(out / f"{GALLERY}{number or ''}.html" for number in range(max(1, -(-len(names) // PER_PAGE))))
    rows = rows_of_scenes(out, names)
    for path in paths:
        write_text(path, printable(_page(out.name, islice(rows, PER_PAGE), paths, path)))
    return paths


def _flatten(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Yield columns with dotted names, such as `figures.disparity.bad2`; lists become text."""
    if isinstance(value, Mapping):
        for key, item in cast("Mapping[str, Any]", value).items():
            yield from _flatten(printable(f"{name}.{key}" if name else key), item)
    elif isinstance(value, list):
        yield name, printable("; ".join(map(str, cast("list[Any]", value))))
    elif isinstance(value, str):
        yield name, printable(value)
    else:
        yield name, None if value is None else float(min(max(value, -HUGE), HUGE))  # a damaged count may be any


def printable(text: str) -> str:
    """Return a text that UTF-8 can encode: file names may contain bytes that are not characters."""
    return text.encode(errors="replace").decode()


def _page(title: str, rows: Iterable[Row], pages: Iterable[Path], own: Path) -> str:
    links = " ".join(
        f"<strong>{number}</strong>" if path == own else f'<a href="{path.name}">{number}</a>'
        for number, path in enumerate(pages, 1)
    )
    figures = "\n".join(map(_figure, rows))
    return (
        f'<!doctype html>\n<html lang="{language()}"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{STYLE}</style></head>\n<body><h1>{escape(title)}</h1><nav>{links}</nav>\n<main>{figures}</main>"
        "</body></html>\n"
    )


def _figure(row: Row) -> str:
    name, scene = escape(printable(row["id"])), escape(printable(without_folders(row.get("scene") or "")))
    folder, summary = quote(printable(row["folder"])), escape(printable(_summary(row)))
    shows = escape(localise(f"{printable(row['id'])}: the picture, and the {_product(row)} made of it"))
    image = ""
    if card := row.get("card"):
        sheet = next((file for file in row.get("files", ()) if file.startswith("sheet.")), card)
        image = (
            f'<a href="{folder}/{escape(sheet)}"><img loading="lazy" src="{folder}/{escape(card)}" title="{scene}" '
            f'alt="{shows}"></a>'
        )
    caption = f'<a href="{folder}/">{name}</a>' if image else name
    pages = [printable(file) for file in row.get("files", ()) if file.endswith(".html")]
    caption += "".join(f' · <a href="{folder}/{quote(page)}">{escape(page)}</a>' for page in pages)
    line = f"<em>{summary}</em>" if row["outcome"] != "ok" else summary
    return f'<figure class="{row["outcome"]}">{image}<figcaption>{caption} <br>{line}</figcaption></figure>'


def _product(row: Row) -> str:
    """Return the product that was kept, such as `relief`."""
    records = [file.removesuffix(".npz") for file in row.get("files", ()) if file.endswith(".npz")]
    return next((record for record in reversed(records) if record != "recording"), "surface")


def _summary(row: Row) -> str:
    """Return a line on a scene: what was made and found, how wrong it is if known, and the warnings; or the error."""
    if row["outcome"] != "ok":
        return localise(row.get("error") or "failed")
    figures, parts = row.get("figures") or {}, [f"{_product(row)} made in {row['seconds']:.2g} s"]
    if surface := figures.get("surface"):
        size = f"{surface['width_mm']:.0f} x {surface['length_mm']:.0f} mm"
        parts.append(f"{size}, {surface['height_mm']:.3g} mm high")
    if (bad := (figures.get("disparity") or {}).get("bad2")) is not None:
        parts.append(f"{bad:.0f} % of the pixels are off by more than 2 px")
    if segments := len(figures.get("materials") or ()) or (surface or {}).get("segments"):
        parts.append(f"{segments} segments")
    if force := figures.get("force"):
        parts.append(f"felt with up to {force['peak_force_n']:.1f} N")
    warnings = (f"{localise('warning')}: {localise(note)}" for note in row.get("notes", ()))
    return "; ".join([*map(localise, parts), *warnings])


STYLE = (
    ":root{color-scheme:light dark;font-family:system-ui,sans-serif}main{display:flex;flex-wrap:wrap;gap:12px}"
    "figure{margin:0;width:320px}img{max-width:100%}figure.failed{border-left:6px solid #b00020;padding-left:6px}"
    "nav{margin-bottom:1em}figcaption{overflow-wrap:anywhere}"
)

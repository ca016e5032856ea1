"""What a batch leaves: rows as they came, and of all of them a table and a gallery."""

from collections.abc import Iterable, Mapping
from html import escape
from pathlib import Path
from typing import Any

from ..files.json_lines import read_rows
from ..files.writing import atomic_write, write_text
from .extra import need
from .job import Row

ROWS, INDEX, GALLERY = "rows.jsonl", "index.parquet", "gallery"
PER_PAGE = 500


def kept_rows(out: Path) -> dict[str, Row]:
    """The last row of each scene that the folder holds. Raises: ResultsError for a damaged file."""
    return {str(row.get("id")): row for _, row in read_rows(out / ROWS)}


def write_index(out: Path, rows: Iterable[Row]) -> Path:
    """All rows as one table, a column for each figure. Raises: BatchError without the extra, OutputError."""
    arrow, parquet = need("pyarrow"), need("pyarrow.parquet")
    flat = [_flat(row) for row in rows]
    names = list(dict.fromkeys(name for row in flat for name in row))
    table = arrow.table({name: [row.get(name) for row in flat] for name in names})
    with atomic_write(out / INDEX) as file:
        parquet.write_table(table, file, compression="zstd")
    return out / INDEX


def write_gallery(out: Path, rows: Iterable[Row]) -> tuple[Path, ...]:
    """Pages of cards, failures first said in words. Raises: OutputError."""
    every = list(rows)
    pages = [every[at : at + PER_PAGE] for at in range(0, len(every), PER_PAGE)] or [[]]
    paths = tuple(out / f"{GALLERY}{number or ''}.html" for number in range(len(pages)))
    for path, page in zip(paths, pages, strict=True):
        write_text(path, _page(out.name, page, paths, path))
    return paths


def _flat(row: Row) -> dict[str, Any]:
    """One level of columns, `figures.disparity.bad2`; lists as text."""
    found: dict[str, Any] = {}

    def put(name: str, value: Any) -> None:
        if isinstance(value, Mapping):
            for key, each in value.items():
                put(f"{name}.{key}" if name else str(key), each)
        elif isinstance(value, list):
            found[name] = "; ".join(map(str, value))
        elif isinstance(value, bool | int | float):
            found[name] = float(value)
        else:
            found[name] = value

    put("", row)
    return found


def _page(title: str, rows: Iterable[Row], pages: Iterable[Path], own: Path) -> str:
    links = " ".join(
        f"<strong>{number}</strong>" if path == own else f'<a href="{path.name}">{number}</a>'
        for number, path in enumerate(pages, 1)
    )
    figures = "\n".join(map(_figure, rows))
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>'
        f"<style>{STYLE}</style></head>\n<body><h1>{escape(title)}</h1><nav>{links}</nav>\n<main>{figures}</main>"
        "</body></html>\n"
    )


def _figure(row: Row) -> str:
    name, error = escape(str(row["id"])), escape(row.get("error") or "")
    image = (
        f'<img loading="lazy" src="{escape(row["folder"])}/{escape(row["card"])}" alt="">' if row.get("card") else ""
    )
    said = f" <em>{error}</em>" if error else ""
    return f'<figure class="{row["outcome"]}">{image}<figcaption>{name}{said}</figcaption></figure>'


STYLE = (
    ":root{color-scheme:light dark;font-family:system-ui,sans-serif}main{display:flex;flex-wrap:wrap;gap:12px}"
    "figure{margin:0;width:320px}img{max-width:100%}figure.failed{border-left:6px solid #b00020;padding-left:6px}"
    "nav{margin-bottom:1em}figcaption{overflow-wrap:anywhere}"
)

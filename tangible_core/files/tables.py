"""Tables as text, also as a spreadsheet or a mail program saves them anew: other separators, line ends and quotes."""

import csv
import io
import logging
import re
from collections.abc import Iterator
from pathlib import Path

from ..errors import quoted
from .reading import MAX_BYTES, read_bytes

log: logging.Logger = logging.getLogger(__name__)
SEPARATORS = ",;\t"
csv.field_size_limit(MAX_BYTES)  # the file as a whole has this limit; a cell needs none of its own
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(?:[eE][-+]?\d+)?")


def read_table(path: Path, appended: bool = False) -> tuple[list[str], Iterator[tuple[int, dict[str, str]]]]:
    """Read the names of the columns, and the number of each line, from 1, with its cells by column.

    Empty lines are left out, and cells that a line lacks. Where commas separate no cells, those of numbers are points.
    appended: lines are added to this file, so that one without an end was cut off: it is left out, with a warning.
    Raises: OSError; ValueError that names the line, also from the iterator.
    """
    data = read_bytes(path)
    if appended and b"\r" not in data and not data.endswith(b"\n"):
        log.warning("%s: its last line has no end, and is left out", path)
        data = data[: data.rfind(b"\n") + 1]
    text = data.decode("utf-8-sig")
    header = next(iter(text.splitlines()), "")
    separator = max(SEPARATORS, key=header.count)
    lines = csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True)
    columns = [name.strip() for name in _next(lines) or []]
    names = [name for name in columns if name]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise ValueError(f"line 1 has two columns {quoted(twice)}; rename one")
    return names, _rows(lines, columns, separator)


def _rows(lines: Iterator[list[str]], columns: list[str], separator: str) -> Iterator[tuple[int, dict[str, str]]]:
    while (cells := _next(lines)) is not None:
        number: int = getattr(lines, "line_num", 0)
        if any(cells[len(columns) :]) or any(cell for name, cell in zip(columns, cells, strict=False) if not name):
            raise ValueError(f"line {number} has more cells than there are columns; correct the line")
        if separator != ",":
            cells = [cell.replace(",", ".") if DECIMAL_COMMA.fullmatch(cell) else cell for cell in cells]
        if any(cells):
            yield number, {name: cell for name, cell in zip(columns, cells, strict=False) if name}


def _next(lines: Iterator[list[str]]) -> list[str] | None:
    try:
        return next(lines, None)
    except csv.Error as error:
        raise ValueError(
            f"line {getattr(lines, 'line_num', 1)} is not of a table: {error}; correct its quotes"
        ) from error

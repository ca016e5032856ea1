"""A rectangle out of a raw array in a file, without reading the rest."""

from pathlib import Path

WINDOW = frozenset({"row", "rows", "column", "columns", "of", "bytes"})
"""The first row and how many, the first column and how many, of how many columns, and the bytes of an item."""
MOST_ITEMS = 4_000_000


def read_window(path: Path, asked: dict[str, int]) -> bytes:
    """The rectangle, row by row. asked: a number for each of WINDOW. Raises: ValueError if the file has none such."""
    row, rows, column, columns, of, size = (asked[key] for key in ("row", "rows", "column", "columns", "of", "bytes"))
    inside = min(row, column) >= 0 and min(rows, columns, size) > 0 and column + columns <= of
    if not inside or rows * columns > MOST_ITEMS or (row + rows) * of * size > path.stat().st_size:
        raise ValueError("no such window")
    with path.open("rb") as file:
        parts: list[bytes] = []
        for each in range(row, row + rows):
            file.seek((each * of + column) * size)
            parts.append(file.read(columns * size))
    return b"".join(parts)

"""Rows of a block with those around it, for filters with a reach of a few rows."""


def slices_with_margin(y0: int, y1: int, rows: int) -> tuple[slice, slice]:
    """Slice rows y0..y1-1 with a margin of `rows` on either side, where there are; and y0..y1-1 within that slice."""
    first = max(0, y0 - rows)
    return slice(first, y1 + rows), slice(y0 - first, y1 - first)

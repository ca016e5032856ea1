"""`plugins`: what is installed, read from metadata and source text."""

from .options import Json

COLUMNS = ("kind", "name", "origin", "summary")


def plugins(as_json: Json = False) -> None:
    """List the installed methods and devices.

    One line each, for eyes and for grep; none of them is imported.
    """
    import json

    from ..plugins.registry import default_registry
    from ..runtime.standard_output import stream

    rows = [{column: getattr(each, column) for column in (*COLUMNS, "target")} for each in default_registry().listings]
    if as_json:
        print(json.dumps(rows, indent=2, ensure_ascii=False), file=stream())
        return
    shown = [{column: column for column in COLUMNS}, *rows]
    widths = [max(len(row[column]) for row in shown) for column in COLUMNS[:-1]]
    for row in shown:
        cells = (row[column].ljust(width) for column, width in zip(COLUMNS, widths, strict=False))
        print(*cells, row["summary"], sep="  ", file=stream())

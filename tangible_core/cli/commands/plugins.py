"""`tangible plugins`: what is installed, read from metadata and source text; `show` says all of one method."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ...errors import ConfigError
from ...plugins.registry import KIND_NAMES
from .. import completing
from ..options import FAILED, Json

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...metrics.measured import Measured
    from ...plugins.registry import Listing
    from ...testing import CheckResult

COLUMNS = ("kind", "name", "origin", "summary")

app = typer.Typer(name="plugins", rich_markup_mode=None, add_completion=False)


@app.callback(invoke_without_command=True)
def plugins(context: typer.Context, as_json: Json = False) -> None:
    """List the installed methods and devices; show one of them.

    One line each, for eyes and for grep; none of them is imported.
    """
    if context.invoked_subcommand is not None:
        if as_json:
            raise ConfigError(f"plugins: write --json after {context.invoked_subcommand!r}")
        return
    import json

    from ...plugins.registry import default_registry
    from ...runtime.standard_output import stream

    rows = [{column: getattr(each, column) for column in (*COLUMNS, "target")} for each in default_registry().listings]
    if as_json:
        print(json.dumps(rows, indent=2, ensure_ascii=False), file=stream())
        return
    shown = [{column: column for column in COLUMNS}, *rows]
    widths = [max(len(row[column]) for row in shown) for column in COLUMNS[:-1]]
    for row in shown:
        cells = (row[column].ljust(width) for column, width in zip(COLUMNS, widths, strict=False))
        print(*cells, row["summary"], sep="  ", file=stream())


@app.command("show")
def show_one(
    kind: Annotated[
        str,
        typer.Argument(help=" | ".join(KIND_NAMES), show_default=False, autocompletion=completing.kinds),
    ],
    name: Annotated[
        str,
        typer.Argument(
            help="The method, as `tangible plugins` lists it.",
            show_default=False,
            autocompletion=completing.methods,
        ),
    ],
    as_json: Json = False,
) -> None:
    """Say everything of one method or device.

    What it does and by which source; each option with its unit, bounds and default; how fast and how exact it was.
    """
    import inspect

    from ...metrics.measured import measured
    from ...pipeline.config.markdown import options_of
    from ...plugins.registry import default_registry
    from .. import show

    registry = default_registry()
    listing, cls = registry.find(kind, name), registry.load(kind, name)
    text, options = inspect.getdoc(cls) or "", options_of(cls)
    found = measured().get(kind) if listing.distribution == OURS else None
    if as_json:
        figures = None if found is None else _figures(found, listing.name)
        said = {column: getattr(listing, column) for column in (*COLUMNS, "target")}
        show.print_json({**said, "text": text, "options": [each._asdict() for each in options], "measured": figures})
        return
    show.plain(f"{listing.name} is {WORDS[kind]} of {listing.origin}.\n\n{text}\n")
    show.say("[bold]options[/]" if options else "It has no options.")
    for each in options:
        bounds = ", ".join(filter(None, (each.unit, each.values)))
        show.entry(f"{each.name} = {each.default or 'null'}   ({bounds})", each.meaning)
    show.plain(f"\n{_measured_in_words(listing, found)}")
    show.plain(f"Its source: {inspect.getsourcefile(cls)}")


OURS = "tangible-images"
WORDS = {
    "depth": "a depth method",
    "texture": "a texture method",
    "render": "a force law",
    "device": "a device",
    "export": "an exporter",
}


def _figures(found: Measured, name: str) -> dict[str, Any]:
    figures = dict(zip(found.columns, found.methods.get(name, ()), strict=False))
    said = {"scene": found.scene, "machine": found.machine, "day": found.day, "versions": found.versions}
    return {**said, "figures": figures, "failed": found.failed.get(name)}


def _measured_in_words(listing: Listing, found: Measured | None) -> str:
    """How fast and how exact it was, and where."""
    from ...metrics.measured import in_words

    if listing.kind == "device":
        return f"`tangible devices stress {listing.name}` measures how fast it can be read and written."
    if listing.kind == "export":
        return "How long it takes is said with each export."
    if found is None or listing.name not in (*found.methods, *found.failed):
        file = f"configs/compare-{listing.kind}.yaml"
        return f"No figures of it come with the program: `tangible compare` measures it, with a file such as {file}."
    where = f"On {found.scene}, with its defaults, on {in_words(found.machine)} ({found.day})"
    if why := found.failed.get(listing.name):
        return f"{where}, it has no figures: {why}."
    values = zip(found.columns, found.methods[listing.name], strict=True)
    told = ", ".join(f"{column} {value:g}" for column, value in values if value is not None)
    best = next(iter(found.methods))
    return f"{where}: {told}. The most exact of {len(found.methods)} is {best}."


def check(
    kind: Annotated[
        str, typer.Argument(help=" | ".join(KIND_NAMES), show_default=False, autocompletion=completing.kinds)
    ],
    name: Annotated[
        str,
        typer.Argument(
            help="The method, as `tangible plugins` lists it.", show_default=False, autocompletion=completing.methods
        ),
    ],
    as_json: Json = False,
) -> None:
    """Test an installed method with the conformance kit.

    Exit 1 if a check fails that the method does not declare to fail, or passes that it declares to fail.
    """
    from rich.markup import escape

    from ...testing import run_checks
    from .. import sentences, show

    results = list(run_checks(kind, name))
    if as_json:
        show.print_json([each._asdict() for each in results])
    else:
        rows = [(each.name, GRADES[each.passed, bool(each.expected_failure)], escape(_said(each))) for each in results]
        show.sentence(sentences.checked(f"{kind} method {name}", results))
        show.table(("check", "result", "message"), rows)
        show.say(f"\n{_count(results)}")
    if not all(each.as_declared for each in results):
        raise typer.Exit(FAILED)


GRADES = {
    (True, False): "[green]passed[/]",
    (False, False): "[red]FAILED[/]",
    (False, True): "[yellow]fails as declared[/]",
    (True, True): "[red]PASSED, declared to fail[/]",
}
"""By whether it passed, and whether it was declared to fail."""


def _said(result: CheckResult) -> str:
    return (
        f"{result.expected_failure} ({result.message})"
        if result.expected_failure and not result.passed
        else result.message
    )


def _count(results: Sequence[CheckResult]) -> str:
    numbers = Counter((each.passed, bool(each.expected_failure)) for each in results)
    parts = [f"{numbers[True, False]} passed", f"{numbers[False, False]} failed"]
    if declared := numbers[False, True]:
        parts.append(f"{declared} failed as the method declares")
    if wrong := numbers[True, True]:
        parts.append(f"{wrong} passed that the method declares to fail")
    return ", ".join(parts)

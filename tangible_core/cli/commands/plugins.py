"""The commands `plugins` (list methods, show one) and `check` (run the conformance kit on one)."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from itertools import chain
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ...errors import ConfigError, UnknownName
from ...plugins.hooks import tell
from ...plugins.registry import KIND_NAMES, Listing, default_registry
from ...runtime import standard_output
from ...translation import localise
from .. import completing, sentences, show
from ..options import FAILED, Json, is_listing

if TYPE_CHECKING:
    from ...metrics.measured import Measured
    from ...testing import CheckResult

COLUMNS = ("kind", "name", "origin", "summary")
Kind = Annotated[
    str,
    typer.Argument(
        metavar="[KIND]",
        help=f"{' | '.join(KIND_NAMES)}; needed where two kinds have the name.",
        show_default=False,
        autocompletion=completing.kinds,
    ),
]
Name = Annotated[
    str | None,
    typer.Argument(
        metavar="NAME",
        help="The method, as `tangible plugins` lists it.",
        show_default=False,
        autocompletion=completing.methods,
    ),
]


def _kind_and_name(kind: str, name: str | None) -> tuple[str, str]:
    if name is not None:
        return kind, name
    named = {listing.kind for listing in default_registry().listings if listing.name == kind}
    if not named:
        raise UnknownName("method", kind, (listing.name for listing in default_registry().listings))
    if len(named) > 1:
        raise ConfigError(
            f"{kind}: is a name of several kinds; write one of them before it: {', '.join(sorted(named))}"
        )
    return named.pop(), kind


app: typer.Typer = typer.Typer(name="plugins", rich_markup_mode=None, add_completion=False)


@app.callback(invoke_without_command=True)
def plugins(context: typer.Context, as_json: Json = False) -> None:
    """List the installed methods and devices; show one of them.

    One line each, for people and for grep; none of them is imported.
    """
    if not is_listing("plugins", context.invoked_subcommand, as_json):
        return

    registry = default_registry()
    listings = (*registry.listings, *chain.from_iterable(tell(registry.plugins, "tangible_listings")))
    rows = [{column: getattr(listing, column) for column in (*COLUMNS, "target")} for listing in listings]
    if as_json:
        print(json.dumps(rows, indent=2, ensure_ascii=False), file=standard_output.stream())
        return
    if (own := standard_output.stream()) is not None and own.isatty():
        origins = ["" if listing.distribution == OURS else f" ({listing.origin})" for listing in listings]
        cells = [
            (row["kind"], row["name"], show.escape(row["summary"]) + by) for row, by in zip(rows, origins, strict=True)
        ]
        show.table(("kind", "name", "summary"), cells, named=2)
        return
    lines = [{column: localise(column) for column in COLUMNS}, *rows]
    widths = [max(len(row[column]) for row in lines) for column in COLUMNS[:-1]]
    for row in lines:
        cells = (row[column].ljust(width) for column, width in zip(COLUMNS, widths, strict=False))
        print(*cells, localise(row["summary"]), sep="  ", file=standard_output.stream())


@app.command("show")
def show_one(kind: Kind, name: Name = None, as_json: Json = False) -> None:
    """Show one method or device.

    What it does and by which source; each option with its unit, bounds and default; how fast and how exact it was.
    """
    import inspect

    from ...data.options import describe_options
    from ...metrics.measured import load_measured

    registry, (kind, name) = default_registry(), _kind_and_name(kind, name)
    listing, cls = registry.find(kind, name), registry.load(kind, name)
    text, options = inspect.cleandoc(vars(cls).get("__doc__") or ""), describe_options(cls)
    measurements = load_measured().get(kind) if listing.distribution == OURS else None
    if as_json:
        figures = None if measurements is None else _figures(measurements, listing.name)
        head = {column: getattr(listing, column) for column in (*COLUMNS, "target")}
        show.print_json(
            {**head, "text": text, "options": [option._asdict() for option in options], "measured": figures}
        )
        return
    show.plain(f"{listing.name} is {WORDS[kind]} of {listing.origin}.\n")
    show.plain(f"{text}\n")
    show.say("[bold]options[/]" if options else "It has no options.")
    for option in options:
        bounds = ", ".join(filter(None, (option.unit, localise(option.values))))
        show.entry(f"{option.name} = {option.default or 'null'}   ({bounds})", option.meaning)
    show.plain(f"\n{_speed_and_accuracy(listing, measurements)}")
    show.plain(f"Its source: {inspect.getsourcefile(cls)}")


OURS = "tangible-images"
WORDS = {
    "depth": "a depth method",
    "texture": "a texture method",
    "render": "a force law",
    "device": "a device",
    "export": "an exporter",
}


def _figures(measured: Measured, name: str) -> dict[str, Any]:
    figures = dict(zip(measured.columns, measured.methods.get(name, ()), strict=False))
    where = {"scene": measured.scene, "machine": measured.machine, "day": measured.day, "versions": measured.versions}
    return {**where, "figures": figures, "failed": measured.failed.get(name)}


def _speed_and_accuracy(listing: Listing, measured: Measured | None) -> str:
    if listing.kind == "device":
        return f"`tangible devices stress {listing.name}` measures how fast it can be read and written."
    if listing.kind == "export":
        return "Each export prints how long it took."
    if measured is None or listing.name not in (*measured.methods, *measured.failed):
        file = f"configs/compare-{listing.kind}.yaml"
        return f"The program has no figures of it: `tangible compare` measures it, with a file such as {file}."
    processor, cores, system = (measured.machine[key] for key in ("processor", "cores", "system"))
    where = f"On {measured.scene}, with its defaults, on {processor}, {cores} cores, {system} ({measured.day})"
    if why := measured.failed.get(listing.name):
        return f"{where}, it has no figures: {why}."
    values = zip(measured.columns, measured.methods[listing.name], strict=True)
    figures = ", ".join(f"{column}: {value:g}" for column, value in values if value is not None)
    best = next(iter(measured.methods))
    return f"{where}, it has these figures ({figures}). The most exact of {len(measured.methods)} is {best}."


def check(kind: Kind, name: Name = None, as_json: Json = False) -> None:
    """Test an installed method with the conformance kit.

    Exit 1 if a check fails that the method does not declare to fail, or passes that it declares to fail.
    """
    from ...testing import run_checks

    kind, name = _kind_and_name(kind, name)
    results = list(run_checks(kind, name))
    if as_json:
        show.print_json([result._asdict() for result in results])
    else:
        rows = [
            (one.name, GRADES[one.passed, bool(why := one.expected_failure)],
             show.escape(f"{why} ({one.message})" if why and not one.passed else one.message))
            for one in results
        ]  # fmt: skip
        show.sentence(sentences.check_summary(f"{kind} method {name}", results))
        show.table(("check", "result", "message"), rows)
        show.say(f"\n{_count(results)}")
    if not all(result.as_declared for result in results):
        raise typer.Exit(FAILED)


GRADES = {
    (True, False): "[green]passed[/]",
    (False, False): "[red]FAILED[/]",
    (False, True): "[yellow]fails as declared[/]",
    (True, True): "[red]PASSED, declared to fail[/]",
}  # by: passed, declared to fail


def _count(results: Sequence[CheckResult]) -> str:
    numbers = Counter((result.passed, bool(result.expected_failure)) for result in results)
    parts = [f"{numbers[True, False]} passed", f"{numbers[False, False]} failed"]
    if declared := numbers[False, True]:
        parts.append(f"{declared} failed as the method declares")
    if wrong := numbers[True, True]:
        parts.append(f"{wrong} passed that the method declares to fail")
    return ", ".join(parts)

"""The command `cache`: the folder and size of cached results, and how to clear them."""

from __future__ import annotations

from typing import Annotated

import typer

from .. import show
from ..options import Json, ask, is_listing

app: typer.Typer = typer.Typer(name="cache", rich_markup_mode=None, add_completion=False)


@app.callback(invoke_without_command=True)
def cache(context: typer.Context, as_json: Json = False) -> None:
    """Print the size of the cache of results; clear it.

    A run takes unchanged results from the cache. Nothing in it is needed: results that are gone are computed again.
    """
    if not is_listing("cache", context.invoked_subcommand, as_json):
        return
    from ...pipeline.engine.cache import Cache

    results = Cache()
    count, size = results.size()
    if as_json:
        show.print_json({"folder": results.folder, "entries": count, "bytes": size, "max_bytes": results.max_bytes})
        return
    show.say(
        f"{_results(count)} of earlier runs take {_megabytes(size)} of at most {_megabytes(results.max_bytes)}, in"
    )
    show.plain(str(results.folder))


@app.command()
def clear(yes: Annotated[bool, typer.Option("--yes", "-y", help="Do not ask.")] = False, as_json: Json = False) -> None:
    """Delete all cached results.

    On a terminal it asks first; without one, --yes is needed.
    """
    from ...pipeline.engine.cache import Cache

    results = Cache()
    count, size = results.size()
    if count and not yes:
        ask(
            f"Delete {_results(count)} ({_megabytes(size)}) in {results.folder}?",
            "cache clear: there is no terminal to ask on; --yes deletes without asking",
        )
    gone, freed = results.clear()
    if as_json:
        show.print_json({"folder": results.folder, "entries": gone, "bytes": freed})
    else:
        show.say(f"{_results(gone)} deleted, {_megabytes(freed)} freed")


def _results(count: int) -> str:
    return "1 result" if count == 1 else f"{count} results"


def _megabytes(size: int) -> str:
    return f"{size / 1e6:,.1f} MB"

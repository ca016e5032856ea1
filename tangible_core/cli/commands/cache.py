"""`tangible cache`: where earlier results are kept, how much they take, and how to clear them."""

from __future__ import annotations

from typing import Annotated

import typer

from ...errors import ConfigError
from ..options import Json

app = typer.Typer(name="cache", rich_markup_mode=None, add_completion=False)


@app.callback(invoke_without_command=True)
def cache(context: typer.Context, as_json: Json = False) -> None:
    """Say how much is kept of earlier results; clear it.

    A run takes from there what has not changed. Nothing in it is needed: what is gone is made again.
    """
    if context.invoked_subcommand is not None:
        if as_json:
            raise ConfigError(f"cache: write --json after {context.invoked_subcommand!r}")
        return
    from ...pipeline.engine.cache import Cache
    from .. import show

    kept = Cache()
    count, size = kept.size()
    if as_json:
        show.print_json({"folder": kept.folder, "entries": count, "bytes": size, "max_bytes": kept.max_bytes})
        return
    show.say(f"{_results(count)} of earlier runs take {_megabytes(size)} of at most {_megabytes(kept.max_bytes)}, in")
    show.plain(str(kept.folder))


@app.command()
def clear(
    yes: Annotated[bool, typer.Option("--yes", "-y", help="Do not ask.")] = False,
    as_json: Json = False,
) -> None:
    """Delete all that is kept of earlier results.

    On a terminal it asks first; without one, --yes is needed.
    """
    from ...pipeline.engine.cache import Cache
    from .. import show

    kept = Cache()
    count, size = kept.size()
    if count and not yes:
        _ask(f"Delete {_results(count)} ({_megabytes(size)}) in {kept.folder}?")
    gone, freed = kept.clear()
    if as_json:
        show.print_json({"folder": kept.folder, "entries": gone, "bytes": freed})
    else:
        show.say(f"{_results(gone)} deleted, {_megabytes(freed)} freed")


def _ask(question: str) -> None:
    """Raises: ConfigError if nobody can answer, Abort if the answer is no."""
    import sys

    if sys.stdin is None or not sys.stdin.isatty():
        raise ConfigError("cache clear: nobody is there to be asked; --yes deletes without asking")
    if not typer.confirm(question, err=True):
        raise typer.Exit


def _results(count: int) -> str:
    return "1 result" if count == 1 else f"{count} results"


def _megabytes(size: int) -> str:
    return f"{size / 1e6:,.1f} MB"

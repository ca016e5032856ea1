"""The command `networks`: which networks the program can use, and how they come here."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tangible_core.cli import FAILED, Json, ask, is_listing, show
from tangible_core.errors import ConfigError

if TYPE_CHECKING:
    from ..card import Card
    from ..fetching import Progress
    from ..store import KnownNetwork

app: typer.Typer = typer.Typer(name="networks", rich_markup_mode=None, add_completion=False)
Names = Annotated[
    list[str],
    typer.Argument(metavar="NAME...", help="Names of networks, or tasks: figure, borders, faces, text, depth.",
                   show_default=False),
]  # fmt: skip
COLOURS = {"here": "green", "absent": "dim", "damaged": "bold red"}


@app.callback(invoke_without_command=True)
def networks(context: typer.Context, as_json: Json = False) -> None:
    """List the networks that the program can use; add or remove them.

    A network finds faces, borders, depth, or what stands out from its ground, in one photograph, or reads the labels of
    a drawing. None is needed, and none is part of the program: only `tangible networks add` fetches them.
    """
    if not is_listing("networks", context.invoked_subcommand, as_json):
        return

    from ..store import known_networks, models_folder

    by_name = known_networks()
    if as_json:
        show.print_json([network.as_data() for network in by_name.values()])
        return
    rows = [
        (
            name,
            network.card.task,
            f"[{COLOURS[network.state]}]{network.state}[/]",
            _megabytes(network.card),
            network.card.improves,
            network.card.licence,
            network.card.trained_on,
        )
        for name, network in by_name.items()
    ]
    show.table(["network", "task", "is", "size", "what it does", "licence", "trained on"], rows, named=2)
    show.say("They are kept in:")
    show.plain(str(models_folder()))


@app.command()
def add(
    names: Names,
    source: Annotated[
        Path | None,
        typer.Option(
            "--from", help="Take this file, fetched elsewhere: the network or the package that it is part of."
        ),
    ] = None,
    yes: Annotated[bool, typer.Option("--yes", "-y", help="Do not ask.")] = False,
    as_json: Json = False,
) -> None:
    """Fetch networks, check them, and keep them.

    On a terminal it says how much it fetches and under which licence, and asks first.

    Example: tangible networks add figure borders faces
    """
    from ..fetching import add_network
    from ..store import chosen_networks

    selection = chosen_networks(names)
    if source is not None and not source.is_file():
        raise ConfigError(f"--from: {source}: there is no such file")
    if source is not None and len(selection) > 1 and source.suffix not in (".whl", ".tgz", ".zip"):
        raise ConfigError("--from: one file is one network; name one network")
    requests = [network for network in selection if network.state != "here"]
    if not as_json:
        for network in selection:
            show.say(_announcement(network, network not in requests))
    if requests and not yes and source is None:
        ask(
            "Fetch?" if len(requests) == 1 else f"Fetch these {len(requests)}?",
            "networks add: there is no terminal to ask on; --yes fetches without asking",
            default=True,
        )
    for network in requests:
        with _progress(network.name, hidden=as_json) as progress:
            add_network(network, source, progress)
        if not as_json:
            show.say(f"{network.name} is here and right")
    if as_json:
        show.print_json([network.as_data() for network in selection])


@app.command()
def remove(names: Names, as_json: Json = False) -> None:
    """Delete networks. Results that were made with them stay."""
    from ..fetching import remove_network
    from ..store import chosen_networks

    removed_names = [network.name for network in chosen_networks(names) if remove_network(network)]
    if as_json:
        show.print_json(removed_names)
    else:
        show.say(
            f"deleted: {', '.join(removed_names)}" if removed_names else "nothing to delete: none of these is here"
        )


@app.command()
def check(as_json: Json = False) -> None:
    """Check that each network that is here is the file of its card. Exit code 1 if one is not."""
    from ..store import known_networks

    present = [network for network in known_networks().values() if network.state != "absent"]
    if as_json:
        show.print_json([network.as_data() for network in present])
    elif not present:
        show.say("no network is here; `tangible networks add figure borders faces` fetches some")
    else:
        for network in present:
            cure = f"; `tangible networks add {network.name}` fetches it again" if network.state == "damaged" else ""
            show.say(f"{network.name}: {'right' if network.state == 'here' else 'damaged'}{cure}")
    if any(network.state == "damaged" for network in present):
        raise typer.Exit(FAILED)


def _announcement(network: KnownNetwork, is_here: bool) -> str:
    card = network.card
    if is_here:
        return f"{network.name} is here already"
    size = _megabytes(card)
    return f"{network.name} ({card.title}): {card.improves}; {size}, licence {card.licence}, from {card.source}"


@contextmanager
def _progress(name: str, hidden: bool) -> Generator[Progress]:
    from rich.console import Console
    from rich.progress import BarColumn, DownloadColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    console = Console(stderr=True)
    columns = TextColumn("{task.description}"), BarColumn(), DownloadColumn(), TimeRemainingColumn()
    with Bar(*columns, console=console, transient=True, disable=hidden or not console.is_terminal) as bar:
        task = bar.add_task(name, total=None)
        yield lambda done, whole: bar.update(task, completed=done, total=whole or None)


def _megabytes(card: Card) -> str:
    size = card.size_bytes or card.about_bytes
    return f"{size / 1e6:,.1f} MB" if size else "size unknown"

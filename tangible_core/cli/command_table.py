"""Every command: where it is, and what its help says in a line. A command's module is imported when it is called."""

from __future__ import annotations

from collections.abc import Callable, Iterator, MutableMapping
from functools import cache, wraps
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import typer
from typer.core import TyperGroup

from ..files.paths import as_path
from ..runtime import standard_output

if TYPE_CHECKING:
    from typer.models import CommandInfo, TyperInfo


class Command(NamedTuple):
    """A command that is not imported yet."""

    place: str
    """`package.module:name` of its function, or of its group of commands."""
    summary: str
    """The first line of its help."""


ROOM = f"{__package__}.commands"
COMMANDS = {
    "demo": Command(f"{ROOM}.run:demo", "Run the built-in example from picture to force."),
    "run": Command(f"{ROOM}.run:run", "Run a pipeline file, or a picture, and write a report."),
    "plan": Command(f"{ROOM}.run:plan", "Say what `run` would do, and why; run nothing."),
    "export": Command(f"{ROOM}.export:export", "Write files for others: a printer, swell paper, pins, a reader."),
    "preflight": Command(f"{ROOM}.preflight:preflight", "Check, before a motor moves, what is safe."),
    "legible": Command(
        f"{ROOM}.legible:legible", "Check whether fingers can read it, on paper, print, pins or a device."
    ),
    "feel": Command(f"{ROOM}.feel:feel", "Feel the surface on the configured device, in real time."),
    "replay": Command(f"{ROOM}.replay:replay", "Feel a recording again with another law."),
    "plugins": Command(f"{ROOM}.plugins:app", "List the installed methods and devices; show one of them."),
    "check": Command(f"{ROOM}.plugins:check", "Test an installed method with the conformance kit."),
    "devices": Command(f"{ROOM}.devices:app", "List devices; examine, home or calibrate one."),
    "cache": Command(f"{ROOM}.cache:app", "Say how much is kept of earlier results; clear it."),
    "schema": Command(f"{ROOM}.schema:schema", "Print the JSON Schema of pipeline files."),
}


def add(name: str, place: str, summary: str) -> None:
    """Add a command that is imported when it is called; a name that is taken stays with its first owner.

    place: `package.module:name` of its function, or of its group of commands. summary: the first line of its help.
    """
    COMMANDS.setdefault(name, Command(place, summary))


class Lazy(TyperGroup):
    """The group of all commands; what is only listed is not imported."""

    def __init__(self, **told: Any) -> None:
        super().__init__(**told)
        self.commands: MutableMapping[str, Any] = _Known(dict(self.commands))

    def list_commands(self, ctx: Any) -> list[str]:
        """Names, in the order of the help."""
        return list(self.commands)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Summaries, whole, however narrow the terminal is."""
        rows = [(name, _summary(name, self.commands)) for name in self.commands]
        with formatter.section("Commands"):
            formatter.write_dl(rows)


class _Known(MutableMapping[str, Any]):
    """Commands by name; those of this room are made when one asks for them."""

    def __init__(self, others: dict[str, Any]) -> None:
        self.others = others
        """What plugins add; none of them takes the place of one of ours."""

    def __getitem__(self, name: str) -> Any:
        return made(name) if name in COMMANDS else self.others[name]

    def __setitem__(self, name: str, command: Any) -> None:
        self.others[name] = command

    def __delitem__(self, name: str) -> None:
        del self.others[name]

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys((*COMMANDS, *self.others)))

    def __len__(self) -> int:
        return sum(1 for _ in self)


@cache
def made(name: str) -> Any:
    """One of COMMANDS, imported."""
    module, _, attribute = COMMANDS[name].place.partition(":")
    found = getattr(import_module(module), attribute)
    app = found if isinstance(found, typer.Typer) else typer.Typer(rich_markup_mode=None, add_completion=False)
    if app is not found:
        app.command(name)(found)
    for each in _within(app):
        each.callback = each.callback and standard_output.kept()(_at_home(each.callback))
    return typer.main.get_command(app)


def _at_home(command: Callable[..., Any]) -> Callable[..., Any]:
    """What a shell leaves of `~`, as in --out=~/maps, is a home here too."""

    @wraps(command)
    def called(**options: Any) -> Any:
        return command(**{name: _expanded(value) for name, value in options.items()})

    return called


def _expanded(value: Any) -> Any:
    if isinstance(value, list):
        return [_expanded(each) for each in cast("list[Any]", value)]
    return as_path(value) if isinstance(value, Path) else value


def _within(typed: typer.Typer) -> Iterator[CommandInfo | TyperInfo]:
    """Every command, and what is called before one."""
    yield from typed.registered_commands
    yield from filter(None, [typed.registered_callback])
    for group in typed.registered_groups:
        if group.typer_instance:
            yield from _within(group.typer_instance)


def _summary(name: str, commands: MutableMapping[str, Any]) -> str:
    said = COMMANDS[name].summary if name in COMMANDS else (commands[name].help or "").partition("\n")[0]
    return said.removesuffix(".")

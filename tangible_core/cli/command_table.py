"""The table of commands: the place of each, and its summary. A command's module is imported when it is called."""

from __future__ import annotations

from collections.abc import Callable, Iterator, MutableMapping
from functools import cache, wraps
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast
from weakref import WeakSet

import typer
from typer.core import TyperGroup

from ..files.paths import as_path
from ..runtime import standard_output
from ..translation import localise

if TYPE_CHECKING:
    from typer.models import CommandInfo, TyperInfo


class Command(NamedTuple):
    """A command that is not imported yet."""

    place: str  # `package.module:name` of its function, or of its group of commands
    summary: str  # the first line of its help
    group: str = "More"  # the heading below which it is listed
    example: str = ""  # a call as a person would type it


GROUPS = ("Begin", "Make", "Feel", "Compare", "The program", "More")
COMMANDS = {
    name: Command(f"{__package__}.commands.{place}", summary, group, f"tangible {name} {words}")
    for name, place, summary, group, words in (
        ("demo", "run:demo", "Run the built-in example from picture to force.", GROUPS[0], "-v"),
        ("run", "run:run", "Run a pipeline file, or a picture, and write a report.", GROUPS[1], "photo.jpg"),
        ("plan", "run:plan", "Show what `run` would do, and why; run nothing.", GROUPS[1], "mine.yaml"),
        ("export", "export:export", "Write files for others: a printer, swell paper, pins, a reader.",
         GROUPS[1], "photo.jpg --to swell,stl"),
        ("feel", "feel:feel", "Feel the surface on the configured device, in real time.",
         GROUPS[2], "mine.yaml --seconds 30 --record hand.nc"),
        ("replay", "replay:replay", "Re-run a recorded hand path with another force law.",
         GROUPS[2], "hand.nc mine.yaml --set render.use=penalty"),
        ("plugins", "plugins:app", "List the installed methods and devices; show one of them.",
         GROUPS[4], "show proxy"),
        ("check", "plugins:check", "Test an installed method with the conformance kit.", GROUPS[4], "zncc"),
        ("cache", "cache:app", "Print the size of the cache of results; clear it.", GROUPS[4], "clear"),
    )
}  # fmt: skip

ELSEWHERE = {
    "doctor": "devices doctor", "info": "describe", "convert": "export", "print": "export", "view": "ui",
    "open": "ui", "show": "ui", "help": "--help", "version": "--version", "init": "new", "validate": "plan",
}  # fmt: skip
"""Commands by the words that other programs have for them."""


def add(name: str, place: str, summary: str, group: str = GROUPS[-1], example: str = "") -> None:
    """Add a command that is imported when it is called; a name that is taken stays with its first owner.

    place: `package.module:name` of its function, or of its group of commands. summary: the first line of its help.
    group: one of GROUPS. example: a call, for its help.
    """
    COMMANDS.setdefault(name, Command(place, summary, group, example))


_checked: WeakSet[Callable[..., Any]] = WeakSet()  # what `check_paths` has wrapped


class LazyGroup(TyperGroup):
    """The group of all commands; listing them imports none."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.commands: MutableMapping[str, Any] = _Commands(dict(self.commands))

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names, in the order of the help."""
        return list(self.commands)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Suggest a command for a word by which other programs call theirs."""
        if args and args[0] not in self.commands and (meant := ELSEWHERE.get(args[0])):
            ctx.fail(f"No such command '{args[0]}'. Did you mean '{meant}'?")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the summaries in full, however narrow the terminal is."""
        groups = {name: COMMANDS[name].group if name in COMMANDS else GROUPS[-1] for name in self.commands}
        for group in GROUPS:
            if rows := [(name, _summary(name, self.commands)) for name in groups if groups[name] == group]:
                with formatter.section(group):
                    formatter.write_dl(rows)


class _Commands(MutableMapping[str, Any]):
    """Commands by name; those of COMMANDS are imported on access."""

    def __init__(self, others: dict[str, Any]) -> None:
        self.others = others  # of plugins; none replaces a command of COMMANDS

    def __getitem__(self, name: str) -> Any:
        return load(name) if name in COMMANDS else self.others[name]

    def __setitem__(self, name: str, command: Any) -> None:
        self.others[name] = command

    def __delitem__(self, name: str) -> None:
        del self.others[name]

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys((*COMMANDS, *self.others)))

    def __len__(self) -> int:
        return sum(1 for _ in self)


@cache
def load(name: str) -> Any:
    """Import one of COMMANDS."""
    module, _, attribute = COMMANDS[name].place.partition(":")
    command = getattr(import_module(module), attribute)
    app = command if isinstance(command, typer.Typer) else typer.Typer(rich_markup_mode=None, add_completion=False)
    if app is not command:
        app.command(name)(command)
    check_paths(app)
    for entry in _all_commands(app):
        entry.callback = entry.callback and standard_output.protect()(entry.callback)
    result = typer.main.get_command(app)
    for command in getattr(result, "commands", {}).values():  # their first sentences in full, not cut with "..."
        command.short_help = " ".join((command.help or "").partition("\n\n")[0].split()).removesuffix(".")
    result.epilog = COMMANDS[name].example and f"{localise('Example:')} {COMMANDS[name].example}"
    return result


def check_paths(app: typer.Typer) -> None:
    """Let every command of a group refuse a path that no file can have; one that is checked stays as it is."""
    for command in _all_commands(app):
        if command.callback and command.callback not in _checked:
            command.callback = _check_paths(command.callback)
            _checked.add(command.callback)


def _check_paths(command: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap a command so that `~` is a home folder also where a shell leaves it, as in --out=~/maps."""

    @wraps(command)
    def run(**options: Any) -> Any:
        return command(**{name: _as_paths(value) for name, value in options.items()})

    return run


def _as_paths(value: Any) -> Any:
    if isinstance(value, list):
        return [_as_paths(item) for item in cast("list[Any]", value)]
    return as_path(value) if isinstance(value, Path) else value


def _all_commands(group: typer.Typer) -> Iterator[CommandInfo | TyperInfo]:
    yield from group.registered_commands
    yield from filter(None, [group.registered_callback])
    for group_info in group.registered_groups:
        if group_info.typer_instance:
            yield from _all_commands(group_info.typer_instance)


def _summary(name: str, commands: MutableMapping[str, Any]) -> str:
    text = COMMANDS[name].summary if name in COMMANDS else (commands[name].help or "").partition("\n")[0]
    return text.removesuffix(".")

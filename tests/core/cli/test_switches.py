"""Switches of all commands."""

from collections.abc import Iterator
from itertools import chain

import typer

from tangible_core.cli.app import app
from tangible_core.cli.command_table import COMMANDS, load
from tangible_core.plugins import hooks
from tangible_core.plugins.registry import default_registry


def commands(group, name: str) -> Iterator[tuple[str, object]]:
    if hasattr(group, "list_commands"):
        context = typer.Context(group)
        for each in group.list_commands(context):
            yield from commands(group.get_command(context, each), f"{name} {each}")
    else:
        yield name, group


def test_switches_of_commands_are_off_but_for_the_one_that_can_be_turned_off():
    hooks.tell(default_registry().plugins, "tangible_commands", app=app)
    on, switches = [], 0
    for name, command in chain.from_iterable(commands(load(each), each) for each in COMMANDS):
        for each in command.params:
            if getattr(each, "is_flag", False) and each.name != "help":
                switches += 1
                on += [f"{name} {each.opts[0]}"] if each.default else []
    assert switches > 40
    assert on == ["ui --browser"], "which `--no-browser` turns off"

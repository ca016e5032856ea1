"""Paths on the command line. Otherwise a name that no file can have would end a command with a traceback."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer

from tangible_core.cli.app import app
from tangible_core.cli.command_table import COMMANDS, check_paths, load
from tangible_core.errors import ConfigError
from tangible_core.plugins import hooks
from tangible_core.plugins.registry import default_registry

TOO_LONG = "a" * 300 + ".jpg"

hooks.tell(default_registry().plugins, "tangible_commands", app=app)


def leaves(words: tuple[str, ...], command: Any) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield the commands below one, each with its words."""
    below = getattr(command, "commands", {})
    if not below:
        yield words, command
    for name, each in below.items():
        yield from leaves((*words, name), each)


def calls(name: str) -> Iterator[list[str]]:
    """Yield a call for each argument and option that takes a path, with the path in it, and what else is needed."""
    for words, command in leaves((), load(name)):
        for path in command.params:
            if "pathlib.Path" in str(path.type_descriptor):
                yield [*words, *(word for param in command.params for word in given(param, path))]


def given(parameter: Any, path: Any) -> list[str]:
    """Return what a call says of a parameter: the long path, or "x" where something must stand."""
    if parameter is not path and not parameter.required:
        return []
    value = TOO_LONG if parameter is path else "x"
    return [value] if parameter.param_type_name == "argument" else [parameter.opts[0], value]


def test_every_path_of_every_command_is_refused_where_its_name_is_too_long():
    tried = [(name, call) for name in COMMANDS for call in calls(name)]
    assert len(tried) > 30
    for name, call in tried:
        with pytest.raises(ConfigError, match="at most 255 bytes; use a shorter one"):
            load(name).main(call, standalone_mode=False)


def test_command_that_a_plugin_adds_to_the_app_itself_has_its_paths_checked_once():
    seen: list[Path] = []
    group = typer.Typer()

    @group.command()
    def mine(file: Path) -> None:  # pyright: ignore[reportUnusedFunction] - typer calls it
        seen.append(file)

    for _ in range(2):
        check_paths(group)
    command = typer.main.get_command(group)
    command.main(["~"], standalone_mode=False)
    assert seen == [Path.home()]
    with pytest.raises(ConfigError, match="at most 255 bytes"):
        command.main([TOO_LONG], standalone_mode=False)

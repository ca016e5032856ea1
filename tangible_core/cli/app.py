"""`tangible ...`: its commands, what is said of a mistake, and the exit code."""

from __future__ import annotations

import argparse
import logging
import os
import sys
from typing import TYPE_CHECKING

import typer

from ..errors import ConfigError, TangibleError, exited, quoted, shown
from ..plugins import hooks
from ..plugins.registry import default_registry
from ..runtime import standard_output
from . import check, compare, devices, feel, materials, new, plugins, preflight, replay, run, schema
from .options import DONE, INTERRUPTED, MISTAKE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from typer.models import CommandInfo, TyperInfo

app = typer.Typer(
    name="tangible",
    help="Turn pictures into something one can feel: `tangible demo` shows all of it.",
    epilog="Anywhere: --log-level [LOGGER=]LEVEL (debug, info, warning, error; for all or one logger); "
    "-q, --quiet (no progress, warnings and errors only).",
    no_args_is_help=True,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # rich help costs more than all the rest of the start
)

for command in (
    *(run.demo, new.new, run.run, run.plan, feel.feel, replay.replay, preflight.preflight, compare.compare),
    *(plugins.plugins, schema.schema, check.check),
):
    app.command()(command)
app.add_typer(materials.app)
app.add_typer(devices.app)


def _ours(typed: typer.Typer) -> Iterator[CommandInfo | TyperInfo]:
    """Every command, and what is called before one."""
    yield from typed.registered_commands
    yield from filter(None, [typed.registered_callback])
    for group in typed.registered_groups:
        if group.typer_instance:
            yield from _ours(group.typer_instance)


for each in _ours(app):  # not those of others, added later: these write as they like
    each.callback = each.callback and standard_output.kept()(each.callback)


def main() -> None:
    """Entry point: one clear message for a user's mistake, and an exit code that says whose it is."""
    sys.exit(_guarded(lambda: _run_and_leave()))


def _run_and_leave() -> int:
    try:
        return _run_app()
    finally:
        standard_output.leave()


def _run_app() -> int:
    with standard_output.kept():
        words = _take_log_options(sys.argv[1:])
        hooks.tell(default_registry().plugins, "tangible_commands", app=app)
    try:
        code = app(words, standalone_mode=False, default_map=_no_help())
    except SystemExit as error:
        if isinstance(error.__context__, BrokenPipeError):  # typer's own answer to a reader that went away
            raise error.__context__ from None
        raise exited(error) from error
    if code == INTERRUPTED:  # typer answers Ctrl-C itself, without a word
        raise KeyboardInterrupt
    return code if isinstance(code, int) else DONE


def _no_help() -> dict[str, object]:
    """Say outright that --help is off: to make None a bool, typer would import pydantic, a third of the whole start."""
    names = [each.name or getattr(each.callback, "__name__", "") for each in app.registered_commands]
    return {"help": False, **{name: {"help": False} for name in names}}


def _take_log_options(words: list[str]) -> list[str]:
    """Obey --log-level and --quiet wherever they stand, and hand on the rest.

    As an option of typer's, one with a value would cost every command the import of pydantic.
    """
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--log-level", action="append", default=[])
    parser.add_argument("-q", "--quiet", action="store_true")
    known, rest = parser.parse_known_args(words)
    _set_logging(known.log_level)
    if known.quiet:
        default_registry().plugins.unregister(name="tangible-images/progress")
    return rest


def _guarded(work: Callable[[], int]) -> int:
    try:
        return work()
    except TangibleError as error:
        typer.echo(str(error), err=True)
        return MISTAKE
    except (KeyboardInterrupt, typer.Abort):
        typer.echo("interrupted; what was finished is kept", err=True)
        return INTERRUPTED
    except BrokenPipeError:  # the reader went away: `tangible plugins | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except typer.Exit as ended:
        return ended.exit_code
    except Exception as error:
        if (show := getattr(error, "show", None)) is None:  # typer's own complaints about the words of the call
            raise
        show()
        return MISTAKE


def _set_logging(levels: list[str]) -> None:
    logging.basicConfig(format="%(levelname)s %(name)s: %(message)s", level=logging.WARNING)
    for text in levels:
        name, _, level = text.rpartition("=")
        number = logging.getLevelNamesMapping().get(level.upper())
        if number is None:
            raise ConfigError(
                f"--log-level {shown(text)}: no level is named {quoted(level)}; use debug, info, warning or error"
            )
        logging.getLogger(name or None).setLevel(number)

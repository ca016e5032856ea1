"""`tangible ...`: its commands, what is said of a mistake, and the exit code."""

from __future__ import annotations

import argparse
import logging
import os
import sys
from functools import wraps
from pathlib import Path
from traceback import walk_tb
from typing import TYPE_CHECKING, Any

import typer

from ..errors import ConfigError, TangibleError, exited, quoted, shown
from ..files.paths import as_path
from ..plugins import hooks
from ..plugins.registry import default_registry
from ..runtime import ending, standard_output
from . import check, compare, devices, feel, materials, plugins, preflight, replay, run, schema
from .options import DONE, FAILED, INTERRUPTED, MISTAKE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from typer.models import CommandInfo, TyperInfo

ENDED_BY = 128
"""With the number of a signal: the exit code of a program that one has ended, as shells have it."""

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
    *(run.demo, run.run, run.plan, feel.feel, replay.replay, preflight.preflight, compare.compare),
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


def _at_home(command: Callable[..., Any]) -> Callable[..., Any]:
    """What a shell leaves of `~`, as in --out=~/maps, is a home here too."""

    @wraps(command)
    def called(**options: Any) -> Any:
        return command(
            **{name: as_path(value) if isinstance(value, Path) else value for name, value in options.items()}
        )

    return called


for each in _ours(app):  # not those of others, added later: these write as they like
    each.callback = each.callback and standard_output.kept()(_at_home(each.callback))


def main() -> None:
    """Entry point: one clear message for a user's mistake, and an exit code that says whose it is."""
    with ending.as_ctrl_c():
        try:
            code = _guarded(_run_and_leave)
        except KeyboardInterrupt:  # while the last words were said
            code = INTERRUPTED
        asked = ending.asked_by()
    sys.exit(code if asked is None else ENDED_BY + asked)


def _run_and_leave() -> int:
    try:
        _check_folder()
        return _run_app()
    finally:
        standard_output.leave()


def _check_folder() -> None:
    """Raises: ConfigError if there is no current folder: nothing that is relative to it could be found."""
    try:
        os.getcwd()  # noqa: PTH109 - pathlib is not needed for it
    except FileNotFoundError as error:
        raise ConfigError("the current folder was deleted; go to one that exists, such as by `cd`") from error


def _run_app() -> int:
    with standard_output.kept():
        words = _take_log_options(sys.argv[1:])
        hooks.tell(default_registry().plugins, "tangible_commands", app=app)
    try:
        code = app(words, standalone_mode=False, default_map=_no_help())
    except OSError as error:
        if not isinstance(error, BrokenPipeError) and _in_typer(error):
            raise standard_output.give_up(error) from error
        raise
    except SystemExit as error:
        if isinstance(error.__context__, BrokenPipeError):  # typer's own answer to a reader that went away
            raise error.__context__ from None
        raise exited(error) from error
    if code == INTERRUPTED:  # typer answers Ctrl-C itself, without a word
        raise KeyboardInterrupt
    return code if isinstance(code, int) else DONE


def _in_typer(error: OSError) -> bool:
    """Whether it was raised where typer writes, such as the words of `--help`."""
    *_, (frame, _) = walk_tb(error.__traceback__)
    return str(frame.f_globals.get("__name__")).startswith("typer.")


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
        return _said(str(error), MISTAKE)
    except (KeyboardInterrupt, typer.Abort):
        asked = ending.asked_by()
        return _said(f"{f'ended by {asked.name}' if asked else 'interrupted'}; what was finished is kept", INTERRUPTED)
    except BrokenPipeError:  # the reader went away: `tangible plugins | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except typer.Exit as ended:
        return ended.exit_code
    except BaseException as error:  # noqa: BLE001 - whatever a plugin raises
        return _unforeseen(error)


def _unforeseen(error: BaseException) -> int:
    """A fault that is nobody's mistake at the keyboard, or what typer has to say of the words of the call."""
    if (show := getattr(error, "show", None)) is not None:
        return _said(show, MISTAKE)
    from ..plugins import failures

    return _said(failures.sentence(error), FAILED if failures.place_of(error) is None else MISTAKE)


def _said(what: str | Callable[[], None], code: int) -> int:
    """Say it on standard error, which may be full or gone, and return the code."""
    try:
        what() if callable(what) else typer.echo(what, err=True)
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())
    return code


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

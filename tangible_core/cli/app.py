"""`tangible ...`: its commands, what is said of a mistake, and the exit code."""

from __future__ import annotations

import os
import sys
from traceback import walk_tb
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import ConfigError, TangibleError, exited
from ..plugins import hooks
from ..plugins.registry import default_registry
from ..runtime import ending, standard_output
from . import verbosity
from .command_table import COMMANDS, Lazy
from .options import DONE, FAILED, INTERRUPTED, MISTAKE

if TYPE_CHECKING:
    from collections.abc import Callable

ENDED_BY = 128
"""With the number of a signal: the exit code of a program that one has ended, as shells have it."""

app = typer.Typer(
    name="tangible",
    cls=Lazy,
    help="Turn pictures into something one can feel: `tangible demo` shows all of it.",
    epilog="Anywhere: --log-level [LOGGER=]LEVEL (debug, info, warning, error; for all or one logger); "
    "-q, --quiet (nothing but what was asked for, warnings and errors).",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # rich help costs more than all the rest of the start
)


def _say_version(wanted: bool) -> bool:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"tangible {version('tangible-images')}")
        raise typer.Exit
    return wanted


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_say_version, is_eager=True, help="Say which version this is.")
    ] = False,
) -> None:
    """What stands before a command."""


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
        words = verbosity.heed(sys.argv[1:])
        hooks.tell(default_registry().plugins, "tangible_commands", app=app)
    try:
        code = app(words, standalone_mode=False, default_map=_no_help())
    except OSError as error:
        if not isinstance(error, BrokenPipeError) and _in_typer(error):
            raise standard_output.give_up(error) from error
        raise
    except SystemExit as error:
        if _in_typer(error):  # of completion, which is said or installed
            return int(error.code or DONE)
        if isinstance(error.__context__, BrokenPipeError):  # typer's own answer to a reader that went away
            raise error.__context__ from None
        raise exited(error) from error
    if code == INTERRUPTED:  # typer answers Ctrl-C itself, without a word
        raise KeyboardInterrupt
    return code if isinstance(code, int) else DONE


def _in_typer(error: BaseException) -> bool:
    """Whether it was raised by typer, such as where it writes the words of `--help`."""
    *_, (frame, _) = walk_tb(error.__traceback__)
    return str(frame.f_globals.get("__name__")).partition(".")[0] == "typer"


def _no_help() -> dict[str, object]:
    """Say outright what is off: to make None a bool, typer would import pydantic, a third of the whole start."""
    names = [each.name or getattr(each.callback, "__name__", "") for each in app.registered_commands]
    off = dict.fromkeys(("help", "install_completion", "show_completion"), False)
    return {**off, **{name: {"help": False} for name in (*COMMANDS, *names)}}


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

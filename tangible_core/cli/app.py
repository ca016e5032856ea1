"""`tangible ...`: its commands, what is said of a mistake, and the exit code."""

from __future__ import annotations

import os
import sys
from traceback import walk_tb
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import TangibleError, exited
from ..plugins import hooks
from ..plugins.registry import default_registry
from ..runtime import ending, standard_output
from . import loudness
from .commands import COMMANDS, Lazy
from .options import DONE, INTERRUPTED, MISTAKE

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
        code = _guarded(_run_and_leave)
        asked = ending.asked_by()
    sys.exit(code if asked is None else ENDED_BY + asked)


def _run_and_leave() -> int:
    try:
        return _run_app()
    finally:
        standard_output.leave()


def _run_app() -> int:
    with standard_output.kept():
        words = loudness.heed(sys.argv[1:])
        hooks.tell(default_registry().plugins, "tangible_commands", app=app)
    try:
        code = app(words, standalone_mode=False, default_map=_no_help())
    except SystemExit as error:
        if _is_typers(error):  # of completion, which is said or installed
            return int(error.code or DONE)
        if isinstance(error.__context__, BrokenPipeError):  # typer's own answer to a reader that went away
            raise error.__context__ from None
        raise exited(error) from error
    if code == INTERRUPTED:  # typer answers Ctrl-C itself, without a word
        raise KeyboardInterrupt
    return code if isinstance(code, int) else DONE


def _is_typers(error: SystemExit) -> bool:
    (*_, (frame, _)) = walk_tb(error.__traceback__)
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

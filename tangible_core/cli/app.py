"""The command `tangible`: its subcommands, the messages for mistakes, and the exit code."""

from __future__ import annotations

import atexit
import gc
import os
import sys
from io import StringIO
from traceback import walk_tb
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import ConfigError, TangibleError, exit_error
from ..plugins import hooks
from ..plugins.registry import default_registry
from ..runtime import signals, standard_output
from ..translation import LANGUAGES, language, localise
from .command_table import COMMANDS, LazyGroup, check_paths, load
from .options import DONE, FAILED, INTERRUPTED, MISTAKE, parse_verbosity

if TYPE_CHECKING:
    from collections.abc import Callable

ENDED_BY = 128  # the exit code of a program that a signal has ended, less the signal's number

app: typer.Typer = typer.Typer(
    name="tangible",
    cls=LazyGroup,
    help="Turn pictures into something one can feel: `tangible demo` shows all of it.",
    epilog="Anywhere: --log-level [LOGGER=]LEVEL (debug, info, warning, error; for all or one logger); "
    "-q, --quiet (only requested output, warnings and errors); --plain (no progress line, no colours); "
    "--lang (en, de, fr; by default that of the environment).",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # rich help costs more than all the rest of the start
)


def _print_version(wanted: bool) -> bool:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"tangible {version('tangible-images')}")
        raise typer.Exit
    return wanted


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Accept the options that stand before a command."""


def main() -> None:
    """Run the command line: one clear message for a user's mistake, and an exit code that tells whose fault it is."""
    gc.set_threshold(10_000)  # Python's 700 would look through what each import brings, many times
    atexit.register(gc.freeze)  # the process gives all memory back: no cycle must be found in it first
    with signals.end_as_ctrl_c():
        try:
            code = _exit_code(_run_and_leave)
        except KeyboardInterrupt:  # during the last message
            code = INTERRUPTED
        signal = signals.received_signal()
    sys.exit(code if signal is None else ENDED_BY + signal)


def _run_and_leave() -> int:
    try:
        _check_folder()
        return _run_app()
    finally:
        standard_output.leave()


def _check_folder() -> None:
    """Raise a ConfigError if the current folder does not exist: relative paths would lead nowhere."""
    try:
        os.getcwd()  # noqa: PTH109 - pathlib is not needed for it
    except FileNotFoundError as error:
        raise ConfigError("the current folder was deleted; go to one that exists, such as by `cd`") from error


def _run_app() -> int:
    with standard_output.protect():
        words = parse_verbosity(sys.argv[1:])
        if language() != LANGUAGES[0]:
            from .help_text import localise_help

            localise_help()
        hooks.tell(default_registry().plugins, "tangible_commands", app=app)
        check_paths(app)
    names = [command.name or getattr(command.callback, "__name__", "") for command in app.registered_commands]
    # False for typer's own flags: to convert None, typer would import pydantic, a third of the start
    off = dict.fromkeys(("help", "install_completion", "show_completion"), False)
    off |= {name: {"help": False} for name in (*COMMANDS, *names)}
    try:
        code = app(words, standalone_mode=False, default_map=off)
    except OSError as error:
        if not isinstance(error, BrokenPipeError) and _in_typer(error):
            raise standard_output.give_up(error) from error
        raise
    except SystemExit as error:
        if _in_typer(error):  # after it printed or installed completion
            return int(error.code or DONE)
        if isinstance(error.__context__, BrokenPipeError):  # typer's own answer to a reader that went away
            raise error.__context__ from None
        raise exit_error(error) from error
    if code == INTERRUPTED:  # typer answers Ctrl-C itself, without a message
        raise KeyboardInterrupt
    return code if isinstance(code, int) else DONE


def _in_typer(error: BaseException) -> bool:
    *_, (frame, _) = walk_tb(error.__traceback__)
    return str(frame.f_globals.get("__name__")).partition(".")[0] == "typer"


def _exit_code(work: Callable[[], int]) -> int:
    try:
        return work()
    except TangibleError as error:
        return _report(str(error), MISTAKE)
    except (KeyboardInterrupt, typer.Abort):
        signal = signals.received_signal()
        cause = f"ended by {signal.name}" if signal else "interrupted"
        return _report(f"{cause}; what was finished is kept", INTERRUPTED)
    except BrokenPipeError:  # the reader went away: `tangible plugins | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except typer.Exit as ended:
        return ended.exit_code
    except BaseException as error:  # noqa: BLE001 - whatever a plugin raises
        return _report_unexpected(error)


def _report_unexpected(error: BaseException) -> int:
    """Report typer's error about the words of the call, or a fault of the program or a plugin."""
    if better := _about_option(error):
        return _report(better, MISTAKE)
    if (show := getattr(error, "show", None)) is not None:
        show(text := StringIO())
        plain = text.getvalue().replace("Value error, ", "").replace(", unable to parse string as a number", "")
        return _report(plain.rstrip(), MISTAKE)
    from ..plugins import failures

    explained = failures.find_place(error) or failures.missing_package(error) or failures.lacks_memory(error)
    return _report(failures.sentence(error), MISTAKE if explained else FAILED)


def _about_option(error: BaseException) -> str:
    """Return a sentence about an option without its value, or a key of the file as an option; "" for another error."""
    option, message = (str(getattr(error, name, "")) for name in ("option_name", "message"))
    command = next((word for word in sys.argv[1:] if word in COMMANDS), "")
    parameters: list[Any] = load(command).params if option and command else []  # its import may be what failed
    if "requires an argument" in message:
        takes = next(
            (f" {parameter.metavar or 'VALUE'}" for parameter in parameters if option in parameter.opts), " VALUE"
        )
        return f"{option}: has nothing after it; write what it takes, as `tangible {command} {option}{takes}`"
    if not message.startswith("No such option") or not any("--set" in parameter.opts for parameter in parameters):
        return ""
    from ..pipeline.config.model import PipelineConfig

    if (key := option.lstrip("-").replace("-", "_")) not in PipelineConfig.model_fields:
        return ""
    return f"{option}: no such option, but a key of the pipeline file; write `tangible {command} --set {key}=VALUE`"


def _report(message: str, code: int) -> int:
    try:
        typer.echo(localise(message), err=True)
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())
    return code

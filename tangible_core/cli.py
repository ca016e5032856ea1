"""`tangible ...`: the command line. What a command does stands in `commands`, imported when it is called."""

from __future__ import annotations

import argparse
import logging
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .cli_devices import devices_app
from .cli_materials import materials_app
from .cli_options import DONE, FAILED, INTERRUPTED, MISTAKE, Config, Json, NoCache, Out, Seconds, Sets
from .errors import ConfigError, TangibleError, exited, quoted, shown
from .plugins import hooks
from .plugins.registry import KIND_NAMES, default_registry
from .runtime import standard_output

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

app.add_typer(materials_app)
app.add_typer(devices_app)


@app.command()
def demo(
    out: Annotated[Path, typer.Option("--out", help="Folder for results.")] = Path("out/demo"),
    seconds: Seconds = 8.0,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Make the embedded example tangible: a stereo pair with ground truth, end to end."""
    from .commands import run as command

    command.demo(out, seconds, as_json, not no_cache)


@app.command()
def run(
    config: Config,
    sets: Sets = None,
    out: Out = None,
    seconds: Seconds = 8.0,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Make what a pipeline file wants, and a report of it. Never moves a motor: see `feel`."""
    from .commands import run as command

    command.run(config, sets or [], out, seconds, as_json, not no_cache)


@app.command()
def plan(config: Config, sets: Sets = None, as_json: Json = False, no_cache: NoCache = False) -> None:
    """Say what `run` would do, and why; runs nothing."""
    from .commands import run as command

    command.plan(config, sets or [], as_json, not no_cache)


@app.command()
def feel(
    config: Config,
    sets: Sets = None,
    seconds: Seconds = 8.0,
    record: Annotated[Path | None, typer.Option(help="Keep every tick in this file (.nc, .npz or .csv).")] = None,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Feel a pipeline's surface on its device."""
    from .commands import feel as command

    command.feel(config, sets or [], seconds, record, as_json, not no_cache)


@app.command()
def replay(
    recording: Annotated[Path, typer.Argument(help="What was felt (.nc, .npz or .csv).", show_default=False)],
    config: Config,
    sets: Sets = None,
    record: Annotated[Path | None, typer.Option(help="Keep every tick in this file (.nc, .npz or .csv).")] = None,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Feel a recording again through a pipeline's renderer, and compare the forces."""
    from .commands import replay as command

    command.replay(recording, config, sets or [], record, as_json, not no_cache)


@app.command()
def preflight(
    config: Config,
    sets: Sets = None,
    seconds: Annotated[float, typer.Option(help="How long this machine's lateness is measured.")] = 2.0,
    rate: Annotated[float, typer.Option(help="Ticks a second of the force loop.")] = 1000.0,
    speed: Annotated[float, typer.Option(help="Of the hand's stroke, metres a second.")] = 0.12,
    press: Annotated[float, typer.Option(help="Of the hand, newtons.")] = 3.0,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Say what is safe and what will be felt, before a motor moves; exit 1 if something is unsafe."""
    from .commands import preflight as command

    hand, loop = command.Hand(speed, press), command.Loop(rate, seconds)
    if not command.preflight(config, sets or [], hand, loop, as_json, not no_cache):
        raise typer.Exit(FAILED)


@app.command()
def compare(
    config: Annotated[
        Path, typer.Argument(help="A comparison file (YAML), or results (.jsonl) to show again.", show_default=False)
    ],
    sets: Sets = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for results [default: as the file says].")] = None,
    against: Annotated[
        Path | None, typer.Option(help="Earlier results (.jsonl): exit 1 if something got worse.")
    ] = None,
    detail: Annotated[bool, typer.Option("--detail", help="A table for each scene, with every measure.")] = False,
    retry: Annotated[bool, typer.Option("--retry", help="Measure once more what failed before.")] = False,
    as_json: Json = False,
) -> None:
    """Compare methods: time, memory and error on the same scenes; goes on where it was interrupted."""
    from .commands import compare as command

    if not command.compare(config, sets or [], out, against, detail, retry, as_json):
        raise typer.Exit(FAILED)


@app.command()
def plugins(as_json: Json = False) -> None:
    """List the installed methods and devices; imports none of them."""
    from .commands import plugins as command

    command.plugins(as_json)


@app.command()
def schema(
    markdown: Annotated[bool, typer.Option("--markdown", help="A reference page instead of JSON Schema.")] = False,
    installed: Annotated[bool, typer.Option("--installed", help="Third parties' methods too.")] = False,
    materials: Annotated[bool, typer.Option("--materials", help="Of files of materials instead.")] = False,
) -> None:
    """Print the JSON Schema of pipeline files, for completion in editors."""
    from .commands import schema as command

    if materials:
        command.schema_of_materials()
    else:
        command.schema(markdown, installed)


@app.command()
def check(
    kind: Annotated[str, typer.Argument(help=" | ".join(KIND_NAMES), show_default=False)],
    name: Annotated[str, typer.Argument(help="The method, as `tangible plugins` lists it.", show_default=False)],
    as_json: Json = False,
) -> None:
    """Run the conformance kit against an installed method; exit 1 if a check fails."""
    from .commands import check as command

    if not command.check(kind, name, as_json):
        raise typer.Exit(FAILED)


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

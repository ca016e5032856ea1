"""Options that several commands have, or that stand anywhere; the form of log messages; and the exit codes."""

from __future__ import annotations

import argparse
import logging
import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from ..errors import ConfigError, quoted, shown
from ..plugins.registry import default_registry
from ..translation import LANGUAGES, language_of_environment, localise, set_language
from . import completing

DONE, FAILED, MISTAKE, INTERRUPTED = 0, 1, 2, 130

Config = Annotated[
    Path,
    typer.Argument(
        metavar="FILE", help="Pipeline file (YAML), or a picture.", show_default=False, autocompletion=completing.scenes
    ),
]
ConfigOrPictures = Annotated[
    list[Path],
    typer.Argument(
        metavar="FILE...",
        help="Pipeline file (YAML), a picture, or left and right.",
        show_default=False,
        autocompletion=completing.scenes,
    ),
]
Sets = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY.KEY=VALUE", help="Set one value of the file; repeatable.", autocompletion=completing.keys
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON, for programs.")]
NoCache = Annotated[bool, typer.Option("--no-cache", help="Neither read nor write the cache of results.")]
Verbose = Annotated[
    bool, typer.Option("--verbose", "-v", help="Also list what became of each product, why, and all figures.")
]
Yes = Annotated[bool, typer.Option("--yes", "-y", help="Skip the confirmation when the depth map is unreliable.")]
Record = Annotated[Path | None, typer.Option(help="Save every tick to this file (.nc, .npz or .csv).")]


def ask(question: str, refusal: str, default: bool = False) -> None:
    """Ask a question on the terminal. Raises: ConfigError with the refusal if there is no terminal, Exit for a no."""
    if sys.stdin is None or not sys.stdin.isatty():
        raise ConfigError(refusal)
    if not typer.confirm(question, err=True, default=default):
        raise typer.Exit


def is_listing(group: str, subcommand: str | None, as_json: bool) -> bool:
    """Return True if a group is called without a subcommand. Raises: ConfigError for --json before a subcommand."""
    if subcommand and as_json:
        raise ConfigError(f"{group}: write --json after {subcommand!r}")
    return not subcommand


NOTICES = "tangible_core.compiled.compiling"  # shown to everybody: the reason why a first run takes longer

_quiet = [False]
_named_language = [""]


def parse_verbosity(words: list[str]) -> list[str]:
    """Apply --lang, --log-level, --plain and --quiet; return the other words. Raises: ConfigError."""
    set_language(language_of_environment(os.environ))
    # As an option of typer, --log-level would cost every command the import of pydantic.
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--log-level", action="append", default=[])
    parser.add_argument("--lang")
    parser.add_argument("--plain", action="store_true")
    parser.add_argument("-q", "--quiet", action="store_true")
    options, rest = parser.parse_known_args(words)
    if options.lang is not None:
        if options.lang not in LANGUAGES:
            raise ConfigError(f"--lang {shown(options.lang)}: is not one of {', '.join(LANGUAGES)}")
        set_language(options.lang)
        _named_language[0] = options.lang
    _set_logging(options.log_level, options.quiet)
    _quiet[0] = options.quiet
    if options.plain:
        os.environ["TERM"] = "dumb"  # rich then draws nothing that moves, and no colours
    if (options.quiet or options.plain) and (plugins := default_registry().plugins).has_plugin(
        "tangible-images/progress"
    ):
        plugins.unregister(name="tangible-images/progress")
    return rest


def named_language() -> str:
    """Return the language of `--lang`; empty where it is that of the environment."""
    return _named_language[0]


def is_quiet() -> bool:
    """Return True if only requested output, warnings and errors are printed."""
    return _quiet[0]


def _set_logging(levels: list[str], quiet: bool) -> None:
    handler = _ToStandardError()
    handler.setFormatter(logging.Formatter("%(levelname)s %(name)s: %(message)s") if levels else _Plain())
    logging.basicConfig(handlers=[handler], level=logging.WARNING)
    logging.getLogger(NOTICES).setLevel(logging.WARNING if quiet else logging.INFO)
    for text in levels:
        name, _, level = text.rpartition("=")
        number = logging.getLevelNamesMapping().get(level.upper())
        if number is None:
            raise ConfigError(
                f"--log-level {shown(text)}: no level is named {quoted(level)}; use debug, info, warning or error"
            )
        logging.getLogger(name or None).setLevel(number)


class _ToStandardError(logging.Handler):
    def emit(self, record: logging.LogRecord) -> None:
        try:
            sys.stderr.write(f"{self.format(record)}\n")
            sys.stderr.flush()
        except Exception:  # noqa: BLE001 - as every handler of logging
            self.handleError(record)


class _Plain(logging.Formatter):
    def format(self, record: logging.LogRecord) -> str:
        text = localise(super().format(record))
        return text if record.levelno <= logging.INFO else f"{localise(record.levelname.lower())}: {text}"

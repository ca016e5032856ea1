"""Options that stand anywhere: `--lang`, `--quiet`, `--log-level`; and the form of log messages."""

from __future__ import annotations

import argparse
import logging
import os

from ..errors import ConfigError, quoted, shown
from ..plugins.registry import default_registry
from ..translation import LANGUAGES, language_of_environment, localise, set_language

NOTICES = "tangible_core.compiled.compiling"
"""The logger whose information is shown to everybody: the reason why a first run takes longer."""

_quiet = [False]


def parse_verbosity(words: list[str]) -> list[str]:
    """Apply --lang, --log-level and --quiet wherever they stand among the words, and return the other words.

    As an option of typer, --log-level would cost every command the import of pydantic. Without --lang, the language is
    that of the environment. Raises: ConfigError for an unknown level or language.
    """
    set_language(language_of_environment(os.environ))
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--log-level", action="append", default=[])
    parser.add_argument("--lang")
    parser.add_argument("-q", "--quiet", action="store_true")
    options, rest = parser.parse_known_args(words)
    if options.lang is not None:
        if options.lang not in LANGUAGES:
            raise ConfigError(f"--lang {shown(options.lang)}: is not one of {', '.join(LANGUAGES)}")
        set_language(options.lang)
    _set_logging(options.log_level, options.quiet)
    _quiet[0] = options.quiet
    if options.quiet and (plugins := default_registry().plugins).has_plugin("tangible-images/progress"):
        plugins.unregister(name="tangible-images/progress")
    return rest


def is_quiet() -> bool:
    """Return True if only requested output, warnings and errors are printed."""
    return _quiet[0]


def _set_logging(levels: list[str], quiet: bool) -> None:
    handler = logging.StreamHandler()
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


class _Plain(logging.Formatter):
    """The format without --log-level: the message, after its level if it is a warning or an error."""

    def format(self, record: logging.LogRecord) -> str:
        text = localise(super().format(record))
        return text if record.levelno <= logging.INFO else f"{localise(record.levelname.lower())}: {text}"

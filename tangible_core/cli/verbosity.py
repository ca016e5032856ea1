"""How much the program says: `--quiet`, `--log-level`, and how what is logged looks."""

from __future__ import annotations

import argparse
import logging

from ..errors import ConfigError, quoted, shown
from ..plugins.registry import default_registry

NOTICES = "tangible_core.compiled.compiling"
"""What is logged as information, and yet is for everybody: why the first run takes longer."""

_quiet = [False]


def heed(words: list[str]) -> list[str]:
    """Obey --log-level and --quiet wherever they stand, and hand on the rest.

    As an option of typer's, one with a value would cost every command the import of pydantic.
    Raises: ConfigError for a level that is none.
    """
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--log-level", action="append", default=[])
    parser.add_argument("-q", "--quiet", action="store_true")
    known, rest = parser.parse_known_args(words)
    _set_logging(known.log_level, known.quiet)
    _quiet[0] = known.quiet
    if known.quiet and (plugins := default_registry().plugins).has_plugin("tangible-images/progress"):
        plugins.unregister(name="tangible-images/progress")
    return rest


def is_quiet() -> bool:
    """Whether nothing is said of what went well: only what was asked for, warnings and errors."""
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
    """For who asked for no log: a sentence, and before it whether it is a warning or an error."""

    def format(self, record: logging.LogRecord) -> str:
        said = super().format(record)
        return said if record.levelno <= logging.INFO else f"{record.levelname.lower()}: {said}"

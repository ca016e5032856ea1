"""Help and usage in the language of the terminal: what typer writes, translated where it is formatted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import typer

from ..translation import localise


def localise_help() -> None:
    """Have typer format help in the language of the terminal."""
    owner: Any = next(kind for kind in typer.Context.__mro__ if "formatter_class" in vars(kind))
    if not getattr(owner.formatter_class, "localised", False):
        owner.formatter_class = _localise(owner.formatter_class)


def _localise(base: Any) -> type:
    class Formatter(base):
        localised = True

        def write_usage(self, prog: str, args: str = "", prefix: str | None = None) -> None:
            base.write_usage(self, prog, args, localise(prefix or "Usage: "))

        def write_heading(self, heading: str) -> None:
            base.write_heading(self, localise(heading))

        def write_text(self, text: str) -> None:
            base.write_text(self, localise(text))

        def write_dl(self, rows: Sequence[tuple[str, str]], *args: Any, **options: Any) -> None:
            base.write_dl(self, [(name, localise(text)) for name, text in rows], *args, **options)

    return Formatter

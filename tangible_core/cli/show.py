"""How results look on a terminal, and as JSON."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from ..runtime.standard_output import stream

if TYPE_CHECKING:
    from ..data import Outcome

COLOURS = {"given": "blue", "ran": "green", "cached": "cyan", "skipped": "dim", "failed": "red", "refused": "red"}


def print_json(value: Any) -> None:
    """JSON on standard output; NaN becomes null."""
    from ..report.figures import as_json

    print(as_json(value), file=stream())


def console(**options: Any) -> Console:
    """Of the program's own standard output, as wide as the terminal where that is one."""
    own = stream()
    if own is not None and own.isatty() and "COLUMNS" not in os.environ:
        options["width"] = os.get_terminal_size(own.fileno()).columns or None
    return Console(file=own, **options)


def flush() -> None:
    """Let the results come before what is said next on standard error."""
    if (own := stream()) is not None:
        own.flush()


def table(headings: Sequence[str], rows: Iterable[Sequence[str]], title: str | None = None) -> None:
    """A table without frames; numbers are the caller's to format."""
    shown = Table(*headings, title=title, title_justify="left", box=None, pad_edge=False, header_style="bold")
    for row in rows:
        shown.add_row(*row)
    console().print(shown)


def outcomes(found: Iterable[Outcome], title: str | None = None, ran: str = "ran") -> None:
    """What became of each product, and why; `ran` is the word for those that ran, or are to."""
    rows = [
        (
            each.product,
            each.method,
            f"[{COLOURS[each.outcome]}]{ran if each.outcome == 'ran' else each.outcome}[/]",
            escape(each.why),
            f"{each.seconds:.3f}" if each.seconds else "",
        )
        for each in found
    ]
    table(("product", "method", "outcome", "why", "seconds"), rows, title)


def as_rows(found: Iterable[Outcome]) -> list[dict[str, Any]]:
    """Outcomes as plain values."""
    return [asdict(each) for each in found]


def say(text: str) -> None:
    """A line of text, with rich's marks."""
    console(highlight=False, soft_wrap=True).print(text)


def plain(text: str) -> None:
    """A text as it stands, to be copied: no marks, no folding."""
    console(highlight=False, soft_wrap=True).print(text, markup=False)


def note(text: str) -> None:
    """A line of text for people, beside the results: on standard error."""
    Console(stderr=True, highlight=False, soft_wrap=True).print(text, markup=False)

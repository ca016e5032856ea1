"""How results look on a terminal, and as JSON."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.markup import escape
from rich.measure import Measurement
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from ..runtime.standard_output import stream

if TYPE_CHECKING:
    from ..data import Outcome
    from ..session import PartFelt

COLOURS = {"given": "blue", "ran": "green", "cached": "cyan", "skipped": "dim", "failed": "red", "refused": "red"}


def print_json(value: Any) -> None:
    """JSON on standard output; NaN becomes null."""
    from ..files.json_text import as_json

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
    """A table without frames, or one entry a row where the terminal is too narrow; numbers are the caller's to format.

    No text is lost, however narrow it is: a word that is too long goes on in the next line.
    """
    shown = Table(title=title, title_justify="left", box=None, pad_edge=False, header_style="bold")
    for heading in headings:
        shown.add_column(heading, overflow="fold")
    cells = [tuple(row) for row in rows]
    for row in cells:
        shown.add_row(*row)
    drawn = console()
    if not is_narrow(drawn, shown):
        drawn.print(shown)
        return
    if title:
        drawn.print(f"{title}\n")
    entries(drawn, headings, cells)


def is_narrow(drawn: Console, shown: Table) -> bool:
    """Whether a table would break words, or crowd most of its text into a column of a few letters."""
    wanted = Measurement.get(drawn, drawn.options.update(max_width=WIDEST), shown)
    return wanted.minimum > drawn.width or wanted.maximum > MOST_FOLDS * drawn.width


WIDEST = 1000
MOST_FOLDS = 3
"""A table is at most so many times as wide as the terminal, were nothing folded."""


def entries(drawn: Console, headings: Sequence[str], rows: Iterable[Sequence[str | Text]]) -> None:
    """Each row as lines of `heading: cell` below its first cell."""
    for first, *others in rows:
        drawn.print(first, style="bold", highlight=False)
        for heading, cell in zip(headings[1:], others, strict=True):
            if cell:
                said = Text.from_markup(cell) if isinstance(cell, str) else cell
                drawn.print(Padding(Text.assemble(f"{heading}: " if heading else "", said), (0, 0, 0, 2)))


def entry(head: str, text: str) -> None:
    """A name, and what is to be said of it, indented; as they stand, without marks."""
    drawn = console(highlight=False)
    drawn.print(Text(head, style="bold"))
    drawn.print(Padding(Text(text), (0, 0, 0, 4)))


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


def parts_felt(found: Sequence[PartFelt]) -> None:
    """Which parts were touched, how long and how hard; nothing where there are none."""
    if found:
        say("")
        cells = [
            (
                str(each.number),
                escape(each.name),
                escape(each.material),
                f"{100 * each.share:.0f}",
                f"{each.peak_force_n:.2f}",
            )
            for each in found
        ]
        table(("part", "name", "material", "% of the contact", "peak N"), cells)


def as_rows(found: Iterable[Outcome]) -> list[dict[str, Any]]:
    """Outcomes as plain values."""
    return [asdict(each) for each in found]


def sentence(text: str) -> None:
    """What the lines below say, in plain words; folded between words."""
    console(highlight=False).print(text, "", markup=False, sep="\n")


def say(text: str) -> None:
    """A line of text, with rich's marks."""
    console(highlight=False, soft_wrap=True).print(text)


def plain(text: str) -> None:
    """A text as it stands, to be copied: no marks, no folding."""
    console(highlight=False, soft_wrap=True).print(text, markup=False)


def note(text: str) -> None:
    """A line of text for people, beside the results: on standard error."""
    Console(stderr=True, highlight=False, soft_wrap=True).print(text, markup=False)

"""The form of results on a terminal, and as JSON. Commands import this at once: rich is imported when it prints."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from ..runtime.standard_output import stream
from ..translation import localise, localise_marked

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    from ..data import Outcome
    from ..preflight import Verdict
    from ..session import PartFelt

COLOURS = {"given": "blue", "ran": "green", "cached": "cyan", "skipped": "dim", "failed": "red", "refused": "red"}


def print_json(value: Any) -> None:
    """Print JSON on standard output; NaN becomes null."""
    from ..files.json_text import as_json

    print(as_json(value), file=stream())


def console(**options: Any) -> Console:
    """Return a console on the program's own standard output, as wide as the terminal if it is one."""
    from rich.console import Console

    own = stream()
    if own is not None and own.isatty() and "COLUMNS" not in os.environ:
        options["width"] = os.get_terminal_size(own.fileno()).columns or None
    return Console(file=own, **options)


def flush() -> None:
    """Write out the results before a message follows on standard error."""
    if (own := stream()) is not None:
        own.flush()


def table(headings: Sequence[str], rows: Iterable[Sequence[str]], title: str | None = None, named: int = 0) -> None:
    """Print a table without frames, or an entry a row on a narrow terminal. named: columns of names to type."""
    from rich.table import Table
    from rich.text import Text

    headings, title = [localise(each) for each in headings], title and localise_marked(title)
    grid = Table(title=title, title_justify="left", box=None, pad_edge=False, header_style="bold")
    for heading in headings:
        grid.add_column(heading, overflow="fold")
    cells = [(*row[:named], *map(localise_marked, row[named:])) for row in rows]
    for row in cells:
        grid.add_row(*row)
    terminal = console()
    if not is_narrow(terminal, grid):
        terminal.print(grid)
        return
    if title:
        terminal.print(f"{title}\n")
    entries(terminal, headings, [(first, *map(Text.from_markup, rest)) for first, *rest in cells])  # translated once


def is_narrow(terminal: Console, grid: Table) -> bool:
    """Return True if a table would break words, or squeeze most of its text into a few letters a line."""
    from rich.measure import Measurement

    wanted = Measurement.get(terminal, terminal.options.update(max_width=WIDEST), grid)
    return wanted.minimum > terminal.width or wanted.maximum > MAX_FOLDS * terminal.width


WIDEST = 1000
MAX_FOLDS = 3  # of a table's unfolded width to that of the terminal


def entries(terminal: Console, headings: Sequence[str], rows: Iterable[Sequence[str | Text]]) -> None:
    """Print each row as lines of `heading: cell` below its first cell."""
    from rich.padding import Padding
    from rich.text import Text

    for first, *others in rows:
        terminal.print(first, style="bold", highlight=False)
        for heading, cell in zip(headings[1:], others, strict=True):
            if cell:
                text = Text.from_markup(localise_marked(cell)) if isinstance(cell, str) else cell
                terminal.print(Padding(Text.assemble(f"{localise(heading)}: " if heading else "", text), (0, 0, 0, 2)))


def entry(head: str, text: str) -> None:
    """Print a name and an indented text below it, both without marks."""
    from rich.padding import Padding
    from rich.text import Text

    terminal = console(highlight=False)
    terminal.print(Text(head, style="bold"))
    terminal.print(Padding(Text(localise(text)), (0, 0, 0, 4)))


def outcomes(rows: Iterable[Outcome], title: str | None = None, ran: str = "ran") -> None:
    """Print the outcome of each product, and the reason. ran: the word for products that ran, or will run."""
    from ..data.outcome import HEADINGS

    cells = [
        (product, method, f"[{COLOURS[row.outcome]}]{word}[/]", escape(_without_warnings(row, ran)), seconds)
        for row in rows
        for product, method, word, _, seconds in [row.row(ran)]
    ]
    table(HEADINGS, cells, title)


def _without_warnings(outcome: Outcome, ran: str) -> str:
    """Return the reason of an outcome; of a plan, which makes nothing, with the warnings."""
    why = outcome.why
    for each in outcome.notes if ran == "ran" else ():
        if each.kind != "decision":
            why = why.replace(f"; {each.text}", "", 1)
    return why


def parts_felt(parts: Sequence[PartFelt]) -> None:
    """Print which parts were touched, for how long and with which force; nothing if there are none."""
    from ..data.part_words import shown_number

    if parts:
        say("")
        cells = [
            (str(shown_number(part.number)), escape(part.name), escape(part.material), f"{100 * part.share:.0f}",
             f"{part.peak_force_n:.2f}")
            for part in parts
        ]  # fmt: skip
        table(("part", "name", "material", "% of the contact", "peak N"), cells)


def verdicts(
    heading: str, rows: Sequence[Verdict], colours: Mapping[str, str], widths: tuple[int, int], verbose: bool = False
) -> None:
    """Print verdicts with their cures below a heading, and how many there are of each grade."""
    say(f"{heading}\n")
    widths = (
        max(widths[0], *(len(localise(grade)) for grade in colours)),
        max(widths[1], *(len(localise(row.check)) for row in rows), 0),
    )
    lines = {verdict_line(row, colours, widths): row.verdict for row in rows}  # one for all segments of a material
    shown = [line for line, grade in lines.items() if verbose or grade != "ok"]
    for line in shown:
        say(line)
    grades = Counter(lines.values())
    more = " (--verbose lists them)" if grades["ok"] and not verbose else ""
    words = {"warn": "warning" if grades["warn"] == 1 else "warnings"}
    counts = ", ".join(f"{grades[one]} {words.get(one, one)}{more if one == 'ok' else ''}" for one in colours)
    say(f"\n{counts}" if shown else counts)


def verdict_line(verdict: Verdict, colours: Mapping[str, str], widths: tuple[int, int]) -> str:
    """Return a verdict as text with rich's marks, its cure on a line of its own."""
    from ..preflight import relation

    grade, check = widths
    stands = f"{localise(verdict.of)}: {localise(relation(verdict))}"
    text = "; ".join(filter(None, (stands, localise(verdict.note), localise(verdict.source))))
    cure = f"\n{'':>{grade + check + 2}}{localise('cure')}: {localise(verdict.cure)}" if verdict.cure else ""
    name, topic = localise(verdict.verdict), localise(verdict.check)
    return f"[{colours[verdict.verdict]}]{name:<{grade}}[/] {topic:<{check}} {escape(text + cure)}"


def escape(text: str) -> str:
    """Return a text in which nothing is one of rich's marks."""
    from rich import markup

    return markup.escape(text)


def as_rows(rows: Iterable[Outcome]) -> list[dict[str, Any]]:
    """Return outcomes as plain values."""
    return [asdict(row) for row in rows]


def sentence(text: str, apart: bool = True) -> None:
    """Print a summary, folded between words; apart: with an empty line before the lines below it."""
    console(highlight=False).print(localise(text), *[""] * apart, markup=False, sep="\n")


def say(text: str) -> None:
    """Print a line of text with rich's marks."""
    console(highlight=False, soft_wrap=True).print(localise_marked(text))


def plain(text: str) -> None:
    """Print a text that can be copied: without marks or folding."""
    console(highlight=False, soft_wrap=True).print(localise(text), markup=False)


def note(text: str) -> None:
    """Print a line for people on standard error, apart from the results."""
    from rich.console import Console

    Console(stderr=True, highlight=False, soft_wrap=True).print(localise(text), markup=False)

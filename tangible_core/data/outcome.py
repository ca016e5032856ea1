"""The plan of a pipeline, and the outcome of each product."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from typing import Literal

Kind = Literal["depth", "texture", "render", "device", "export"]
# The outcomes of a product; `refused`: known to be impossible for this scene before anything is run.
OutcomeKind = Literal["given", "ran", "cached", "skipped", "failed", "refused"]
HEADINGS = ("product", "method", "outcome", "why", "seconds")


NoteKind = Literal["decision", "warning", "doubt"]
"""The kinds of notes; `doubt`: the result is hardly worth feeling."""


@dataclass(frozen=True)
class Note:
    """An observation that a method made while it computed a product."""

    text: str
    kind: NoteKind = "decision"


@dataclass(frozen=True)
class Outcome:
    """The outcome of one product, and the reason."""

    product: str
    outcome: OutcomeKind
    why: str
    """The reason, including the texts of the notes."""
    method: str = ""
    seconds: float = 0.0
    notes: tuple[Note, ...] = ()
    """The notes of the method; for a cached product, those of the run that computed it."""

    def row(self, ran: str = "ran") -> tuple[str, ...]:
        """Return the texts under HEADINGS; ran: the word for a product that ran, or will run."""
        kind = ran if self.outcome == "ran" else self.outcome
        return self.product, self.method, kind, self.why, f"{self.seconds:.3f}" if self.seconds else ""


class Outcomes(list[Outcome]):
    """A list of outcomes that prints as a table, in a terminal and in a notebook."""

    @property
    def doubts(self) -> list[Note]:
        """The notes that say why the result is hardly worth feeling; [] if it is."""
        return [note for outcome in self for note in outcome.notes if note.kind == "doubt"]

    def __repr__(self) -> str:
        return text_table(HEADINGS, [outcome.row() for outcome in self])

    def _repr_html_(self) -> str:
        return html_table(HEADINGS, [outcome.row() for outcome in self])


@dataclass(frozen=True, repr=False)
class Plan:
    """The steps that lead to a requested product: one outcome for each product, in order; nothing is run.

    It ends with the first product that cannot be made. It prints as a table, in a terminal and in a notebook.
    """

    want: str
    steps: tuple[Outcome, ...]

    @property
    def refusal(self) -> str:
        """The reason why this cannot be run, as far as it is known beforehand; "" if it can."""
        return next((step.why for step in self.steps if step.outcome == "refused"), "")

    def __repr__(self) -> str:
        return text_table(HEADINGS[:-1], self._rows())

    def _repr_html_(self) -> str:
        return html_table(HEADINGS[:-1], self._rows())

    def _rows(self) -> list[Sequence[str]]:
        return [step.row(ran="to run")[:-1] for step in self.steps]


def text_table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return rows as a text table, with two spaces between the columns.

    >>> print(text_table(("product", "why"), [("relief", "requested")]))
    product  why
    relief   requested
    """
    lines = [headings, *rows]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    padded_lines = ("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) for line in lines)
    return "\n".join(line.rstrip() for line in padded_lines)


def html_table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return rows as an HTML table for a notebook; the cells are escaped."""
    head = "".join(f"<th style='text-align:left'>{escape(heading)}</th>" for heading in headings)
    lines = ("".join(f"<td style='text-align:left'>{escape(cell)}</td>" for cell in row) for row in rows)
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"

"""What a pipeline will do, and what became of its products."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from typing import Literal

Kind = Literal["depth", "texture", "render", "device", "export"]


OutcomeKind = Literal["given", "ran", "cached", "skipped", "failed", "refused"]
"""`refused`: it cannot be made of this scene, which is known before anything is begun."""
HEADINGS = ("product", "method", "outcome", "why", "seconds")


NoteKind = Literal["decision", "warning", "doubt"]
"""`doubt`: what was made is hardly worth feeling."""


@dataclass(frozen=True)
class Note:
    """What a method noticed while it made a product."""

    text: str
    kind: NoteKind = "decision"


@dataclass(frozen=True)
class Outcome:
    """What became of one product, and why."""

    product: str
    outcome: OutcomeKind
    why: str
    """The texts of the notes included."""
    method: str = ""
    seconds: float = 0.0
    notes: tuple[Note, ...] = ()
    """What was noticed when it was made; before, if it comes from the cache."""

    def row(self, ran: str = "ran") -> tuple[str, ...]:
        """Texts under HEADINGS; ran: the word for one that ran, or is to."""
        kind = ran if self.outcome == "ran" else self.outcome
        return self.product, self.method, kind, self.why, f"{self.seconds:.3f}" if self.seconds else ""


class Outcomes(list[Outcome]):
    """Outcomes that show themselves as a table, in a terminal and in a notebook."""

    @property
    def doubts(self) -> list[Note]:
        """Why what was made is hardly worth feeling; empty where it is."""
        return [note for each in self for note in each.notes if note.kind == "doubt"]

    def __repr__(self) -> str:
        return text_table(HEADINGS, [each.row() for each in self])

    def _repr_html_(self) -> str:
        return html_table(HEADINGS, [each.row() for each in self])


@dataclass(frozen=True, repr=False)
class Plan:
    """What asking for a product will do: one outcome a product, in order, nothing run.

    It ends with the first product that cannot be made. It shows itself as a table, in a terminal and in a notebook.
    """

    want: str
    steps: tuple[Outcome, ...]

    @property
    def refusal(self) -> str:
        """Why this cannot be run, as far as that is known beforehand; empty where it can."""
        return next((each.why for each in self.steps if each.outcome == "refused"), "")

    def __repr__(self) -> str:
        return text_table(HEADINGS[:-1], self._rows())

    def _repr_html_(self) -> str:
        return html_table(HEADINGS[:-1], self._rows())

    def _rows(self) -> list[Sequence[str]]:
        return [each.row(ran="to run")[:-1] for each in self.steps]


def text_table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Columns of one width each, two spaces between them.

    >>> print(text_table(("product", "why"), [("relief", "asked for")]))
    product  why
    relief   asked for
    """
    lines = [headings, *rows]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    shown = ("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) for line in lines)
    return "\n".join(line.rstrip() for line in shown)


def html_table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table for a notebook; what is in the cells is text."""
    head = "".join(f"<th style='text-align:left'>{escape(each)}</th>" for each in headings)
    lines = ("".join(f"<td style='text-align:left'>{escape(cell)}</td>" for cell in row) for row in rows)
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"

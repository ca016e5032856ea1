"""The result of an export: the files of each exporter, or the reason why there are none."""

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from ...data import Outcome, Outcomes
from ...data.outcome import HEADINGS, html_table, text_table
from ...preflight import Legibility


@dataclass(frozen=True, eq=False)
class Exported:
    """The files of one exporter, or the reason why there are none."""

    name: str
    """The exporter's name, with a number where it is listed twice."""
    outcome: Outcome
    """`ran`; `refused` for a work that cannot be written, with the cure in the message; `failed` for a fault of the
    exporter."""
    files: tuple[Path, ...] = ()
    made: Outcomes = field(default_factory=Outcomes)
    """The outcomes of the products that it needs."""
    legible: Legibility | None = None
    """The legibility for fingers; None for files that are not touched."""


@dataclass(frozen=True, eq=False, repr=False)
class Export:
    """The files of all exporters and their folder, shown as a table in a terminal and in a notebook."""

    folder: Path
    exports: tuple[Exported, ...]  # the exporters in the order of the request

    @property
    def files(self) -> dict[str, tuple[Path, ...]]:
        """The files of each exporter by its name; empty for an exporter that wrote none."""
        return {export.name: export.files for export in self.exports}

    @property
    def outcomes(self) -> Outcomes:
        """The outcome of each exporter."""
        return Outcomes(export.outcome for export in self.exports)

    def document(self) -> dict[str, Any]:
        """Return everything as plain values."""
        return {"folder": str(self.folder), "exports": [_as_data(export) for export in self.exports]}

    def __repr__(self) -> str:
        return text_table((*HEADINGS, "files"), self._rows())

    def _repr_html_(self) -> str:
        return html_table((*HEADINGS, "files"), self._rows())

    def _rows(self) -> list[tuple[str, ...]]:
        return [(*export.outcome.row(), ", ".join(path.name for path in export.files)) for export in self.exports]


def _as_data(each: Exported) -> dict[str, Any]:
    return {
        "name": each.name,
        "outcome": asdict(each.outcome),
        "files": [str(path) for path in each.files],
        "made": [asdict(outcome) for outcome in each.made],
        "legible": each.legible and each.legible.as_data(),
    }

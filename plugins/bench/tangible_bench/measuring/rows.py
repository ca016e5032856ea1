"""Results as JSON Lines: a row for each measurement, complete or absent."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, ClassVar

from pydantic import ConfigDict, TypeAdapter, ValidationError

from tangible_core.errors import ResultsError, shown
from tangible_core.files import JsonLines, read_lines


@dataclass(frozen=True)
class Row:
    """The result of one measurement."""

    __pydantic_config__: ClassVar = ConfigDict(extra="forbid", strict=True)  # for rows that are read from files

    key: str  # the hash of all that the result depends on: a measurement with the same key need not be repeated
    compare: str
    method: str
    use: str
    options: Mapping[str, Any]
    origin: str
    scene: str
    scene_digest: str
    perturb: str
    finishes: tuple[str, ...]
    repeat: int
    versions: Mapping[str, str]
    machine: Mapping[str, str | int]
    baseline: str | None = None  # the label of the method that times are compared with; not part of the key
    # The median of the timed calls; if a call does several pieces of work, the time of one. None after an error.
    seconds: float | None = None
    first_seconds: float | None = None  # the time of the very first call, with imports and compilation
    peak_memory_bytes: int | None = None
    measures: Mapping[str, float | None] = field(default_factory=dict[str, float | None])
    error: str | None = None

    @property
    def cell(self) -> tuple[str, str, str]:
        """Method, scene and perturbation, which all repeats share."""
        return self.method, self.scene, self.perturb


def read_rows(path: Path) -> dict[str, Row]:
    """Return the last row of each key, but for a torn last line, as a kill leaves it. Raises: ResultsError."""
    try:
        lines = list(read_lines(path))
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or error
        message = f"{path}: cannot be read as results: {why}; name a .jsonl file of `tangible compare`"
        raise ResultsError(message) from error
    rows = (_row(path, number, line) for number, line in lines)
    return {row.key: row for row in rows}


def mend(path: Path) -> None:
    """Make the file ready for more rows: create its folder, remove a torn last line. Raises: OutputError."""
    JsonLines(path).close()


def append(path: Path, row: Row) -> None:
    """Add a row in one write; it is on the disk when this returns. Raises: OutputError."""
    with JsonLines(path, sync_every_s=0.0) as file:
        file.add_row(asdict(row))


def _row(path: Path, number: int, line: str) -> Row:
    try:
        return _checker().validate_json(line)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        place = shown(".".join(map(str, first["loc"])))
        why = f"{place}: {first['msg']}" if place else first["msg"]
        raise ResultsError(f"{path}:{number}: is not a row of results: {why}; remove the line") from error


@cache
def _checker() -> TypeAdapter[Row]:
    return TypeAdapter(Row)

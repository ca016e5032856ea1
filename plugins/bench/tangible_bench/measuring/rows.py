"""Results as JSON Lines: one row a process, whole or not there at all."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, ClassVar

from pydantic import ConfigDict, TypeAdapter, ValidationError

from tangible_core.errors import ResultsError, shown
from tangible_core.files.json_lines import JsonLines, read_lines


@dataclass(frozen=True)
class Row:
    """What one process found out."""

    __pydantic_config__: ClassVar = ConfigDict(extra="forbid", strict=True)  # for what is read

    key: str
    """Content hash of what was measured: the same key need not be measured again."""
    compare: str
    method: str
    """The method's label."""
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
    baseline: str | None = None
    """Label of the method that times are compared with; no part of the key."""
    seconds: float | None = None
    """Median of the timed calls, of one piece of work where a call does several; None after an error."""
    first_seconds: float | None = None
    """The very first call: with imports, and compilation if there is any."""
    peak_memory_bytes: int | None = None
    measures: Mapping[str, float | None] = field(default_factory=dict[str, float | None])
    error: str | None = None
    """Why there is no result."""

    @property
    def cell(self) -> tuple[str, str, str]:
        """What its repeats share: method, scene, perturbation."""
        return self.method, self.scene, self.perturb


def read_rows(path: Path) -> dict[str, Row]:
    """Rows of a file by key, the last one of each; a torn last line, as a kill leaves it, is passed over.

    Raises: ResultsError for a file that cannot be read, or a damaged line within it.
    """
    try:
        lines = list(read_lines(path))
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or error
        raise ResultsError(
            f"{path}: cannot be read as results: {why}; name a .jsonl file of `tangible compare`"
        ) from error
    rows = (_row(path, number, line) for number, line in lines)
    return {row.key: row for row in rows}


def mend(path: Path) -> None:
    """Make sure that rows can be added: the folder is there, and a torn last line is not.

    Raises: OutputError if the file cannot be written.
    """
    JsonLines(path).close()


def append(path: Path, row: Row) -> None:
    """Add a row in one write, on the disk when this returns.

    Raises: OutputError if the file cannot be written.
    """
    with JsonLines(path, sync_every_s=0.0) as file:
        file.add(asdict(row))


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

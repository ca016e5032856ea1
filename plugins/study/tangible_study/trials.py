"""The table of a participant's answers: a line of a TSV file for each answered trial, as BIDS has behavioural data."""

from collections.abc import Iterable, Mapping
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from typing import Any, Self, final, get_args

from tangible_core.errors import ResultsError
from tangible_core.files import LineFile, read_table

MISSING = "n/a"  # the text of a missing value, as BIDS has it


@dataclass(frozen=True)
class Answer:
    """An answered trial: a line of the table, as `session/columns.json` describes it; None is a missing value."""

    trial: int
    phase: str
    comparison: str
    question: str
    procedure: str
    condition: str
    other: str | None = None
    level: float | None = None
    standard: float | None = None
    position: int | None = None
    response: str = ""
    chosen: int | None = None
    correct: int | None = None
    response_time: float = 0.0
    repeat: int = 0
    rendered: bool = True
    why: str | None = None
    recording: str | None = None
    target: str | None = None

    def line(self) -> str:
        """Return the line of the table, without its end."""
        return "\t".join(map(_text, astuple(self)))

    @classmethod
    def of(cls, cells: Mapping[str, str]) -> Self:
        """Read an answer from the cells of a line, by column. Raises: ValueError, KeyError."""
        return cls(**{field.name: _value(cells[field.name], field.type) for field in fields(cls)})


COLUMNS = tuple(field.name for field in fields(Answer))


def read_answers(path: Path) -> list[Answer]:
    """Read a table of answers, [] without one, but for a last line that a crash cut off. Raises: ResultsError."""
    try:
        columns, lines = read_table(path, appended=True)
        rows = list(lines)
    except FileNotFoundError:
        return []
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or error
        raise ResultsError(f"{path}: cannot be read as a table of answers: {why}; name another folder") from error
    if columns and (missing := [name for name in COLUMNS if name not in columns]):
        raise ResultsError(f"{path}:1: has no column {missing[0]}; name a table that `tangible study run` wrote")
    return list(_answers(path, rows))


def _answers(path: Path, rows: list[tuple[int, dict[str, str]]]) -> Iterable[Answer]:
    for number, cells in rows:
        try:
            yield Answer.of(cells)
        except (ValueError, KeyError) as error:
            raise ResultsError(f"{path}:{number}: is not an answer: {error}; correct the line") from error


IN_USE = "another program runs this participant; end that one first"


@final
class AnswerFile:
    """A table of answers that one process appends to: an answer is on the disk before `add` returns."""

    def __init__(self, path: Path) -> None:
        """Open the table, with its header if it is new. Raises: OutputError, also if another process writes it."""
        self._file = LineFile(path, in_use=IN_USE, header="\t".join(COLUMNS))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def add(self, answer: Answer) -> None:
        """Append an answer and wait until it is on the disk; it can be repeated. Raises: OutputError."""
        self._file.add(answer.line())


def _text(value: Any) -> str:
    if value is None or value == "":
        return MISSING
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value) if isinstance(value, float) else " ".join(str(value).split())


def _value(text: str, kind: Any) -> Any:
    kinds = get_args(kind) or (kind,)
    if text == MISSING:
        return None if type(None) in kinds else kinds[0]()
    if bool in kinds:
        return {"true": True, "false": False}[text.casefold()]
    return next(kind_of_value for kind_of_value in kinds if kind_of_value is not type(None))(text)

"""The folder of a study's results: the design as it is run, the participants, and a folder for each of them."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from hashlib import sha256
from importlib.resources import files
from json import dumps, loads
from pathlib import Path
from typing import Any, NamedTuple

from tangible_core.errors import ConfigError, OutputError, ResultsError, quoted
from tangible_core.files import folder_lock, read_bytes, read_table, write_figures, write_text
from tangible_core.pipeline.output import make_writable
from tangible_core.provenance.versions import versions

from ..design import Study
from ..points import QUESTIONS
from ..questions import load_question
from ..study_file import StudyFile
from ..trials import MISSING

BIDS = "1.10.0"  # version of the Brain Imaging Data Structure that the folder follows


class Participant(NamedTuple):
    """A line of participants.tsv."""

    participant_id: str
    language: str
    started: str
    finished: str = MISSING

    @property
    def has_finished(self) -> bool:
        """True once all trials were answered."""
        return self.finished != MISSING


@dataclass(frozen=True)
class Place:
    """The paths of one participant."""

    root: Path
    name: str
    task: str

    @property
    def folder(self) -> Path:
        """The participant's folder."""
        return self.root / f"sub-{self.name}"

    @property
    def answers(self) -> Path:
        """The table of answers."""
        return self.folder / "beh" / f"sub-{self.name}_task-{self.task}_beh.tsv"

    @property
    def sidecar(self) -> Path:
        """The description of the table of answers."""
        return self.answers.with_suffix(".json")

    @property
    def consent(self) -> Path:
        """The text to which the participant agreed."""
        return self.folder / "consent.txt"

    def recording(self, trial: int, run: int) -> Path:
        """Return the path of the recording of a trial. run: number of the start, from 1."""
        name = f"sub-{self.name}_task-{self.task}_trial-{trial:04d}_run-{run}.nc"
        return self.folder / "recordings" / name

    def runs(self, trial: int) -> int:
        """Return how often a trial was started before, by its recordings."""
        return len(list(self.recording(trial, 1).parent.glob(f"*_trial-{trial:04d}_run-*.nc")))


def now() -> str:
    """Return date and time in UTC, ISO 8601; for people only, as a clock may be set at any time."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def design_digest(file: StudyFile) -> str:
    """Return the digest of the study file and of all pipeline files that it names."""
    digest = sha256(file.text.encode())
    for path in sorted({recipe.pipeline for recipe in file.recipes().values()}):
        try:
            digest.update(read_bytes(path))
        except OSError as error:
            raise ConfigError(f"{path}: cannot be read: {error.strerror or error}") from error
    return digest.hexdigest()[:16]


def prepare(root: Path, file: StudyFile) -> None:
    """Write what belongs to the whole study, for its first participant. Raises: OutputError."""
    digest = design_digest(file)
    make_writable(root)
    with folder_lock(root):
        _prepare(root, file, digest)


def _prepare(root: Path, file: StudyFile, digest: str) -> None:
    there = root / "dataset_description.json"
    if (root / "study.yaml").exists():
        try:
            before = loads(there.read_text(encoding="utf-8")).get("Design")
        except (OSError, ValueError, AttributeError, RecursionError):
            before = None
        if before != digest:
            raise OutputError(
                f"{root}: has participants of another version of this study; restore {root / 'study.yaml'} and its "
                "pipelines as they were, or name another folder with --out"
            )
        return
    if any(not path.name.startswith(".") for path in root.iterdir()):
        raise OutputError(f"{root}: holds other files; name an empty folder with --out")
    program = {"Name": "Tangible Images", "Version": versions()["tangible-images"]}
    description = {
        "Name": file.study.title or file.study.study,
        "BIDSVersion": BIDS,
        "DatasetType": "raw",
        "GeneratedBy": [program],
        "Design": digest,
        "Versions": versions("questplus", "psignifit"),
    }
    write_figures(there, description)
    write_figures(root / "participants.json", _columns()["participants"])
    write_text(root / "study.yaml", file.text)


def participants(root: Path) -> list[Participant]:
    """Return the participants in the order of their first trials. Raises: ResultsError for a damaged list."""
    path = root / "participants.tsv"
    try:
        return [Participant(**cells) for _, cells in read_table(path)[1]]
    except FileNotFoundError:
        return []
    except (OSError, ValueError, TypeError) as error:
        raise ResultsError(f"{path}: is not a list of participants: {error}; restore it") from error


def check_name(root: Path, name: str, resume: bool) -> int | None:
    """Return the number of the participant who resumes, from 0; None for a new one. Raises: ConfigError."""
    if not (name.isascii() and name.isalnum()):
        raise ConfigError(f"--participant {quoted(name)}: a name has letters and digits alone, such as P7")
    enrolled_before = participants(root)
    names = [person.participant_id.casefold() for person in enrolled_before]  # a file system may not tell p7 from P7
    number = names.index(f"sub-{name}".casefold()) if f"sub-{name}".casefold() in names else None
    if number is None:
        if resume:
            raise ConfigError(f"--participant {name}: has not begun yet; leave out --resume")
    elif enrolled_before[number].has_finished:
        raise ConfigError(f"--participant {name}: has answered all trials; give this participant another name")
    elif not resume:
        raise ConfigError(
            f"--participant {name}: has begun already; --resume goes on where this participant stopped, and somebody "
            "else needs another name"
        )
    elif enrolled_before[number].participant_id != f"sub-{name}":
        raise ConfigError(
            f"--participant {name}: is written {enrolled_before[number].participant_id.removeprefix('sub-')}"
        )
    return number


def enrol(root: Path, name: str, study: Study, resume: bool) -> int:
    """Return the number, from 0, of a new participant or of the one who resumes. Raises: ConfigError, OutputError."""
    with folder_lock(root):
        if (number := check_name(root, name, resume)) is not None:
            return number
        enrolled_before = participants(root)
        _write(root, [*enrolled_before, Participant(f"sub-{name}", study.language, now())])
        return len(enrolled_before)


def finish(root: Path, name: str) -> None:
    """Note that a participant has answered all trials. Raises: OutputError."""
    with folder_lock(root):
        enrolled_before = participants(root)
        _write(
            root,
            [
                person._replace(finished=now()) if person.participant_id == f"sub-{name}" else person
                for person in enrolled_before
            ],
        )


def _write(root: Path, people: list[Participant]) -> None:
    lines = ["\t".join(cells) for cells in (Participant._fields, *people)]
    write_text(root / "participants.tsv", "\n".join(lines) + "\n")


def faults_before(place: Place) -> list[str]:
    """Return the faults of earlier starts of this participant, from the description of the answers."""
    try:
        faults: list[str] = loads(place.sidecar.read_text(encoding="utf-8"))["Faults"]
        return list(map(str, faults))
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return []


def write_sidecar(place: Place, file: StudyFile, facts: Mapping[str, Any]) -> None:
    """Write the description of the table of answers. facts: of this participant, such as the device."""
    study = file.study
    units = {comparison.name: comparison.unit for comparison in study.comparisons if comparison.unit}
    about = {
        "TaskName": study.study,
        "TaskDescription": study.title,
        "Instructions": {
            comparison.name: comparison.instruction for comparison in study.comparisons if comparison.instruction
        },
        "Hears": study.hears,
        "Sees": study.sees,
        "Seed": study.seed,
        "Design": design_digest(file),
        "Versions": versions("questplus", "psignifit"),
        **facts,
    }
    write_figures(place.sidecar, {**_describe_answers(units), **about})


def _describe_answers(units: Mapping[str, str]) -> dict[str, Any]:
    """Return the description of each column of the table of answers. units: of the levels, by comparison."""
    unit = next(iter(units.values())) if len(set(units.values())) == 1 else dumps(dict(units))
    units_of_level = {"Units": unit} if units else {}
    answers = _columns()["answers"]
    questions = {"Levels": {name: load_question(name).about for name in QUESTIONS}}
    more = {"question": questions, "level": units_of_level, "standard": units_of_level}
    return answers | {name: answers[name] | facts for name, facts in more.items()}


@cache
def _columns() -> dict[str, dict[str, Any]]:
    """Return the descriptions of the columns of all tables, as BIDS wants them next to a table."""
    return loads(files("tangible_study.session").joinpath("columns.json").read_text(encoding="utf-8"))

"""The folder of a simulated study, as `tangible study run` writes it."""

from pathlib import Path

from ..session import folder
from ..study_file import StudyFile
from ..trials import AnswerFile
from .observer import Observer
from .simulating import names_of, simulate


def write_folder(root: Path, file: StudyFile, observer: Observer, participants: int, seed: int) -> int:
    """Simulate participants, write the folder that `tangible study run` writes, and return the number of answers.

    Raises: OutputError if the folder holds another study, or cannot be written; ConfigError if it has participants.
    """
    folder.prepare(root, file)
    count = 0
    for name in names_of(participants):
        number = folder.enrol(root, name, file.study, resume=False)
        place = folder.Place(root, name, file.study.study)
        options = observer.model_dump(mode="json")
        folder.write_sidecar(place, file, {"Observer": {"Model": type(observer).__name__, "Seed": seed, **options}})
        answers = simulate(file, observer, number, seed)
        with AnswerFile(place.answers) as table:
            for answer in answers:
                table.add(answer)
        folder.finish(root, name)
        count += len(answers)
    return count

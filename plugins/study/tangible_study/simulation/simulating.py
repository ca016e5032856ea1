"""Participants who are models: their answers, by the same procedures as those of people."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..analysis.analysing import Kept
from ..session import folder
from ..session.order import StudyCourse, answer_of
from ..study_file import StudyFile
from ..trials import Answer, AnswerFile
from .observers import Observer

MEDIAN_S = 1.2
"""Median of the simulated response times, seconds; they say nothing about people."""


def simulate(file: StudyFile, observer: Observer, number: int, seed: int) -> list[Answer]:
    """Return the answers of one participant to the whole study. number: of the participant, from 0."""
    generator = np.random.default_rng([seed, number, 1])
    individual = observer.participant(generator)
    course, answers = StudyCourse(file, number), list[Answer]()
    while (trial := course.next()) is not None:
        response = individual.answer(trial, file.study.comparison(trial.comparison), generator)
        seconds = MEDIAN_S * float(np.exp(0.4 * generator.standard_normal()))
        answers.append(answer_of(trial, len(answers) + 1, response, seconds))
        course.take(trial, response)
    return answers


def names_of(participants: int) -> list[str]:
    """Return the names of simulated participants."""
    return [f"S{number + 1:02d}" for number in range(participants)]


def kept_of(file: StudyFile, answers: Sequence[Sequence[Answer]]) -> Kept:
    """Return answers as the analysis reads them from a folder, without writing them."""
    tests = {
        name: [each for each in some if each.phase == "test"]
        for name, some in zip(names_of(len(answers)), answers, strict=True)
    }
    training = sum(each.phase == "training" for some in answers for each in some)
    return Kept(file.study, tests, training, 0)


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

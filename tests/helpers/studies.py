"""Small studies, and a desk at which a function answers."""

from collections.abc import Callable, Mapping
from pathlib import Path
from threading import Event

import numpy as np

from tangible_study.desks.desk import Desk, ParticipantLeft
from tangible_study.presenting.stimuli import Stimuli
from tangible_study.session.running import Session, begin
from tangible_study.study_file import parse_study

PIPELINE = "scene: {height: heights.npy}\nwant: touch\nrender: {use: proxy, stiffness_n_per_m: 300}\ndevice: mock\n"
STUDY = """\
study: small
pipeline: feel.yaml
feel_s: 0.05
pause_s: 0
breaks: {every: 3, seconds: 7}
consent: You may stop at any time.
order: as-written
conditions: {plain: {}, mellow: {set: {render.stiffness_n_per_m: 200}}}
comparisons:
- {name: odd, question: same, repetitions: 4, training: 1}
- {name: rate, question: rating, repetitions: 1, instruction: Now one interval.}
"""
"""Seven trials: one for training, four of oddity, two ratings."""

Answering = Callable[[str, Mapping[str, str]], str]


class Scripted(Desk):
    """A desk at which a function answers; what is said and asked is kept."""

    def __init__(self, answer: Answering) -> None:
        self.said = list[str]()
        self._answer, self._stop = answer, Event()

    @property
    def stop(self) -> Event:
        return self._stop

    def say(self, text: str) -> None:
        self.said.append(text)

    def ask(self, text: str, choices: Mapping[str, str]) -> str:
        self.said.append(text)
        return self._answer(text, choices)


def first_key(text: str, choices: Mapping[str, str]) -> str:
    """Answer with the first key."""
    return next(iter(choices))


def leave_after(trials: int) -> Answering:
    """Answer that many trials, then leave."""
    left = [trials]

    def answer(text: str, choices: Mapping[str, str]) -> str:
        if "1" in choices:
            left[0] -= 1
            if left[0] < 0:
                raise ParticipantLeft
        return next(iter(choices))

    return answer


def write_study(folder: Path, text: str = STUDY, pipeline: str = PIPELINE) -> Path:
    """Write a study with its pipeline."""
    np.save(folder / "heights.npy", np.outer(np.hanning(24), np.hanning(24)).astype(np.float32) * 0.004)
    (folder / "feel.yaml").write_text(pipeline)
    (folder / "study.yaml").write_text(text)
    return folder / "study.yaml"


def sit_down(
    path: Path, name: str = "P1", answer: Answering = first_key, *, resume: bool = False, device: tuple[str, ...] = ()
) -> Session:
    """Begin with a participant in the simulated device's time; results go to the folder `out` next to the file."""
    file = parse_study(path.read_text(), path)
    stimuli = Stimuli(file, device)
    stimuli.check = lambda: None  # preflight takes half a second, and has tests of its own
    session = begin(file, stimuli, name, path.parent / "out", Scripted(answer), resume=resume, in_real_time=False)
    assert session is not None
    session.wait = lambda _: None
    return session

"""A participant's session: trial after trial until the study is over, with every answer on the disk before the next."""

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from tangible_core.errors import ConfigError, DeviceError, OutputError, quoted
from tangible_core.files import write_text
from tangible_core.session import Writer

from ..design import Stimulus, Trial
from ..desks.desk import Desk
from ..presenting.presenter import Presenter, Rendering
from ..presenting.stimuli import Stimuli
from ..questions import load_question
from ..study_file import StudyFile
from ..trials import Answer, AnswerFile, read_answers
from . import folder
from .order import StudyCourse, make_answer, replay

CONSENT = "Do you agree?"
AGREE = {"y": "yes, I agree", "n": "no, I do not"}
GO_ON = {"": ""}  # enter alone


@dataclass
class Session:
    """A session of one participant at a desk."""

    stimuli: Stimuli
    place: folder.Place
    number: int  # number of the participant, from 0
    desk: Desk
    presenter: Presenter
    wait: Callable[[float], None] = time.sleep
    lateness_s: list[float] = field(default_factory=list[float])
    faults: list[str] = field(default_factory=list[str])

    def run(self) -> int:
        """Run all trials that are not answered yet; return the number of answers. Raises: ParticipantLeft."""
        file, course = self.stimuli.file, StudyCourse(self.stimuli.file, self.number)
        before = read_answers(self.place.answers)
        count, last = replay(course, before), before[-1].comparison if before else ""
        self.faults += folder.faults_before(self.place)
        self._save_facts()
        with AnswerFile(self.place.answers) as table, self.presenter.loop:
            try:
                while (trial := course.next()) is not None:
                    if trial.comparison != last:
                        self._introduce(trial)
                        last = trial.comparison
                    elif count and count % file.study.breaks.every == 0:
                        self._take_break(count, course.trials)
                    answer = self._run_trial(trial, count + 1, course.trials)
                    self._keep(table, answer)
                    course.take(trial, answer.response)
                    count += 1
                    if trial.phase == "training":
                        self._give_feedback(trial, answer)
            finally:
                with suppress(OutputError):  # a description; each answer is saved already
                    self._save_facts()
        folder.finish(self.place.root, self.place.name)
        self.desk.say("That was the last trial. Thank you.")
        return count

    def ask_consent(self) -> bool:
        """Read the consent text, unless that was done; return whether the participant agrees."""
        study = self.stimuli.file.study
        if not study.consent or self.place.consent.exists():
            return True
        self.desk.say(study.consent)
        return self.desk.ask(CONSENT, AGREE) == "y"

    def save_consent(self) -> None:
        """Keep the text to which the participant agreed. Raises: OutputError."""
        consent = self.stimuli.file.study.consent
        if consent and not self.place.consent.exists():
            write_text(self.place.consent, "\n\n".join((consent.rstrip(), f"agreed: {folder.now()}\n")))

    def _introduce(self, trial: Trial) -> None:
        comparison = self.stimuli.file.study.comparison(trial.comparison)
        if comparison.instruction:
            self.desk.say(comparison.instruction)
        if trial.phase == "training":
            self.desk.say("First some trials for training.")
        self.desk.ask("Press Enter to begin.", GO_ON)

    def _take_break(self, count: int, trials: int) -> None:
        seconds = self.stimuli.file.study.breaks.seconds
        self.desk.say(f"A break of {seconds:.0f} seconds. {count} of {trials} trials are done.")
        self.wait(seconds)
        self.desk.ask("Press Enter to go on.", GO_ON)

    def _run_trial(self, trial: Trial, number: int, trials: int) -> Answer:
        """Present a trial until it is answered; a device or a disk that fails makes it begin again."""
        while True:
            repeat = self.place.runs(number)  # the recording of a run that failed stays, and counts
            path = self.place.recording(number, repeat + 1)
            self.desk.say(f"Trial {number} of {trials}.")
            try:
                with Writer(path, self.presenter.about(trial)) as writer:
                    key, rendering, seconds = self._present_and_ask(trial, writer)
            except (DeviceError, OutputError) as error:
                self.faults.append(f"{path.name}: {error}")
                self.desk.say(f"The trial was interrupted, and there is no force. {error}")
                self.desk.ask("Press Enter to repeat the trial.", GO_ON)
                continue
            self.lateness_s += rendering.late_s
            why = rendering.why_not(self.stimuli.file.study.limits)
            return replace(
                make_answer(trial, number, key, seconds),
                repeat=repeat,
                rendered=why is None,
                why=why,
                recording=path.relative_to(self.place.root).as_posix(),
            )

    def _present_and_ask(self, trial: Trial, writer: Writer) -> tuple[str, Rendering, float]:
        """Return the response to a trial, what was rendered, and the time of the answer, s."""
        comparison, start_s = self.stimuli.file.study.comparison(trial.comparison), time.monotonic()
        question, intervals, whole = load_question(trial.question), trial.intervals, Rendering()
        while True:
            self.presenter.present(trial, intervals, writer, start_s, whole)
            asked_s, level = time.monotonic(), intervals[-1].level
            key = self.desk.ask(question.ask(comparison), question.choices(trial, comparison))
            following = question.next_level(trial, key, level)
            if following is None:
                return question.response(trial, key, level), whole, time.monotonic() - asked_s
            if following == level:
                self.desk.say("This is the end of the range.")
            intervals = (*intervals[:-1], Stimulus(trial.condition, following))

    def _keep(self, table: AnswerFile, answer: Answer) -> None:
        """Keep an answer; if the disk is full, tell so and try again until it is kept."""
        while True:
            try:
                return table.add(answer)
            except OutputError as error:
                self.desk.say(f"The answer is not saved yet. {error}")
                self.desk.ask("Press Enter to save it again.", GO_ON)

    def _give_feedback(self, trial: Trial, answer: Answer) -> None:
        if right := load_question(trial.question).right_answer(trial):
            self.desk.say("That is right." if answer.response == right else f"Not right. The answer is {right}.")

    def _save_facts(self) -> None:
        """Describe the table of answers, with the device and its lateness so far."""
        late_s = self.lateness_s
        facts: dict[str, Any] = {
            "Participant": self.number,
            "Device": self.stimuli.device,
            "Lateness": {"p99_s": max(late_s[::2], default=None), "max_s": max(late_s[1::2], default=None)},
            "Faults": self.faults,
        }
        folder.write_sidecar(self.place, self.stimuli.file, facts)


# Keys of a pipeline that may be set for a session: they belong to the place and not to the design.
CHOOSES_DEVICE = ("device.", "mapping.")


def device_changes(device: str | None, sets: list[str]) -> tuple[str, ...]:
    """Return the changes of each pipeline that choose the device. Raises: ConfigError for other keys."""
    for setting in sets:
        if not setting.startswith(CHOOSES_DEVICE):
            raise ConfigError(
                f"--set {quoted(setting)}: what varies stands in the study file; only keys of the device are set here, "
                "such as device.path=circle"
            )
    return (*([] if device is None else [f"device.use={device}"]), *sets)


def begin(
    file: StudyFile,
    stimuli: Stimuli,
    name: str,
    root: Path,
    desk: Desk,
    *,
    resume: bool = False,
    in_real_time: bool = True,
    progress: Callable[[int], None] = lambda _: None,
) -> Session | None:
    """Make and check all stimuli, and enrol the participant; None without consent. Raises: ConfigError, OutputError."""
    stimuli.make(progress)
    stimuli.check()
    place = folder.Place(root, name, file.study.study)
    if root.exists():
        folder.check_name(root, name, resume)
    session = Session(stimuli, place, 0, desk, Presenter(stimuli, desk, in_real_time))
    if not session.ask_consent():
        return None
    folder.prepare(root, file)
    session.number = folder.enrol(root, name, file.study, resume)
    session.save_consent()
    return session

"""A trial on the device: its intervals one after the other, recorded, with no force between them."""

import math
import time
from dataclasses import dataclass, field, replace

import numpy as np

from tangible_core.data import TICK_COLUMNS
from tangible_core.errors import DeviceError
from tangible_core.pipeline.output import about, join_descriptions
from tangible_core.servo import Servo
from tangible_core.session import INTERRUPTED, About, Writer

from ..design import Stimulus, Trial
from ..desks.desk import Desk
from ..questions import load_question
from .held_loop import HeldLoop
from .rendering import Rendering
from .stimuli import Stimuli

TIME = TICK_COLUMNS.index("time_s")
PERIOD_S = 0.001
"""Period of the force loop; an interval begins at least so long after the last tick of the one before."""


@dataclass
class Presenter:
    """Presents trials to a participant."""

    stimuli: Stimuli
    desk: Desk
    in_real_time: bool = True
    """False runs a simulated device by its own clock, without waiting."""
    loop: HeldLoop = field(default_factory=HeldLoop)

    def about(self, trial: Trial) -> About:
        """Describe the scenes of a trial for its recording, in the order of its intervals."""
        each = [about(self.stimuli.feeling(trial.comparison, stimulus).engine) for stimulus in trial.intervals]
        return join_descriptions(replace(each[0], device=self.stimuli.device), each)

    def present(
        self, trial: Trial, intervals: tuple[Stimulus, ...], writer: Writer, start_s: float, rendering: Rendering
    ) -> None:
        """Present intervals, and append their ticks to the recording, by the time since the trial began.

        start_s: monotonic time at which the trial began. rendering: counts the ticks.

        Raises: DeviceError if the device fails in an interval, KeyboardInterrupt, OutputError for the recording; the
        force is zero then.
        """
        study = self.stimuli.file.study
        self.desk.stop.clear()
        for number, stimulus in enumerate(intervals, 1):
            self._pause(study.pause_s if number > 1 else 0.0)
            name = f"Interval {number}." if len(intervals) > 1 else "Feel now."
            self._present_one(trial, stimulus, name, writer, start_s, rendering)
        self.desk.say("Please stop now.")

    def _present_one(
        self, trial: Trial, stimulus: Stimulus, name: str, writer: Writer, start_s: float, rendering: Rendering
    ) -> None:
        part = load_question(trial.question).part(trial)
        feeling, seconds = self.stimuli.feeling(trial.comparison, stimulus), self.stimuli.file.study.feel_s
        since_s, first_s = max(time.monotonic() - start_s, rendering.last_s + PERIOD_S), math.nan

        def begin(*_: Servo) -> None:
            nonlocal since_s
            since_s = max(time.monotonic() - start_s, since_s)
            self.desk.say(name)

        def keep(rows: np.ndarray) -> None:
            nonlocal first_s
            first_s = float(rows[0, TIME]) if math.isnan(first_s) else first_s
            rows = rows.copy()
            rows[:, TIME] += since_s - first_s
            rendering.add(rows)
            writer.append(rows)

        if not self.in_real_time:
            self.desk.say(name)
            recording = feeling.run(seconds, in_real_time=False, beacon=part, stop=self.desk.stop)
            keep(recording.rows)
            _check_end(recording.stopped)
        elif feeling.engine.scene.frames is None:
            self.loop.feel(feeling, seconds, keep, self.desk, begin, part)
        else:  # a film, which is played in a loop of its own
            self.loop.close()
            _check_end(feeling.run(seconds, keep=keep, on_start=begin, beacon=part, stop=self.desk.stop).stopped)

    def _pause(self, seconds: float) -> None:
        if self.in_real_time and seconds:
            time.sleep(seconds)


def _check_end(stopped: str) -> None:
    """Raise the error for an interval that ended early."""
    if stopped == INTERRUPTED:
        raise KeyboardInterrupt
    if stopped:
        raise DeviceError(stopped)

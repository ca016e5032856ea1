"""A trial on the device: its intervals one after the other, in a loop that stays open, recorded and counted."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Self, final

import numpy as np

from tangible_core.data import TICK_COLUMNS, UNTOUCHED, TickFlag
from tangible_core.errors import DeviceError
from tangible_core.pipeline import Feeling
from tangible_core.pipeline.output import about, join_descriptions
from tangible_core.plugins import HapticDevice
from tangible_core.servo import Servo, beacon_to, null_touch
from tangible_core.session import INTERRUPTED, STOPPED, About, RingDrain, Writer

from ..design import Limits, Stimulus, Trial
from ..desks.desk import Desk
from ..questions import load_question
from .stimuli import Stimuli

TIME, LATE, FLAGS = (TICK_COLUMNS.index(name) for name in ("time_s", "late_s", "flags"))
# Sentences about the guard's changes of a force; a force that fades in is as requested.
LIMITED = {
    TickFlag.FORCE_LIMITED: "the force was limited to the greatest that is allowed",
    TickFlag.STIFFNESS_LIMITED: "the force law was softened, as it is too stiff for this device",
    TickFlag.SLEW_LIMITED: "the force was delayed, as it changed too quickly",
    TickFlag.DAMPED: "the hand was damped, as the force gave it energy",
    TickFlag.NOT_FINITE: "the force was zero, as it was not a number",
    TickFlag.STALE: "the force was zero, as the device gave no position in time",
}


@dataclass
class Rendering:
    """Counts of the ticks of a trial."""

    ticks: int = 0
    touching: int = 0
    overruns: int = 0
    flag_counts: dict[TickFlag, int] = field(default_factory=dict[TickFlag, int])
    # The 99th percentile and the maximum of each part of the ticks.
    late_s: list[float] = field(default_factory=list[float])
    last_s: float = 0.0

    def add(self, rows: np.ndarray) -> None:
        """Count more ticks, rows of `TICK_COLUMNS`."""
        if not len(rows):
            return
        flags = rows[:, FLAGS].astype(np.int64)
        self.ticks, self.last_s = self.ticks + len(rows), float(rows[-1, TIME])
        self.touching += int(np.count_nonzero(flags & (TickFlag.TOUCHING | TickFlag.NOT_FINITE | TickFlag.STALE)))
        self.overruns += int(np.count_nonzero(flags & TickFlag.OVERRUN))
        for flag in LIMITED:
            self.flag_counts[flag] = self.flag_counts.get(flag, 0) + int(np.count_nonzero(flags & flag))
        self.late_s += [float(np.percentile(rows[:, LATE], 99)), float(rows[:, LATE].max())]

    def why_not(self, limits: Limits) -> str | None:
        """Return why the device did not render what was requested; None if it did."""
        flag, count = max(self.flag_counts.items(), key=lambda counts: counts[1], default=(None, 0))
        if flag is not None and self.touching and count > limits.limited * self.touching:
            return f"{LIMITED[flag]}, in {100 * count / self.touching:.0f} % of the time in contact"
        if self.ticks and self.overruns > limits.late * self.ticks:
            return f"{100 * self.overruns / self.ticks:.0f} % of the ticks came too late"
        return None


assert not any(flag & UNTOUCHED for flag in LIMITED)


# Interval at which ticks are taken from the loop, and so the most that a crash can lose of a recording.
LOOK_EVERY_S = 0.05


@final
class HeldLoop:
    """The loop of a session, as a context manager that leaves no force."""

    def __init__(self) -> None:
        self._servo: Servo | None = None
        self._device: HapticDevice | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> str:
        """End the loop, if one runs, and return why it ended. Raises: whatever a faulty plugin raised in it."""
        servo, self._servo = self._servo, None
        return "" if servo is None else servo.stop().stopped

    def feel(
        self,
        feeling: Feeling,
        seconds: float,
        keep: Callable[[np.ndarray], None],
        desk: Desk,
        on_start: Callable[[], None],
        part: str | None,
    ) -> None:
        """Present a surface for some seconds, then nothing. Raises: DeviceError, also after `desk.stop`."""
        try:
            servo = self._servo_on(feeling)
            servo.swap(feeling.touch, feeling.engine.config.safety)
            servo.pull_to(None if part is None else beacon_to(feeling.pipeline.make("surface"), part))
            with desk.exploring(feeling, servo, part):
                drain, stop = RingDrain(servo, keep, servo.ring.count), desk.stop
                until_s = time.monotonic() + seconds
                on_start()
                while servo.running and (left_s := until_s - time.monotonic()) > 0 and not stop.is_set():
                    stop.wait(min(left_s, LOOK_EVERY_S))
                    drain.look()
                if stop.is_set() or not servo.running:
                    why = self.close()
                    drain.look()
                    raise DeviceError(STOPPED if stop.is_set() else why)
            servo.pull_to(None)
            servo.swap(null_touch())
        except BaseException:
            self.close()
            raise

    def _servo_on(self, feeling: Feeling) -> Servo:
        """Return the loop on the device of a surface, which is started if none runs on this device."""
        device = feeling.device
        if self._servo is None or not self._servo.running or device != self._device:
            self.close()
            servo = Servo(null_touch(), device, feeling.engine.config.safety)
            servo.__enter__()
            self._servo, self._device = servo, device
        return self._servo


# Period of the force loop; an interval begins at least so long after the last tick of the one before.
PERIOD_S = 0.001


@dataclass
class Presenter:
    """Presents trials to a participant."""

    stimuli: Stimuli
    desk: Desk
    in_real_time: bool = True  # false runs a simulated device by its own clock, without waiting
    loop: HeldLoop = field(default_factory=HeldLoop)

    def about(self, trial: Trial) -> About:
        """Describe the scenes of a trial for its recording, in the order of its intervals."""
        each = [about(self.stimuli.feeling(trial.comparison, stimulus).engine) for stimulus in trial.intervals]
        return join_descriptions(replace(each[0], device=self.stimuli.device), each)

    def present(
        self, trial: Trial, intervals: tuple[Stimulus, ...], writer: Writer, start_s: float, rendering: Rendering
    ) -> None:
        """Present intervals, and append their ticks to the recording. Raises: DeviceError, OutputError."""
        study = self.stimuli.file.study
        self.desk.stop.clear()
        for number, stimulus in enumerate(intervals, 1):
            if self.in_real_time and number > 1:
                time.sleep(study.pause_s)
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


def _check_end(why: str) -> None:
    """Raise the error for an interval that ended early."""
    if why == INTERRUPTED:
        raise KeyboardInterrupt
    if why:
        raise DeviceError(why)

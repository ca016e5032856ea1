"""The progress of a comparison: a forecast of how long it takes, corrected by finished measurements."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import monotonic

from tangible_core.cli import approximately, is_quiet, show
from tangible_core.data import Outcome
from tangible_core.metrics import load_measured
from tangible_core.plugins import hooks
from tangible_core.plugins.registry import default_registry

from ..comparing import Step
from ..measuring.plan import Measurement
from ..measuring.run import Outlook

# The number of calls in the processes of `measured.json`: a warm-up and three timed calls.
CALLS = 4
START_S = 1.5  # the time in which a process starts and imports, seconds
UNKNOWN_S = 5.0  # the forecast for a process if nothing is known of its kind of method, seconds


@dataclass(frozen=True)
class Forecast:
    """The expected times of several measurements, in order."""

    expected_s: tuple[float, ...]
    has_times: bool = True  # false if errors alone are measured; for these no forecast is known

    @property
    def whole_s(self) -> float:
        """The expected time of all measurements."""
        return sum(self.expected_s)

    def left_s(self, number: int, taken_s: float) -> float:
        """Return the time that remains before measurement `number`, corrected by the time of the earlier ones.

        >>> Forecast((2.0, 2.0, 4.0)).left_s(2, taken_s=6.0)
        6.0
        """
        done_s = sum(self.expected_s[:number])
        return sum(self.expected_s[number:]) * (taken_s / done_s if done_s else 1.0)


def forecast(waiting: Sequence[Measurement]) -> Forecast:
    """Return the forecast for these measurements."""
    has_times = all(measurement.job.calls for measurement in waiting)
    return Forecast(tuple(_expected_s(measurement) for measurement in waiting), has_times)


def _expected_s(measurement: Measurement) -> float:
    figures = load_measured().get(measurement.job.kind)
    process_s = {} if figures is None else figures.process_s
    usual_s = process_s.get(measurement.job.use, median(process_s.values()) if process_s else UNKNOWN_S)
    calls_s = max(0.0, usual_s - START_S) * (measurement.job.warmups + measurement.job.calls) / CALLS
    return min(usual_s, START_S) + calls_s


class Progress:
    """Reports on the measurements of one comparison."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._forecast: Forecast | None = None
        self._start_s = 0.0

    def announce(self, outlook: Outlook) -> None:
        """Print what is measured already, and how long the rest takes."""
        self._forecast, self._start_s = forecast(outlook.waiting), monotonic()
        if is_quiet():
            return
        count = len(outlook.waiting)
        if outlook.current:
            failures = sum(row.error is not None for row in outlook.current.values())
            again = f", {failures} of them failed: --retry measures these once more" if failures else ""
            whole = len(outlook.current) + count
            show.note(f"{len(outlook.current)} of {whole} measurements are in {self.path} already and are kept{again}")
        if count:
            takes = f", which will take {approximately(self._forecast.whole_s)}"
            how = takes if self._forecast.has_times else ", side by side and without times"
            what = "1 measurement" if count == 1 else f"{count} measurements"
            show.note(f"{what}{how}; finished ones are kept if you interrupt it")

    def report(self, step: Step) -> None:
        """Report a measurement to all observers of stages, as if it were a stage: so --quiet hides it."""
        plugins, row = default_registry().plugins, step.row
        name = f"{row.scene}, {row.perturb}, round {row.repeat + 1} ({step.number + 1} of {step.of}"
        if not step.is_end:
            assert self._forecast is not None
            remaining = approximately(self._forecast.left_s(step.number, monotonic() - self._start_s))
            hooks.tell(plugins, "tangible_stage_started", product=f"{name}, {remaining} left)", method=row.method)
            return
        kind, why = ("failed", row.error) if row.error else ("ran", "measured")
        outcome = Outcome(f"{name})", kind, why or "", row.method, row.seconds or 0.0)
        hooks.tell(plugins, "tangible_stage_finished", outcome=outcome)

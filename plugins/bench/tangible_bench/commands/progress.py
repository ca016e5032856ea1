"""The progress of a comparison: how long all measurements will take, and how long the rest."""

from pathlib import Path
from time import monotonic

from tangible_core.cli import approximately, is_quiet, show
from tangible_core.data import Outcome
from tangible_core.plugins import hooks
from tangible_core.plugins.registry import default_registry

from ..comparing import Step
from ..measuring.forecast import Forecast, forecast
from ..measuring.run import Outlook


class Progress:
    """Reports on the measurements of one comparison."""

    def __init__(self, path: Path) -> None:
        """path: the file of results."""
        self.path = path
        self._forecast: Forecast | None = None
        self._start_s = 0.0

    def announce(self, outlook: Outlook) -> None:
        """Print what is measured already, and how long the rest takes."""
        self._forecast, self._start_s = forecast(outlook.waiting), monotonic()
        if is_quiet():
            return
        count = len(outlook.waiting)
        if outlook.kept:
            failed = sum(row.error is not None for row in outlook.kept.values())
            again = f", {failed} of them failed: --retry measures these once more" if failed else ""
            wanted = len(outlook.kept) + count
            show.note(f"{len(outlook.kept)} of {wanted} measurements are in {self.path} already and are kept{again}")
        if count:
            takes = f", which will take {approximately(self._forecast.whole_s)}"
            how = takes if self._forecast.has_times else ", side by side and without times"
            show.note(f"{count} measurements{how}; finished ones are kept if you interrupt it")

    def report(self, step: Step) -> None:
        """Report a measurement to all observers of stages, as if it were a stage: so --quiet hides it."""
        plugins, row = default_registry().plugins, step.row
        name = f"{row.scene}, {row.perturb}, round {row.repeat + 1} ({step.number + 1} of {step.of}"
        if not step.done:
            assert self._forecast is not None
            left = approximately(self._forecast.left_s(step.number, monotonic() - self._start_s))
            hooks.tell(plugins, "tangible_stage_started", product=f"{name}, {left} left)", method=row.method)
            return
        kind, why = ("failed", row.error) if row.error else ("ran", "measured")
        outcome = Outcome(f"{name})", kind, why or "", row.method, row.seconds or 0.0)
        hooks.tell(plugins, "tangible_stage_finished", outcome=outcome)

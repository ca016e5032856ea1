"""Progress on a terminal. Otherwise somebody who waits would see nothing, or a name would write over the screen."""

import pytest

from tangible_core.data import NO_FORCE, HapticState, Outcome, ServoReport
from tangible_core.plugins.observers import progress


def report(stopped: str = "", part: str = "", material: str = "") -> ServoReport:
    state = HapticState((0.0, 0.0, 0.0))
    return ServoReport(100, 0.1, state, NO_FORCE, 1.5, 0.0, stopped, part=part, material=material)


def test_progress_shows_one_spinner_in_a_terminal_alone(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    progress.tangible_stage_started("relief", "core")
    progress.tangible_stage_finished(Outcome("relief", "ran", "requested"))
    assert capsys.readouterr() == ("", "")
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    progress.tangible_stage_started("relief", "core")
    progress.tangible_servo_report(report())
    (spinner,) = progress._shown
    assert "0.1 s" in str(spinner.status)
    progress.tangible_servo_report(report(part="[bold] sign\n", material="moss"))
    assert str(spinner.status).endswith(r"peak 1.50 N, on [bold] sign\n, moss"), "breaks of lines in names are escaped"
    progress.tangible_servo_report(report("the time is over"))
    assert progress._shown == []

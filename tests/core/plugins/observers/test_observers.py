import logging

import pytest

from tangible_core.data import NO_FORCE, HapticState, Outcome, Plan, ServoReport
from tangible_core.pipeline.output.exporting import PREFIX
from tangible_core.plugins.observers import log, progress


def report(stopped: str = "", part: str = "", material: str = "") -> ServoReport:
    state = HapticState((0.0, 0.0, 0.0))
    return ServoReport(100, 0.1, state, NO_FORCE, 1.5, 0.0, stopped, part=part, material=material)


def test_log_has_a_line_for_each_hook(caplog: pytest.LogCaptureFixture):
    caplog.set_level(logging.DEBUG, "tangible_core.plugins.observers.log")
    ran = Outcome("relief", "ran", "requested", "core", 0.25)
    log.tangible_plan_made(Plan("relief", (ran,)))
    log.tangible_stage_started("relief", "core")
    log.tangible_stage_finished(ran)
    log.tangible_stage_finished(Outcome("segments", "failed", "a bug"))
    log.tangible_servo_report(report())
    log.tangible_servo_report(report(part="helmet", material="glass"))
    lines = [(record.levelname, record.getMessage()) for record in caplog.records]
    assert lines == [
        ("INFO", "plan for relief: relief ran"),
        ("DEBUG", "making relief with core"),
        ("INFO", "relief: ran, requested (0.250 s)"),
        ("INFO", "segments: failed, a bug (0.000 s)"),
        ("DEBUG", "servo: 100 ticks, 0.1 s, force 1.50 N"),
        ("DEBUG", "servo: 100 ticks, 0.1 s, force 1.50 N, on helmet, glass"),
    ]


def test_progress_without_a_terminal_writes_nothing(capsys: pytest.CaptureFixture[str]):
    progress.tangible_stage_started("relief", "core")
    progress.tangible_stage_finished(Outcome("relief", "ran", "requested"))
    assert capsys.readouterr() == ("", "")


def test_progress_of_an_exporter_shows_writing(monkeypatch: pytest.MonkeyPatch):
    lines = list[str]()
    monkeypatch.setattr(progress, "_show", lines.append)
    progress.tangible_stage_started(product=f"{PREFIX}swell", method="swell")
    progress.tangible_stage_started(product="relief", method="core")
    assert lines == ["writing swell", "making relief with core"]


def test_progress_shows_one_spinner_until_the_loop_stops(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    progress.tangible_stage_started("relief", "core")
    progress.tangible_servo_report(report())
    (spinner,) = progress._shown
    assert "0.1 s" in str(spinner.status)
    progress.tangible_servo_report(report(part="[bold] sign\n", material="moss"))
    assert str(spinner.status).endswith(r"peak 1.50 N, on [bold] sign\n, moss"), "breaks of lines in names are escaped"
    progress.tangible_servo_report(report("the time is over"))
    assert progress._shown == []

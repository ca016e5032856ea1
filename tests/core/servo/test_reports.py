"""Reports of a loop: the same for every kind of loop."""

import numpy as np

from tangible_core.data import NO_FORCE, TICK_COLUMNS, Force, HapticState, ServoReport
from tangible_core.servo.reports import brief_report
from tangible_core.session import run_simulated
from tangible_devices.replay import Replay
from tangible_render.penalty import Penalty


def test_brief_report_has_the_last_tick():
    rows = np.arange(2.0 * len(TICK_COLUMNS)).reshape(2, -1)
    assert brief_report(rows, 7, 1.5, 0.25, "it is over") == ServoReport(
        ticks=7,
        time_s=17.0,
        state=HapticState((19.0, 20.0, 21.0), (22.0, 23.0, 24.0), 17.0, 32),
        force=Force(28.0, 29.0, 30.0),
        peak_force_n=1.5,
        work_j=0.25,
        stopped="it is over",
        frame=33,
    )


def test_brief_report_before_the_first_tick_is_empty():
    nothing = brief_report(np.empty((0, len(TICK_COLUMNS))), 0, 0.0, 0.0, "")
    assert nothing == ServoReport(0, 0.0, HapticState((0.0, 0.0, 0.0)), NO_FORCE, 0.0, 0.0)


def test_brief_report_in_simulated_time_matches_the_recording():
    from tangible_core.data import HapticSurface

    reports: list[ServoReport] = []
    surface = HapticSurface.from_heights(np.full((16, 16), 0.01))
    recording = run_simulated(Penalty().touch(surface), Replay(), 0.5, reports.append)
    assert len(reports) >= 5
    for each in reports:
        assert each == brief_report(
            recording.rows[: each.ticks], each.ticks, each.peak_force_n, each.work_j, each.stopped
        )

"""The force loop that stays open from interval to interval."""

import time
from pathlib import Path

import numpy as np
import pytest

from studies import Scripted, first_key, sit_down, write_study
from tangible_core.data import TICK_COLUMNS
from tangible_core.errors import OutputError
from tangible_study.presenting.held_loop import HeldLoop
from tangible_study.presenting.stimuli import Stimuli
from tangible_study.study_file import parse_study

FORCE = [TICK_COLUMNS.index(each) for each in ("fx_n", "fy_n", "fz_n")]


def test_nothing_is_felt_between_intervals(tmp_path: Path, loop_in_thread: None):
    study = write_study(tmp_path)
    stimuli = Stimuli(parse_study(study.read_text(), study))
    comparison, stimulus = next(iter(stimuli.recipes))
    rows = list[np.ndarray]()
    with HeldLoop() as loop:
        for _ in range(2):
            loop.feel(stimuli.feeling(comparison, stimulus), 0.3, rows.append, Scripted(first_key), lambda: None, None)
            assert np.abs(np.concatenate(rows)[:, FORCE]).max() > 0.1
            rows.clear()
            time.sleep(0.1)
            assert loop._servo is not None and loop._servo.running
            newest = loop._servo.ring.latest()
            assert newest is not None and not newest[FORCE].any()
    assert loop._servo is None


def test_recording_that_cannot_be_kept_ends_the_loop(tmp_path: Path, loop_in_thread: None):
    """No force goes on while the participant reads that the disk is full."""

    def fail(rows: np.ndarray) -> None:
        raise OutputError("the disk is full")

    study = write_study(tmp_path)
    stimuli = Stimuli(parse_study(study.read_text(), study))
    feeling = stimuli.feeling(*next(iter(stimuli.recipes)))
    with HeldLoop() as loop:
        with pytest.raises(OutputError, match="disk is full"):
            loop.feel(feeling, 60.0, fail, Scripted(first_key), lambda: None, None)
        assert loop._servo is None
        rows = list[np.ndarray]()
        loop.feel(feeling, 0.1, rows.append, Scripted(first_key), lambda: None, None)
        assert rows, "the next interval opens the device anew"


def test_stop_of_one_trial_does_not_end_the_next(tmp_path: Path):
    session = sit_down(write_study(tmp_path))
    session.desk.stop.set()
    assert session.run() == 7
    assert session.faults == []

"""Studies on force loops in real time: a force that stays between intervals, or after a device is pulled out."""

import sys
import time
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from command_line import tangible
from distributions import distribution
from loop_devices import Failing, FailingLink
from studies import Scripted, first_key, sit_down, write_study
from tangible_core.data import TICK_COLUMNS, HapticState
from tangible_core.errors import ConfigError, DeviceError, OutputError
from tangible_core.pipeline.feeling import Feeling
from tangible_core.session import Recording
from tangible_study.desks.desk import ParticipantLeft
from tangible_study.presenting.presenter import HeldLoop
from tangible_study.presenting.stimuli import Stimuli
from tangible_study.procedures.procedure import load_procedure
from tangible_study.session.running import begin
from tangible_study.study_file import load_study, parse_study
from tangible_study.trials import read_answers
from waiting import until

RATING = """\
study: small
pipeline: feel.yaml
feel_s: 0.2
conditions: {plain: {}, mellow: {set: {render.stiffness_n_per_m: 200}}}
comparisons: [{name: rate, question: rating, repetitions: 1}]
"""


def test_device_that_is_pulled_out_holds_no_force_and_the_trial_begins_again(
    tmp_path: Path, loop_in_thread: None, monkeypatch: pytest.MonkeyPatch
):
    study, held = write_study(tmp_path, RATING), tmp_path / "held.txt"
    file, failed = parse_study(RATING, study), list[int]()
    stimuli, of_study, read = Stimuli(file), Stimuli.feeling, FailingLink._read

    def feeling(self: Stimuli, *key: object) -> Feeling:
        return Feeling(of_study(self, *key).pipeline, Failing(fault="none", record=str(held)))

    def fail_once(self: FailingLink) -> HapticState:
        if self.applied.z and not failed:
            failed.append(1)
            raise DeviceError("the failing device does not answer; plug it in")
        return read(self)

    monkeypatch.setattr(Stimuli, "check", lambda self: None)
    monkeypatch.setattr(Stimuli, "feeling", feeling)
    monkeypatch.setattr(FailingLink, "_read", fail_once)
    forces = list[float]()

    def force_n() -> float:
        return float(held.read_text() or 1) if held.exists() else 0.0

    def answer(text: str, choices: dict[str, str]) -> str:
        if "repeat" in text:
            forces.append(force_n())
        until(lambda: force_n() == 0, "the force does not fall to zero")
        return first_key(text, choices)

    session = begin(file, stimuli, "P1", tmp_path / "out", Scripted(answer))
    assert session.run() == 2
    kept = read_answers(tmp_path / "out/sub-P1/beh/sub-P1_task-small_beh.tsv")
    assert kept[0].repeat >= 1  # a machine that is busy may repeat more of them
    assert set(forces) == {0.0}
    cut = Recording.load(tmp_path / "out" / f"{kept[0].recording.rpartition('run-')[0]}run-1.nc")
    assert "does not answer" in cut.stopped
    whole = Recording.load(tmp_path / "out" / kept[0].recording)
    assert whole.stopped == ""
    assert whole.peak_force_n > 0
    assert (np.diff(whole.time_s) > 0).all()


def test_stop_of_the_participant_ends_the_force_at_once(tmp_path: Path, loop_in_thread: None):
    """The desk sets `stop` when the interval is announced; the interval would last for ten minutes."""
    text = RATING.replace("feel_s: 0.2", "feel_s: 600")
    study, asked = write_study(tmp_path, text), list[str]()
    file = parse_study(text, study)

    class Stopping(Scripted):
        def say(self, text: str) -> None:
            super().say(text)
            if text == "Feel now.":
                self.stop.set()

    def answer(text: str, choices: dict[str, str]) -> str:
        asked.append(text)
        if "repeat" in text:
            raise ParticipantLeft
        return first_key(text, choices)

    session = begin(file, Stimuli(file), "P1", tmp_path / "out", Stopping(answer))
    with pytest.raises(ParticipantLeft):
        session.run()
    assert asked[-1] == "Press Enter to repeat the trial."
    assert session.presenter.loop.close() == ""  # nothing runs any more


def test_procedure_of_another_package_runs_a_study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    example = Path(find_spec("studies").origin).parents[2] / "examples/procedure"
    monkeypatch.syspath_prepend(example)
    distribution(
        tmp_path / "site",
        "acme-staircase",
        {"tangible.procedure": {"acme-staircase": "acme_staircase.staircase:Staircase", "oddity": "acme:Oddity"}},
    )
    monkeypatch.syspath_prepend(tmp_path / "site")
    assert load_procedure("acme-staircase").__name__ == "Staircase"
    assert load_procedure("oddity").__module__ == "tangible_study.procedures.listed", "ours are not replaced"
    file = load_study(example / "study.yaml")
    assert len(file.recipes()) == 6
    sys.modules.pop("acme_staircase", None)


def test_levels_and_surfaces_that_cannot_be_rendered_are_named(tmp_path: Path):
    study = write_study(tmp_path, RATING.replace("200", "90000"))
    done = tangible("study", "check", "study.yaml", cwd=tmp_path)
    assert (done.returncode, done.stderr.count("study.yaml:4:25: mock cannot render this: ")) == (2, 1)
    study.write_text(RATING)
    done = tangible("study", "check", "study.yaml", cwd=tmp_path)
    assert (done.returncode, done.stdout.split(".")[0]) == (0, "study")
    assert "A participant has 2 trials, with 2 surfaces on the device mock." in " ".join(done.stdout.split())
    study = write_study(tmp_path, RATING)
    np.save(tmp_path / "hollow.npy", np.full((20, 20), np.nan))
    text = RATING.replace("{plain: {}, mellow:", "{hollow: {set: {scene.height: hollow.npy}}, mellow:")
    ready = list[int]()
    with pytest.raises(ConfigError, match=r"study.yaml:4:14: .*holds only NaN"):
        Stimuli(parse_study(text, study)).make(ready.append)
    assert ready == [1]


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
    assert (session.run(), session.faults) == (7, [])

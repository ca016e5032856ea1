"""Sessions with participants: every answer is kept, whatever happens in a trial."""

import json
import signal
import subprocess
import sys
from dataclasses import replace
from itertools import cycle
from pathlib import Path

import pytest

from studies import PIPELINE, STUDY, Scripted, first_key, leave_after, sit_down, write_study
from tangible_core.errors import ConfigError, OutputError
from tangible_core.pipeline.feeling import Feeling
from tangible_core.session import Recording, Writer
from tangible_study.desks.desk import ParticipantLeft
from tangible_study.presenting.stimuli import Stimuli
from tangible_study.session.folder import Place, faults_before, participants
from tangible_study.session.running import begin
from tangible_study.study_file import parse_study
from tangible_study.trials import AnswerFile, read_answers


@pytest.fixture
def study(tmp_path: Path) -> Path:
    return write_study(tmp_path)


def answers(study: Path, name: str = "P1"):
    return read_answers(study.parent / f"out/sub-{name}/beh/sub-{name}_task-small_beh.tsv")


def test_all_answers_and_the_force_of_each_trial_are_kept(study: Path):
    session = sit_down(study)
    assert session.run() == 7
    said = session.desk.said
    assert said.count("Press Enter to begin.") == 2, "once before each comparison"
    assert said.index("First some trials for training.") < said.index("Now one interval.")
    kept = answers(study)
    assert [each.trial for each in kept] == list(range(1, 8))
    assert [each.phase for each in kept] == ["training"] + 6 * ["test"]
    recording = Recording.load(study.parent / "out" / kept[0].recording)
    assert recording.time_s.size == 3 * 50
    assert (recording.time_s[1:] > recording.time_s[:-1]).all()
    assert recording.about.device == "mock"
    assert recording.about.configuration.count("---\n") == 2
    sidecar = json.loads((study.parent / "out/sub-P1/beh/sub-P1_task-small_beh.json").read_text())
    assert sidecar["Device"] == "mock"
    session.lateness_s = [0.001, 0.004, 0.003, 0.006, 0.002, 0.005]  # two figures of each interval
    session._save_facts()
    assert json.loads(session.place.sidecar.read_text())["Lateness"] == {"p99_s": 0.003, "max_s": 0.006}
    assert sidecar["response_time"]["Units"] == "s"
    assert set(vars(kept[0])) <= set(sidecar)
    description = json.loads((study.parent / "out/dataset_description.json").read_text())
    assert description["Design"] == sidecar["Design"]
    [participant] = participants(study.parent / "out")
    assert participant.has_finished
    consent = (study.parent / "out/sub-P1/consent.txt").read_text()
    assert consent.startswith("You may stop at any time.\n\nagreed: ")


def test_participant_who_left_resumes_at_the_next_trial(study: Path):
    with pytest.raises(ParticipantLeft):
        sit_down(study, answer=leave_after(3)).run()
    first = answers(study)
    assert [each.trial for each in first] == [1, 2, 3]
    assert sit_down(study, resume=True).run() == 7
    kept = answers(study)
    assert kept[:3] == first
    assert [each.repeat for each in kept] == [0, 0, 0, 1, 0, 0, 0]


def test_device_pulled_out_repeats_the_trial_and_marks_it(study: Path, monkeypatch: pytest.MonkeyPatch):
    calls, run = [], Feeling.run

    def pulled(self: Feeling, *args: object, **options: object) -> Recording:
        calls.append(1)
        done = run(self, *args, **options)
        return replace(done, stopped="the device does not answer; plug it in") if len(calls) == 5 else done

    monkeypatch.setattr(Feeling, "run", pulled)
    session = sit_down(study)
    assert session.run() == 7
    kept = answers(study)
    assert [each.repeat for each in kept] == [0, 1, 0, 0, 0, 0, 0]
    [said] = [each for each in session.desk.said if "plug it in" in each]
    assert said.startswith("The trial was interrupted, and there is no force.")
    cut = Recording.load(study.parent / "out" / kept[1].recording.replace("run-2", "run-1"))
    assert "plug it in" in cut.stopped
    sidecar = json.loads((study.parent / "out/sub-P1/beh/sub-P1_task-small_beh.json").read_text())
    assert len(sidecar["Faults"]) == 1


def test_full_disk_tells_so_and_keeps_the_answer(study: Path, monkeypatch: pytest.MonkeyPatch):
    add, append, full = AnswerFile.add, Writer.append, {"add": 2, "append": 5}

    def strain(name: str) -> None:
        full[name] -= 1
        if full[name] == 0:
            raise OutputError("cannot be written: No space left on device; free some space")

    monkeypatch.setattr(AnswerFile, "add", lambda self, answer: (strain("add"), add(self, answer))[1])
    monkeypatch.setattr(Writer, "append", lambda self, rows: (strain("append"), append(self, rows))[1])
    session = sit_down(study)
    assert session.run() == 7
    assert [each.trial for each in answers(study)] == list(range(1, 8))
    assert [each for each in session.desk.said if each.startswith("The answer is not saved yet.")]


def test_session_has_breaks_and_times_and_names_no_condition(study: Path, monkeypatch: pytest.MonkeyPatch):
    jumps = iter(range(10**6))
    monkeypatch.setattr("time.time", lambda: 1e9 * (-1) ** next(jumps))
    session, waits = sit_down(study), list[float]()
    session.wait = waits.append
    session.run()
    assert waits == [7.0, 7.0] and "3 of 7 trials" in " ".join(session.desk.said)
    assert all(0 <= answer.response_time < 60 for answer in answers(study))
    said = " ".join(session.desk.said).lower()
    assert "interval 1" in said
    assert not [name for name in ("plain", "mellow", "stiffness", "proxy", "300", "200") if name in said]


def test_stimulus_that_cannot_be_rendered_and_a_no_leave_nothing(tmp_path: Path):
    study = write_study(tmp_path, STUDY.replace("200", "90000"))
    desk = Scripted(lambda _, choices: "n" if "n" in choices else "")
    file = parse_study(study.read_text(), study)
    with pytest.raises(ConfigError, match="mock cannot render this"):
        begin(file, Stimuli(file), "P1", tmp_path / "out", desk, in_real_time=False)
    assert desk.said == []
    file = parse_study(STUDY, study)
    assert begin(file, Stimuli(file), "P1", tmp_path / "out", desk, in_real_time=False) is None
    assert desk.said and not (tmp_path / "out").exists()


@pytest.mark.whole
def test_killed_session_loses_no_answer(study: Path):
    code = (
        "import os, signal, sys; sys.path.insert(0, sys.argv[2])\n"
        "from pathlib import Path; import studies\n"
        "asked = []\n"
        "def answer(text, choices):\n"
        "    asked.extend(['1'] * ('1' in choices))\n"
        "    if len(asked) == 4: os.kill(os.getpid(), signal.SIGKILL)\n"
        "    return next(iter(choices))\n"
        "studies.sit_down(Path(sys.argv[1]), answer=answer).run()\n"
    )
    helpers = Path(sys.modules["studies"].__file__).parent
    ended = subprocess.run([sys.executable, "-c", code, str(study), str(helpers)], check=False)
    assert ended.returncode == -signal.SIGKILL
    assert [answer.trial for answer in answers(study)] == [1, 2, 3]
    assert sit_down(study, resume=True).run() == 7
    assert [(answer.trial, answer.repeat) for answer in answers(study)][3] == (4, 1)


def test_name_or_study_that_does_not_fit_the_folder_is_refused(study: Path):
    with pytest.raises(ParticipantLeft):
        sit_down(study, answer=leave_after(1)).run()
    for name, resume, words in (("P1", False, "begun already"), ("p1", True, "is written P1")):
        with pytest.raises(ConfigError, match=words):
            sit_down(study, name, resume=resume)
    sit_down(study, resume=True).run()
    before = answers(study)
    for name, resume, words in (
        ("P1", False, "all trials"), ("p1", False, "all trials"), ("P2", True, "not begun"), ("P 2", False, "letters"),
    ):  # fmt: skip
        with pytest.raises(ConfigError, match=words):
            sit_down(study, name, resume=resume)
    study.with_name("feel.yaml").write_text(PIPELINE.replace("300", "310"))
    with pytest.raises(OutputError, match="another version"):
        sit_down(study, "P2")
    assert answers(study) == before


def test_damaged_description_is_no_fault_of_the_program(study: Path):
    """That of answers is written anew at each start; a study whose own description is damaged is not mixed with."""
    with pytest.raises(ParticipantLeft):
        sit_down(study, answer=leave_after(2)).run()
    for text in ("", "[]", '{"Faults": 3}', '{"Faults": [1]}', '{"Faults": ' + "[" * 3000):
        (study.parent / "out/sub-P1/beh/sub-P1_task-small_beh.json").write_text(text)
        assert faults_before(Place(study.parent / "out", "P1", "small")) == (["1"] if "[1]" in text else [])
        (study.parent / "out/dataset_description.json").write_text(text)
        with pytest.raises(OutputError, match="another version"):
            sit_down(study, "P2")


def test_trial_that_the_guard_limited_is_marked_with_the_reason(study: Path):
    limits = "stiffness_n_per_m: 299, safety.max_force_n: 0.05"
    limited = "limits: {limited: 0.05}\n" + STUDY.replace("stiffness_n_per_m: 200", limits)
    study.write_text(limited)
    stimuli = Stimuli(parse_study(limited, study), ("device.hand=null",))  # the tip is in the surface, at any force
    stimuli.check = lambda: None
    desk, out = Scripted(first_key), study.parent / "out"
    session = begin(stimuli.file, stimuli, "P1", out, desk, in_real_time=False)
    session.wait = lambda _: None
    session.run()
    ratings = {answer.condition: answer for answer in answers(study) if answer.comparison == "rate"}
    assert (ratings["mellow"].rendered, ratings["plain"].rendered) == (False, True)
    assert "the greatest that is allowed" in ratings["mellow"].why


def test_adjustment_ends_at_the_level_that_was_set(tmp_path: Path):
    equal = "{name: equal, question: equal, conditions: [plain], vary: render.stiffness_n_per_m, "
    levels = "levels: [100, 200, 300], standard: 200, repetitions: 2}"
    study = write_study(tmp_path, STUDY.partition("comparisons:")[0] + f"comparisons:\n- {equal}{levels}\n")
    keys = cycle("113")  # more, more, it is equal
    sit_down(study, answer=lambda _, choices: next(keys) if "3" in choices else next(iter(choices))).run()
    kept = answers(study)
    assert {each.level for each in kept} == {100.0, 300.0}
    assert [each.response for each in kept] == ["300.0", "300.0"]

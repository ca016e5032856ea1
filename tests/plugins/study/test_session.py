"""Sessions with participants: every answer is kept, whatever happens in a trial."""

import json
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from studies import PIPELINE, STUDY, Scripted, first_key, leave_after, sit_down, write_study
from tangible_core.errors import ConfigError, OutputError
from tangible_core.pipeline.feeling import Feeling
from tangible_core.session import Recording, Writer
from tangible_study.desks.desk import Left
from tangible_study.presenting.stimuli import Stimuli
from tangible_study.procedures import Trial
from tangible_study.session.folder import Place, faults_before, participants
from tangible_study.session.start import begin
from tangible_study.session.words import response, right_answer
from tangible_study.study_file import parse_study
from tangible_study.trials import AnswerFile, read_answers


@pytest.fixture
def study(tmp_path: Path) -> Path:
    return write_study(tmp_path)


def answers(study: Path, name: str = "P1"):
    return read_answers(study.parent / f"out/sub-{name}/beh/sub-{name}_task-small_beh.tsv")


def test_all_answers_and_the_force_of_each_trial_are_kept(study: Path):
    assert sit_down(study).run() == 7
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
    assert sidecar["response_time"]["Units"] == "s"
    assert set(vars(kept[0])) <= set(sidecar)
    description = json.loads((study.parent / "out/dataset_description.json").read_text())
    assert description["Design"] == sidecar["Design"]
    [participant] = participants(study.parent / "out")
    assert participant.has_finished
    consent = (study.parent / "out/sub-P1/consent.txt").read_text()
    assert consent.startswith("You may stop at any time.\n\nagreed: ")


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"Faults": 3}', '{"Faults": [1]}', '{"Faults": ' + "[" * 3000])
def test_damaged_description_of_answers_or_of_the_study_is_no_fault_of_the_program(study: Path, text: str):
    """The description is written anew at each start; a study whose own description is damaged is not mixed with."""
    with pytest.raises(Left):
        sit_down(study, answer=leave_after(2)).run()
    sidecar = study.parent / "out/sub-P1/beh/sub-P1_task-small_beh.json"
    sidecar.write_text(text)
    assert faults_before(Place(study.parent / "out", "P1", "small")) == (["1"] if "[1]" in text else [])
    (study.parent / "out/dataset_description.json").write_text(text)
    with pytest.raises(OutputError, match="has participants of another version of this study"):
        sit_down(study, "P2")


def test_sidecar_has_the_worst_lateness_of_all_intervals(study: Path):
    """Each interval adds two figures: what one tick of a hundred exceeds, and the greatest."""
    session = sit_down(study)
    for late_s, p99_s, max_s in (
        ([], None, None),
        ([0.001, 0.004, 0.003, 0.006, 0.002, 0.005], 0.003, 0.006),
    ):
        session.lateness_s = late_s
        session._save_facts()
        assert json.loads(session.place.sidecar.read_text())["Lateness"] == {"p99_s": p99_s, "max_s": max_s}


def test_training_tells_the_right_answer(study: Path):
    """One of three keys is right in the first trial, which is the only one of training."""
    said = {}
    for key in ("1", "2", "3"):
        session = sit_down(
            study, f"P{key}", lambda text, choices, key=key: key if key in choices else first_key(text, choices)
        )
        session.number = 0
        session.run()
        said[key] = [each for each in session.desk.said if "right" in each]
    (right,) = (key for key, texts in said.items() if texts == ["That is right."])
    assert all(texts == [f"Not right. The answer is {right}."] for key, texts in said.items() if key != right)


def test_stimulus_that_the_device_cannot_render_is_refused_before_consent(tmp_path: Path):
    desk = Scripted(first_key)
    study = write_study(tmp_path, STUDY.replace("200", "90000"))
    file = parse_study(study.read_text(), study)
    with pytest.raises(ConfigError, match="mock cannot render this"):
        begin(file, Stimuli(file), "P1", tmp_path / "out", desk, in_real_time=False)
    assert desk.said == []
    assert not (tmp_path / "out").exists()


def test_nothing_said_names_a_condition(study: Path):
    session = sit_down(study)
    session.run()
    said = " ".join(session.desk.said).lower()
    assert "interval 1" in said
    assert not [name for name in ("plain", "mellow", "stiffness", "proxy", "300", "200") if name in said]


def test_participant_who_left_resumes_at_the_next_trial(study: Path):
    with pytest.raises(Left):
        sit_down(study, answer=leave_after(3)).run()
    first = answers(study)
    assert [each.trial for each in first] == [1, 2, 3]
    assert sit_down(study, resume=True).run() == 7
    kept = answers(study)
    assert kept[:3] == first
    assert [each.repeat for each in kept] == [0, 0, 0, 1, 0, 0, 0]


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
    assert [each.trial for each in answers(study)] == [1, 2, 3]
    assert sit_down(study, resume=True).run() == 7
    assert [(each.trial, each.repeat) for each in answers(study)][3] == (4, 1)


@pytest.mark.parametrize(
    ("name", "resume", "words"),
    [
        ("P1", False, "has answered all trials; give this participant another name"),
        ("p1", False, "has answered all trials"),
        ("P2", True, "has not begun yet; leave out --resume"),
        ("P 2", False, "letters and digits alone"),
    ],
)
def test_name_is_refused_with_the_cure(study: Path, name: str, resume: bool, words: str):
    sit_down(study).run()
    before = answers(study)
    with pytest.raises(ConfigError, match=words):
        sit_down(study, name, resume=resume)
    assert answers(study) == before


def test_second_participant_of_a_name_is_refused_while_the_first_has_not_finished(study: Path):
    with pytest.raises(Left):
        sit_down(study, answer=leave_after(1)).run()
    with pytest.raises(ConfigError, match="--resume goes on where this participant stopped, and somebody else needs"):
        sit_down(study)


def test_changed_study_is_refused(study: Path):
    sit_down(study).run()
    study.with_name("feel.yaml").write_text(PIPELINE.replace("300", "310"))
    with pytest.raises(OutputError, match="another version of this study"):
        sit_down(study, "P2")


def test_participant_who_does_not_agree_leaves_nothing(study: Path):
    file = parse_study(study.read_text(), study)
    desk = Scripted(lambda _, choices: "n" if "n" in choices else "")
    assert begin(file, Stimuli(file), "P1", study.parent / "out", desk, in_real_time=False) is None
    assert not (study.parent / "out").exists()


def test_device_pulled_out_repeats_the_trial_and_marks_it(study: Path, monkeypatch: pytest.MonkeyPatch):
    """In the second interval of the second trial, once."""
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
    """Once at an answer and once at a recording."""
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


def test_trial_that_the_guard_limited_is_marked_with_the_reason(study: Path):
    limited = "limits: {limited: 0.05}\n" + STUDY.replace(
        "stiffness_n_per_m: 200", "stiffness_n_per_m: 299, safety.max_force_n: 0.05"
    )
    study.write_text(limited)
    file = parse_study(limited, study)
    with pytest.raises(ConfigError, match=r"study.yaml:\d+:\d+: mock cannot render this"):
        Stimuli(file).check()
    file = parse_study(limited, study)
    stimuli = Stimuli(file, ("device.hand=null",))  # the tip is in the surface, whatever the force
    stimuli.check = lambda: None
    session = begin(file, stimuli, "P1", study.parent / "out", Scripted(first_key), in_real_time=False)
    session.wait = lambda _: None
    session.run()
    marked = [each for each in answers(study) if each.comparison == "rate" and each.condition == "mellow"]
    assert [each.rendered for each in marked] == [False]
    assert "the greatest that is allowed, in" in marked[0].why
    assert [each.rendered for each in answers(study) if each.comparison == "rate" and each.condition == "plain"] == [
        True
    ]


def test_adjustment_ends_at_the_level_that_was_set(tmp_path: Path):
    text = STUDY.partition("comparisons:")[0] + (
        "comparisons:\n- {name: equal, question: equal, conditions: [plain], vary: render.stiffness_n_per_m, "
        "levels: [100, 200, 300], standard: 200, repetitions: 2}\n"
    )
    study = write_study(tmp_path, text)
    shown = dict.fromkeys("12", 0)

    def answer(_: str, choices: dict[str, str]) -> str:
        keys = "".join(choices)
        if keys != "123":
            return next(iter(choices))
        shown["1"] += 1
        return "3" if shown["1"] % 3 == 0 else "1"

    sit_down(study, answer=answer).run()
    kept = read_answers(study.parent / "out/sub-P1/beh/sub-P1_task-small_beh.tsv")
    assert {each.level for each in kept} == {100.0, 300.0}
    assert [each.response for each in kept] == ["300.0", "300.0"]


@pytest.mark.parametrize(
    ("trial", "key", "given", "right"),
    [
        (Trial("a", "name", "naming", (), ("cup", "knife"), "x", target="knife"), "2", "knife", "knife"),
        (
            Trial("a", "different", "same-different", (), ("same", "different"), "x", "y", target="same"),
            "1",
            "same",
            "same",
        ),
        (Trial("a", "same", "oddity", (), ("1", "2", "3"), "x", "y", position=3), "2", "2", "3"),
        (Trial("a", "higher", "constant", (), ("1", "2"), "x", level=2.0, standard=1.0, position=2), "1", "1", "2"),
        (Trial("a", "higher", "constant", (), ("1", "2"), "x", level=0.5, standard=1.0, position=2), "2", "2", "1"),
        (Trial("a", "higher", "constant", (), ("1", "2"), "x", level=1.0, standard=1.0, position=2), "2", "2", ""),
        (Trial("a", "rougher", "2afc", (), ("1", "2"), "x", "y", position=1), "2", "2", ""),
    ],
)
def test_right_answer_is_told_in_training(trial: Trial, key: str, given: str, right: str):
    assert (response(trial, key), right_answer(trial)) == (given, right)


def test_same_or_different_is_asked_without_a_part(tmp_path: Path):
    text = STUDY.partition("comparisons:")[0] + "comparisons: [{name: differ, question: different, repetitions: 4}]\n"
    path = write_study(tmp_path, text)
    session = sit_down(path, answer=lambda _, choices: "2" if "2" in choices else next(iter(choices)))
    assert session.run() == 4
    kept = read_answers(session.place.answers)
    assert [each.response for each in kept] == ["different"] * 4
    assert sorted(each.correct for each in kept) == [0, 0, 1, 1]


def test_break_comes_after_every_few_trials_and_lasts(study: Path):
    session, waits = sit_down(study), list[float]()
    session.wait = waits.append
    session.run()
    assert waits == [7.0, 7.0]
    assert "A break of 7 seconds. 3 of 7 trials are done." in session.desk.said


def test_answer_times_do_not_follow_a_clock_that_is_set(study: Path, monkeypatch: pytest.MonkeyPatch):
    jumps = iter(range(10**6))
    monkeypatch.setattr("time.time", lambda: 1e9 * (-1) ** next(jumps))
    sit_down(study).run()
    assert all(0 <= each.response_time < 60 for each in answers(study))

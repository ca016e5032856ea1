"""The analysis of a folder: what counts, what is found in simulated answers, and the files that are written."""

import json
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from tangible_core.errors import ConfigError, OutputError, ResultsError
from tangible_core.files.writing import sole_writer
from tangible_study.analysis.analysing import analyse, analyse_answers, counts
from tangible_study.analysis.files import write_results
from tangible_study.commands.results import analyse as analyse_study
from tangible_study.commands.results import simulate as simulate_study
from tangible_study.measures.rows import What
from tangible_study.session import folder
from tangible_study.simulation.observers import make_observer
from tangible_study.simulation.power import count_answers, simulate, write_folder
from tangible_study.study_file import StudyFile, parse_study
from tangible_study.trials import AnswerFile, read_answers

LEVELS = "vary: workspace.relief_m, levels: [0.001, 0.0015, 0.002, 0.0025, 0.003], standard: 0.002, unit: m"
OTHERS = LEVELS.replace("0.002, ", "", 1)
STUDY = """\
study: s
pipeline: feel.yaml
conditions: {one: {}, two: {set: {render.use: penalty}}, three: {set: {render.use: force-shading}}}
comparisons:
"""
COMPARISONS = {
    "odd": "{name: odd, question: same, conditions: [one, two], repetitions: 30, training: 2}",
    "pair": "{name: pair, question: rougher, repetitions: 20}",
    "higher": f"{{name: higher, question: higher, conditions: [one, two], {LEVELS}, repetitions: 30}}",
    "distance": f"{{name: distance, question: same, conditions: [one], {OTHERS}, repetitions: 30}}",
    "equal": f"{{name: equal, question: equal, conditions: [one, two], {LEVELS}, repetitions: 10}}",
    "parts": "{name: parts, question: name, conditions: [one, two], names: [nose, ear, eye, chin], repetitions: 6}",
    "differ": "{name: differ, question: different, conditions: [one, two], repetitions: 40}",
    "rate": "{name: rate, question: rating, repetitions: 8}",
}


def study_of(folder: Path, *names: str) -> StudyFile:
    (folder / "feel.yaml").write_text("scene: builtin/brick\nwant: touch\nrender: proxy\ndevice: mock\n")
    text = STUDY + "".join(f"- {COMPARISONS[name]}\n" for name in names)
    (folder / "study.yaml").write_text(text)
    return parse_study(text, folder / "study.yaml")


def found(file: StudyFile, participants: int, model: str = "detection", *sets: str):
    observer = make_observer(model, sets, file)
    kept = count_answers(file, [simulate(file, observer, number, 5) for number in range(participants)])
    analysis = analyse_answers(kept)
    [result] = analysis.results
    rows = {(row.what, row.participant): row for row in result.rows}
    assert len(rows) == len(result.rows)
    return rows, " ".join(analysis.sentences[result.comparison])


def test_answers_that_count_are_few_or_odd_ones(tmp_path: Path):
    file = study_of(tmp_path, "odd")
    out = tmp_path / "out"
    write_folder(out, file, make_observer("detection", ["difference=3"], file), 1, 0)
    table = next(out.glob("sub-*/beh/*.tsv"))
    answers = read_answers(table)
    table.unlink()
    with AnswerFile(table) as again:
        for answer in answers:
            wrong = replace(answer, rendered=False, why="late", correct=0)
            again.add(wrong if answer.phase == "test" and answer.trial < 13 else answer)
    analysis = analyse(out)
    assert counts(analysis.answers) == (
        "20 answers of 1 participant count; 2 training trials and 10 that the device did not render as requested are "
        "left out."
    )
    [row] = analysis.results[0].of_all("proportion correct")
    assert row.trials == 20
    assert row.count == sum(answer.correct for answer in answers if answer.trial >= 13)
    file = study_of(tmp_path, "odd")
    rows, text = found(file, 1, "detection", "difference=3", "spread=0")
    share, dprime = rows[What("proportion correct", "one", "two"), "S01"], rows[What("d'", "one", "two"), "S01"]
    assert share.estimate.holds(0.78)
    assert dprime.estimate.holds(3)
    assert share.p < 0.001
    assert text.startswith("one and two can be told apart: 1 participant found the odd one in ")
    assert "in fewer than 1 of 10,000 studies" in text
    assert "says little about other people" in text
    _, text = found(file, 4, "detection", "difference=0")
    assert text.startswith("It is open whether one and two can be told apart")


def test_folders_without_a_study_or_of_another_analysis_are_refused(tmp_path: Path):
    with pytest.raises(ResultsError, match="is not the folder of a study"):
        analyse(tmp_path)
    study_of(tmp_path, "odd")
    with pytest.raises(ResultsError, match="no answer that counts yet"):
        analyse(tmp_path)
    file, out = study_of(tmp_path, "odd"), tmp_path / "analysis"
    analysis = analyse_answers(count_answers(file, [simulate(file, make_observer("detection", [], file), 0, 1)]))
    with sole_writer(out / "results.tsv"), pytest.raises(OutputError, match="another program is writing the same"):
        write_results(out, analysis)
    assert list(out.iterdir()) == []


def test_files_have_every_figure_and_plots_have_a_description(tmp_path: Path):
    file = study_of(tmp_path, "odd", "higher")
    kept = count_answers(file, [simulate(file, make_observer("detection", [], file), number, 1) for number in range(2)])
    paths = write_results(tmp_path / "analysis", analyse_answers(kept))
    assert {path.name for path in paths} == {
        "results.md", "results.tsv", "odd.png", "odd.svg", "higher.png", "higher.svg",
    }  # fmt: skip
    lines = [line.split("\t") for line in (tmp_path / "analysis/results.tsv").read_text().splitlines()]
    assert lines[0][:4] == ["comparison", "measure", "condition", "other"]
    assert {len(line) for line in lines} == {len(lines[0])}
    assert {"S01", "S02", "all"} == {line[4] for line in lines[1:]}
    paper = (tmp_path / "analysis/results.md").read_text()
    assert "| proportion correct | one | two |" in paper
    drawn = ElementTree.parse(tmp_path / "analysis/higher.svg").getroot()
    described = drawn.findtext("{http://www.w3.org/2000/svg}desc")
    assert described is not None
    assert "feels equal to the standard" in described


def test_second_study_is_refused_by_a_folder_that_the_first_is_preparing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    out, first, real = tmp_path / "out", study_of(tmp_path, "odd"), folder.write_figures
    second, later = study_of(tmp_path, "odd", "pair"), list[Future[None]]()

    def write_slowly(path: Path, data: Any) -> None:
        if not later:
            later.append(pool.submit(folder.prepare, out, second))
            wait(later, timeout=0.5)  # time enough to write, if nothing holds it
        real(path, data)

    monkeypatch.setattr(folder, "write_figures", write_slowly)
    with ThreadPoolExecutor(1) as pool:
        folder.prepare(out, first)
    with pytest.raises(OutputError, match="has participants of another version of this study"):
        later[0].result()
    assert (out / "study.yaml").read_text() == first.text
    folder.prepare(out, first)


def test_command_simulates_and_analyses_again_alike(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    study_of(tmp_path, "odd", "parts")
    out = tmp_path / "out"
    simulate_study(tmp_path / "study.yaml", sets=["difference=2"], participants=3, out=out, as_json=True)
    first = json.loads(capsys.readouterr().out)
    analyse_study(out, as_json=True)
    assert json.loads(capsys.readouterr().out) == first
    assert first["trials"] == 3 * (30 + 48)
    assert (out / "participants.tsv").read_text().count("\n") == 4
    sidecar = json.loads(next(out.glob("sub-S01/beh/*.json")).read_text())
    assert sidecar["Observer"]["difference"] == 2
    with pytest.raises(ConfigError, match="has answered all trials"):
        simulate_study(tmp_path / "study.yaml", participants=3, out=out)
    analyse_study(out)
    printed = capsys.readouterr().out
    assert all(text in printed for each in first["comparisons"] for text in [f"{each['name']}:\n", *each["found"]])


def test_command_tells_how_many_participants_are_needed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("tangible_study.simulation.power.TRIED", 40)
    study_of(tmp_path, "parts")
    simulate_study(tmp_path / "study.yaml", sets=["difference=1"], power=True, as_json=True)
    needs = json.loads(capsys.readouterr().out)
    assert [need["repetitions"] for need in needs] == [3, 6, 12, 24]
    assert needs[0]["participants"] > needs[-1]["participants"] > 2
    assert not (tmp_path / "out").exists()

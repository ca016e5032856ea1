"""A new kind of question is a file and its name in a table."""

import os
import subprocess
import sys
from pathlib import Path
from shutil import copytree, ignore_patterns

import pytest

import tangible_study
from studies import write_study
from tangible_study.points import QUESTIONS

ROOT = Path(__file__).parents[3]
STUDY = Path(tangible_study.__file__).parent
LIKED = '''\
"""Which of two intervals is liked more."""

import numpy as np

from ...measures.rows import Result, of_each_and_all
from ...measures.shares import CHOSEN, share_rows
from ...measures.rows import share
from ..question import Question, Score


class Liked(Question):
    sentence = "Which interval do you like more?"
    about = "which interval is liked more"
    procedures = ("2afc",)

    def score(self, trial, response):
        return Score(chosen=int(response == str(trial.position)))

    def decide(self, trial, percept, generator):
        return str(int(np.argmin(percept.strengths)) + 1)

    def analyse_conditions(self, comparison, answers):
        rows, _ = of_each_and_all(lambda *each: share_rows(CHOSEN, *each, lambda answer: answer.chosen, 0.5), answers)
        return Result(comparison.name, comparison.question, list(answers), rows, CHOSEN)

    def describe(self, row, who):
        return f"{row.what.condition} was liked in {share(row)}."


QUESTION = Liked()
'''
RUN = """\
import json, sys
from pathlib import Path
from studies import sit_down
from tangible_study.analysis.analysing import analyse
from tangible_study.analysis.files import write_results
from tangible_study.simulation.observers import make_observer
from tangible_study.simulation.power import write_folder
from tangible_study.study_file import load_study

path = Path(sys.argv[1])
session = sit_down(path)
print(session.run(), session.desk.said.count("Which interval do you like more?"))
print(analyse(path.parent / "out").sentences["liked"][0])
file = load_study(path)
write_folder(path.parent / "models", file, make_observer("detection", ["difference=9", "lapse=0"], file), 2, 1)
found = analyse(path.parent / "models")
print(found.sentences["liked"][0], len(write_results(path.parent / "report", found)))
print(json.loads(next(path.parent.glob("out/*/beh/*.json")).read_text())["question"]["Levels"]["liked"])
"""


@pytest.mark.whole
def test_new_kind_of_question_is_asked_analysed_and_simulated_with_two_files_touched(tmp_path: Path):
    package = tmp_path / "package/tangible_study"
    copytree(STUDY, package, ignore=ignore_patterns("__pycache__"))
    (package / "questions/kinds/liked.py").write_text(LIKED)
    table = package / "points.py"
    table.write_text(table.read_text("utf-8").replace('"rating")', '"rating", "liked")', 1), "utf-8")
    touched = {
        path.relative_to(package)
        for path in package.rglob("*.py")
        if not (STUDY / path.relative_to(package)).is_file()
        or path.read_bytes() != (STUDY / path.relative_to(package)).read_bytes()
    }
    assert touched == {Path("questions/kinds/liked.py"), Path("points.py")}
    study = write_study(
        tmp_path,
        "study: small\npipeline: feel.yaml\nfeel_s: 0.05\npause_s: 0\n"
        "conditions: {plain: {}, mellow: {set: {render.stiffness_n_per_m: 200}}}\n"
        "comparisons: [{name: liked, question: liked, repetitions: 4}]\n",
    )
    paths = [str(package.parent), str(ROOT / "tests/helpers"), *sys.path]
    ran = subprocess.run(
        [sys.executable, "-c", RUN, str(study)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True,
        text=True,
    )
    assert ran.returncode == 0, ran.stderr
    own, sentence, simulated, about = ran.stdout.splitlines()
    assert own == "4 4"
    assert sentence.startswith("plain was liked in 50 % of 4 trials")
    assert simulated.startswith("plain was liked in 100 % of 8 trials") and simulated.endswith(" 4")
    assert about == "which interval is liked more"


def test_each_kind_has_a_line_in_the_table_of_the_page():
    table = (ROOT / "docs/how-to/study.md").read_text("utf-8").partition("## Which question")[2].partition("\n## ")[0]
    assert [name for name in QUESTIONS if f"`{name}`" not in table] == []

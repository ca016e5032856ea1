"""The runner of mutants on a tree of a few lines, and whether the lists fit the code as it is."""

import fcntl
import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path
from typing import IO

import pytest

from benchmarks.mutants import Outcome, UnreadyError, rows, run
from benchmarks.mutants_lists import StaleError, mutants

ROOT = Path(__file__).parents[2]
CODE = '''
def larger(a, b):
    """Not the smaller one."""
    while a is None:
        a = 0
    return a if a > b else b
'''
TEST = """
import os
import subprocess
import sys
from pathlib import Path
from toy import larger

def test_larger():
    shared = Path(os.environ["TANGIBLE_SHARED_DIR"])
    assert not list(shared.iterdir())
    (shared / "left by this one").touch()
    assert larger(1, 2) == 2

HOLDS = '''
import fcntl, os, sys, time
held = open(os.path.join(os.environ["TOY_HELD"], str(os.getpid())), "w")
fcntl.flock(held, fcntl.LOCK_EX)
'''

def test_none():
    if "TOY_HELD" in os.environ:
        exec(HOLDS, globals())
        code = HOLDS + "print('held', flush=True); time.sleep(300)"
        child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
        child.stdout.readline()
    assert larger(None, 2) == 2
    if "TOY_HELD" in os.environ:
        child.kill()
        child.wait()

def test_in_a_program_that_is_told_nothing():
    code = "import sys, toy; sys.exit(toy.larger(1, 2) != 2)"
    assert subprocess.run([sys.executable, "-c", code], env={}, cwd="/").returncode == 0

def test_wrong():
    assert larger(1, 2) == 1
"""


def entry(name: str, old: str, new: str, tests: str = "tests/test_toy.py::test_larger", **more: str) -> str:
    fields = {"name": name, "file": "toy.py", "old": old, "new": new, "tests": f"[{tests}]", **more}
    return "- " + "\n  ".join(f"{key}: {value}" for key, value in fields.items()) + "\n"


KILLED = entry("the smaller one", "a > b", "a < b")
ELSEWHERE = entry("least", "a > b", "b > a", "tests/test_toy.py::test_in_a_program_that_is_told_nothing")
SURVIVES = entry("above", "a = 0", "a = 1")
EQUIVALENT = entry("the second of two alike", "a > b", "a >= b", equivalent="they are alike")
CONTRADICTED = entry("an explanation that is wrong", "a > b", "b > a", equivalent="so they say")
HANGS = entry("for ever", "a = 0", "a = None", "tests/test_toy.py::test_none")
UNSEEN = entry("a comment", "Not the", "The", "", equivalent="nobody reads it")


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A checkout: one module, its tests, and an empty folder of lists."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")  # a quick start
    root = tmp_path / "toy"
    (root / "tests").mkdir(parents=True)
    (root / "benchmarks" / "mutations").mkdir(parents=True)
    (root / "toy.py").write_text(CODE)
    (root / "tests" / "test_toy.py").write_text(TEST)
    subprocess.run(["git", "init", "-q", root], check=True)
    return root


def listed(tree: Path, *entries: str) -> Path:
    (tree / "benchmarks" / "mutations" / "toys.yaml").write_text("".join(entries))
    return tree


def test_run_of_a_list_reports_the_fate_of_each_mutant(tree: Path):
    listed(tree, KILLED, SURVIVES, ELSEWHERE, EQUIVALENT, CONTRADICTED, HANGS, UNSEEN)
    before = {path: path.read_bytes() for path in tree.rglob("*") if path.is_file()}
    results = list(run(tree, mutants(tree), jobs=2, patience_s=1))
    assert {each.mutant.name: each.outcome for each in results} == {
        "the smaller one": Outcome.KILLED,
        "above": Outcome.SURVIVED,
        "least": Outcome.KILLED,
        "the second of two alike": Outcome.EXPLAINED,
        "an explanation that is wrong": Outcome.CONTRADICTED,
        "for ever": Outcome.HUNG,
        "a comment": Outcome.EXPLAINED,
    }
    assert {"test_larger", "test_in_a_program_that_is_told_nothing"} == {
        each.why.partition("::")[2].partition(" ")[0] for each in results if each.outcome is Outcome.KILLED
    }
    text = "\n".join(rows(results))
    assert "| `toys` | 7 | 3 | 1 | 2 | 2 |" in text
    assert "toys.yaml:6: above: SURVIVED" in text
    assert {path: path.read_bytes() for path in tree.rglob("*") if path.is_file()} == before


def test_fault_in_a_file_of_no_package_is_noticed(tree: Path):
    """Such as in a page of the docs, or in what builds them."""
    (tree / "pages").mkdir()
    (tree / "pages" / "first.md").write_text("Toys are larger than none.\n")
    test = "from pathlib import Path\n\ndef test_page():\n    assert 'larger' in Path('pages/first.md').read_text()\n"
    (tree / "tests" / "test_page.py").write_text(test)
    listed(tree, entry("a page", "larger", "smaller", "tests/test_page.py").replace("toy.py", "pages/first.md"))
    assert [each.outcome for each in run(tree, mutants(tree), jobs=1)] == [Outcome.KILLED]


def test_tests_that_fail_without_a_fault_are_reported(tree: Path):
    listed(tree, entry("the smaller one", "a > b", "a < b", "tests/test_toy.py::test_wrong"))
    with pytest.raises(UnreadyError, match=r"toys: its tests fail without any fault:(.|\n)*test_wrong"):
        next(run(tree, mutants(tree), jobs=1))


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (entry("gone", "a <= b", "a < b"), "toys.yaml:6: gone: `old` stands 0 times in toy.py, not once"),
        (entry("twice", "a", "b"), "`old` stands .* times in toy.py, not once"),
        (entry("nothing", "a > b", "a > b"), "`new` is `old`"),
        (entry("no code", "a > b", "a >"), "toy.py is not Python with it"),
        (entry("no test", "a > b", "a < b", "tests/test_toy.py::test_smaller"), "there is no tests/.*::test_smaller"),
        (entry("no tests", "a > b", "a < b", ""), "names no tests"),
        (entry("a file", "a > b", "a < b").replace("toy.py\n", "joy.py\n"), "there is no joy.py"),
        (entry("a word", "a > b", "a < b", sort="x"), "sort\n.*not permitted"),
        (KILLED, "toys.yaml: the smaller one: stands twice"),
        ("- [", "toys.yaml: "),
        ("name: x\n", "toys.yaml: "),
    ],
)
def test_list_that_does_not_fit_the_code_is_refused(tree: Path, wrong: str, said: str):
    with pytest.raises(StaleError, match=said):
        mutants(listed(tree, KILLED if wrong.startswith("-") else "", wrong))


def test_ctrl_c_leaves_nothing_behind(tree: Path, tmp_path: Path):
    """A test holds a file, and so does a program that it started: once without the fault, once in its endless loop."""
    listed(tree, HANGS)
    folders = {"TMPDIR": "tmp", "TANGIBLE_SHARED_DIR": "shared", "TOY_HELD": "held"}
    for each in folders.values():
        (tmp_path / each).mkdir()
    code = """
        import signal, sys
        from pathlib import Path
        from benchmarks.mutants import complete
        signal.signal(signal.SIGINT, signal.default_int_handler)
        complete(Path(sys.argv[1]), (), 1)
    """
    environ = os.environ | {name: str(tmp_path / each) for name, each in folders.items()}
    end = time.monotonic() + 60
    with subprocess.Popen([sys.executable, "-c", textwrap.dedent(code), str(tree)], env=environ, cwd=ROOT) as program:
        while len(files := list((tmp_path / "held").iterdir())) < 4 and time.monotonic() < end:
            time.sleep(0.05)
        program.send_signal(signal.SIGINT)
    assert len(files) == 4
    assert program.returncode == -signal.SIGINT
    assert not [*(tmp_path / "tmp").iterdir(), *(tmp_path / "shared").iterdir()]
    for each in files:
        with each.open() as file:
            while not free(file):
                assert time.monotonic() < end
                time.sleep(0.05)


def free(file: IO[str]) -> bool:
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def test_lists_fit_the_code_as_it_is():
    assert mutants(ROOT)

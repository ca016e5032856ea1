"""`tangible compare`, as a user calls it."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from command_line import tangible
from tangible_bench.config.reading import load_comparison
from tangible_bench.measuring.rows import Row, append, read_rows
from tangible_core.plugins.registry import default_registry

ROOT = Path(__file__).parents[3]
TEXT = """\
compare: depth
methods: [constant, half, raises]
scenes: [{synthetic: steps, width_px: 64, height_px: 32}]
repeats: 1
warmups: 0
calls: 1
baseline: constant
out: out
"""


@pytest.mark.parametrize("path", sorted(ROOT.glob("configs/compare-*.yaml")), ids=lambda path: path.name)
def test_sample_comparisons_are_valid(path: Path):
    assert load_comparison(path, default_registry()).methods


@pytest.mark.usefixtures("cells_here")
def test_command_measures_shows_and_finds_regressions(tmp_path: Path):
    rows = tmp_path / "out" / "results.jsonl"
    (tmp_path / "c.yaml").write_text(TEXT)
    done = tangible("compare", "c.yaml", cwd=tmp_path)
    assert done.returncode == 1, done.stderr
    assert "no result on any scene: raises" in done.stderr
    failure = "PictureError: not this picture"
    for word in ("constant", "half", "raises", "baseline", "no result", failure, "out/results.jsonl"):
        assert word in done.stdout
    assert (tmp_path / "out" / "plot.png").is_file()

    # A method that failed on one scene of several has results; without the one that failed on all of them, so has all.
    good = tmp_path / "good.jsonl"
    for row in read_rows(rows).values():
        if row.method != "raises":
            append(good, row)
            append(
                good, replace(row, scene="elsewhere", key=row.key + "2", error="no" if row.method == "half" else None)
            )
    done = tangible("compare", good, cwd=tmp_path)
    assert done.returncode == 0, done.stderr

    # The same file against itself: nothing is measured, nothing is worse.
    rows.write_text(good.read_text())
    done = tangible("compare", rows, "--against", rows, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "4 cells compared, times as ratios to constant; 0 figures got worse" in done.stdout

    # Against results that were better.
    better = tmp_path / "better.jsonl"
    for row in read_rows(rows).values():
        append(better, better_than(row) if row.method == "half" else row)
    done = tangible("compare", rows, "--against", better, "--json", cwd=tmp_path)
    assert done.returncode == 1, done.stderr
    worse = json.loads(done.stdout)["against"]["worse"]
    assert {each["method"] for each in worse} == {"half"}
    assert "bad2 %" in {each["what"] for each in worse}


def better_than(row: Row) -> Row:
    return replace(row, measures={**row.measures, "bad2": 0.0})


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["missing.yaml"], "there is no such file"),
        (["missing.jsonl"], "cannot be read as results"),
        (["empty.jsonl"], "holds no row"),
        (["wrong.yaml"], "wrong.yaml:1:1: `compare:` names what kind"),
        (["good.yaml", "--against", "missing.jsonl"], "cannot be read as results"),
    ],
)
@pytest.mark.usefixtures("cells_here")
def test_command_with_a_mistake_exits_with_2_and_a_message(tmp_path: Path, words: list[str], why: str):
    (tmp_path / "empty.jsonl").write_text("")
    (tmp_path / "wrong.yaml").write_text("compare: nothing\n")
    (tmp_path / "good.yaml").write_text(TEXT)
    done = tangible("compare", *words, cwd=tmp_path)
    assert done.returncode == 2, done.stderr
    assert why in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()

"""`tangible compare`, as a user calls it."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

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


@pytest.mark.slow
def test_command_measures_shows_and_finds_regressions(tangible, tmp_path: Path):
    config, rows = tmp_path / "c.yaml", tmp_path / "out" / "results.jsonl"
    config.write_text(TEXT)
    process = tangible("compare", config)
    said, noise = process.communicate()
    assert process.returncode == 1, noise
    assert "no result on any scene: raises" in noise
    for word in ("constant", "half", "raises", "baseline", "no result", "PictureError: not this picture", str(rows)):
        assert word in said
    assert (tmp_path / "out" / "plot.png").is_file()

    # A method that failed on one scene of several has results; without the one that failed on all of them, so has all.
    good = tmp_path / "good.jsonl"
    for row in read_rows(rows).values():
        if row.method != "raises":
            append(good, row)
            append(
                good, replace(row, scene="elsewhere", key=row.key + "2", error="no" if row.method == "half" else None)
            )
    process = tangible("compare", good)
    _, noise = process.communicate()
    assert process.returncode == 0, noise

    # The same file against itself: nothing is measured, nothing is worse.
    rows.write_text(good.read_text())
    process = tangible("compare", rows, "--against", rows)
    said, noise = process.communicate()
    assert process.returncode == 0, noise
    assert "4 cells compared, times as ratios to constant; 0 figures got worse" in said

    # Against results that were better.
    better = tmp_path / "better.jsonl"
    for row in read_rows(rows).values():
        append(better, better_than(row) if row.method == "half" else row)
    process = tangible("compare", rows, "--against", better, "--json")
    said, noise = process.communicate()
    assert process.returncode == 1, noise
    worse = json.loads(said)["against"]["worse"]
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
def test_command_with_a_mistake_exits_with_2_and_a_message(tangible, tmp_path: Path, words: list[str], why: str):
    (tmp_path / "empty.jsonl").write_text("")
    (tmp_path / "wrong.yaml").write_text("compare: nothing\n")
    (tmp_path / "good.yaml").write_text(TEXT)
    process = tangible("compare", *(word if word.startswith("-") else tmp_path / word for word in words))
    _, noise = process.communicate()
    assert process.returncode == 2, noise
    assert why in noise
    assert "Traceback" not in noise
    assert not (tmp_path / "out").exists()

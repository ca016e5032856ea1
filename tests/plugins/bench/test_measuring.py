"""Measurements: a process each; rows are saved at once, and an ended comparison continues."""

import json
import time
from dataclasses import asdict, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from tangible_bench.config.reading import Comparison, parse_comparison
from tangible_bench.measuring import plan
from tangible_bench.measuring.plan import measurements
from tangible_bench.measuring.rows import Row, append, mend, read_rows
from tangible_bench.measuring.run import look, run
from tangible_bench.memory import held_bytes, start_peak
from tangible_core.errors import ConfigError, ResultsError
from tangible_core.plugins.registry import Registry
from waiting import until

SCENE = "{synthetic: steps, width_px: 64, height_px: 32}"
QUICK = "repeats: 1\nwarmups: 0\ncalls: 1\n"


def comparison(registry: Registry, methods: str, more: str = QUICK) -> Comparison:
    text = f"compare: depth\nmethods: [{methods}]\nscenes: [{SCENE}]\n{more}"
    return parse_comparison(text, Path("c.yaml"), registry)


def measure_rows(registry: Registry, path: Path, methods: str, more: str = QUICK, retry: bool = False) -> list[Row]:
    wanted = comparison(registry, methods, more)
    outlook = look(measurements(wanted), path, retry)
    return list(run(outlook, path, wanted.protocol.timeout_s, lambda *_: None, lambda *_: None).values())


@pytest.mark.whole
def test_rows_of_processes_have_every_field_and_leave_out_the_process(registry: Registry, tmp_path: Path):
    methods = "{use: constant, label: c, value_px: 4.5, seconds: 0.1}, hungry, talks"
    begun = time.perf_counter()
    row, hungry, talks = measure_rows(registry, tmp_path / "r.jsonl", methods, QUICK + "baseline: c\n")
    took = time.perf_counter() - begun
    assert (row.compare, row.method, row.use, row.origin) == ("depth", "c", "constant", "fakes 1.0")
    assert (row.scene, row.perturb, row.repeat, row.baseline) == ("steps 64x32", "none", 0, "c")
    assert row.options == {"value_px": 4.5, "seconds": 0.1}
    assert row.error is None and row.measures["density"] == 100
    assert row.measures["ausc"] == pytest.approx(row.measures["bad2"])  # one confidence everywhere says nothing
    assert row.versions["fakes"] == "1.0" and row.versions["numpy"] and row.versions["python"]
    assert row.machine["cores"] >= 1 and row.machine["processor"]
    assert list(read_rows(tmp_path / "r.jsonl").values()) == [row, hungry, talks]
    assert 0.1 <= row.seconds < took / 2  # the rest is the start of processes
    assert row.peak_memory_bytes < 2**20
    assert hungry.peak_memory_bytes == pytest.approx(64_000_000, rel=0.05)
    assert talks.error is None and talks.seconds != 1, "it prints where answers are expected"


@pytest.mark.usefixtures("cells_here")
def test_measures_are_errors_with_the_options_of_the_scene(
    registry: Registry, tmp_path: Path, caplog: pytest.LogCaptureFixture
):
    """A constant of 0 px is wrong by the truth itself."""
    from tangible_core.testing.synthetic.stereo_scenes import synthetic_pair

    (row,) = measure_rows(registry, tmp_path / "r.jsonl", "{use: constant, value_px: 0}")
    pair = synthetic_pair("steps", 64, 32)
    assert row.measures["average_px"] == pytest.approx(pair.truth_px.mean(), rel=1e-5)
    assert row.measures["bad2_noc"] == pytest.approx(100 * (pair.truth_px > 2)[pair.visible].mean())
    methods = "{use: ranged, max_disparity_px: 2}, {use: ranged, label: told, given: [max_disparity_px]}"
    rows = measure_rows(registry, tmp_path / "r.jsonl", methods)
    assert [(row.method, row.options) for row in rows] == [
        ("ranged", {"max_disparity_px": 2}),
        ("told", {"max_disparity_px": 16}),
    ]
    (doubt,) = caplog.messages
    assert doubt.startswith("ranged on steps 64x32: max_disparity_px 2 is below the truth of "), doubt
    assert doubt.endswith("write `max_disparity_px: 16`, or `given: [max_disparity_px]`")
    wanted = comparison(registry, "{use: ranged, given: [max_disparity_px]}")
    with pytest.raises(ConfigError, match=r"ranged cannot be given .* equal to 1000; leave out its `given:`"):
        wanted.methods[0].method_for({"max_disparity_px": 2000})
    rows = measure_rows(registry, tmp_path / "r.jsonl", "half, {use: half, label: filled}", QUICK + "fill: [filled]\n")
    assert [(row.method, row.measures["density"], row.finishes) for row in rows] == [
        ("half", 50, ()),
        ("filled", 100, ("fill",)),
    ]


@pytest.mark.usefixtures("cells_here")
def test_failing_methods_are_rows_and_stop_no_other(registry: Registry, tmp_path: Path, log_dir: Path):
    methods = "raises, fails, dies, {use: dies, label: leaves, how: exit}, relative, constant"
    rows = {row.method: row for row in measure_rows(registry, tmp_path / "r.jsonl", methods)}
    assert rows["raises"].error == "PictureError: not this picture"
    log = log_dir / "failures.log"
    assert rows["fails"].error == f"IndexError: list index out of range; the traceback is in {log}"
    assert "bench_fakes.py" in log.read_text()
    assert rows["dies"].error == "killed by SIGKILL: last words"
    assert rows["leaves"].error == "ended with exit code 7: last words"
    assert "relative, not in px" in str(rows["relative"].error)
    assert rows["constant"].error is None
    assert rows["raises"].seconds is None and rows["raises"].measures == {}


def test_rounds_start_with_different_methods_and_end_at_the_timeout(registry: Registry, tmp_path: Path):
    wanted = measurements(comparison(registry, "constant, half, talks", "repeats: 3\nperturb: [none, {noise: 5}]\n"))
    order = [(each.row.repeat, each.row.perturb, each.row.method) for each in wanted]
    assert order[:4] == [(0, "none", "constant"), (0, "none", "half"), (0, "none", "talks"), (0, "noise 5", "constant")]
    assert [method for repeat, perturb, method in order if repeat == 1 and perturb == "none"] == [
        "half",
        "talks",
        "constant",
    ]
    assert len({each.row.key for each in wanted}) == 18
    (row,) = measure_rows(registry, tmp_path / "r.jsonl", "sleeps", QUICK + "timeout_s: 0.5\n")
    assert row.error == "took longer than 0.5 s and was ended; raise timeout_s or drop the method"


@pytest.mark.parametrize(
    ("methods", "more", "same"),
    [
        ("constant, half", QUICK, True),
        ("constant", QUICK + "timeout_s: 5\nbaseline: constant\nout: elsewhere\n", True),
        ("{use: constant, value_px: 3}", QUICK, False),
        ("{use: constant, label: other}", QUICK, False),
        ("constant", QUICK + "perturb: [{noise: 5}]\n", False),
        ("constant", QUICK + "fill: [constant]\n", False),
        ("constant", "repeats: 1\nwarmups: 1\ncalls: 1\n", False),
    ],
)
def test_key_depends_on_what_is_measured(registry: Registry, methods: str, more: str, same: bool):
    first = measurements(comparison(registry, "constant"))[0].row.key
    assert (measurements(comparison(registry, methods, more))[0].row.key == first) is same


@pytest.mark.parametrize("part", ["closure", "versions", "machine"])
def test_key_depends_on_code_libraries_and_machine(registry: Registry, monkeypatch: pytest.MonkeyPatch, part: str):
    other = {"closure": SimpleNamespace(digest="other"), "versions": {"python": "3.99"}, "machine": {"cores": 1000}}
    first = measurements(comparison(registry, "constant"))[0].row.key
    monkeypatch.setattr(plan, part, lambda *_: other[part])
    assert measurements(comparison(registry, "constant"))[0].row.key != first


@pytest.mark.usefixtures("cells_here")
def test_torn_last_line_is_ignored_and_removed(registry: Registry, tmp_path: Path):
    path = tmp_path / "r.jsonl"
    (row,) = measure_rows(registry, path, "constant")
    whole = path.read_bytes()
    path.write_bytes(whole + whole[:40])
    assert list(read_rows(path).values()) == [row]
    mend(path)
    append(path, row)
    assert path.read_bytes() == whole + whole


@pytest.mark.usefixtures("cells_here")
def test_what_is_known_is_not_measured_again_and_what_failed_only_with_retry(registry: Registry, tmp_path: Path):
    path, thrice = tmp_path / "r.jsonl", "repeats: 3\nwarmups: 0\ncalls: 1\n"
    measure_rows(registry, path, "constant")
    before = path.read_bytes()
    assert [row.method for row in measure_rows(registry, path, "constant, half")] == ["constant", "half"]
    assert path.read_bytes().startswith(before) and lines(path) == 2
    for retry, count in ((False, 3), (False, 3), (True, 4)):
        assert len(measure_rows(registry, path, "raises", thrice, retry=retry)) == 1
        assert lines(path) == count


ROW = Row("k", "depth", "m", "m", {}, "d 1", "s", "digest", "none", (), 0, {}, {"processor": "p"}, seconds=1.0)


@pytest.mark.parametrize(
    ("line", "place"),
    [
        ("[" * 100_000 + "]" * 100_000, ""), ('{"key": 1}', "key"), ("null", ""),
        ('{"' + "x\\u001b" * 100_000 + '": 1}', ""),
        *((json.dumps({**asdict(ROW), name: value}), name) for name, value in (
            ("seconds", "fast"), ("seconds", True), ("machine", {"processor": [1]}), ("measures", {"bad1": "x"}),
            ("finishes", [1]), ("options", []), ("repeat", 1.5), ("more", 1),
        )),
    ],
    ids=str,
)  # fmt: skip
def test_damaged_line_is_refused_with_its_number_and_field(tmp_path: Path, line: str, place: str):
    path = tmp_path / "r.jsonl"
    path.write_text(f"{line}\n")
    with pytest.raises(ResultsError, match=rf"r\.jsonl:1: is not a row of results: .*{place}") as error:
        read_rows(path)
    assert str(error.value).isprintable() and len(str(error.value)) < 500


def test_row_is_read_as_it_was_written(tmp_path: Path):
    row = replace(ROW, finishes=("fill",), options={"a": [1, None]}, measures={"bad1": 3, "x": None}, seconds=1)
    append(tmp_path / "r.jsonl", ROW)
    append(tmp_path / "r.jsonl", row)
    assert read_rows(tmp_path / "r.jsonl") == {"k": row}, "the last one of a key counts"
    with pytest.raises(ResultsError, match="cannot be read"):
        read_rows(tmp_path / "missing.jsonl")


def write_file(folder: Path, methods: str, more: str) -> Path:
    path = folder / "c.yaml"
    path.write_text(f"compare: depth\nmethods: [{methods}]\nscenes: [{SCENE}]\nout: out\n{more}")
    return path


def lines(path: Path) -> int:
    return path.read_bytes().count(b"\n") if path.exists() else 0


@pytest.mark.whole
def test_killed_comparison_continues_where_it_stopped(tangible, tmp_path: Path):
    config = write_file(tmp_path, "{use: constant, seconds: 0.2}, half", "repeats: 2\nwarmups: 0\ncalls: 1\n")
    rows = tmp_path / "out" / "results.jsonl"
    first = tangible("compare", config)
    until(lambda: lines(rows) >= 1, "a row")
    first.kill()
    first.communicate()
    kept = rows.read_bytes()
    assert kept.endswith(b"\n")
    rows.write_bytes(kept + b'{"key": "torn')

    second = tangible("compare", config, "--json")
    output, errors = second.communicate()
    assert second.returncode == 0, errors
    assert f"{kept.count(bytes([10]))} of 4 measurements are in" in errors.replace("\n", " ")
    assert rows.read_bytes().startswith(kept)
    found = [json.loads(line) for line in rows.read_text().splitlines()]
    assert len(found) == len({row["key"] for row in found}) == 4
    assert [len(cell["seconds"]) for cell in json.loads(output)["cells"]] == [2, 2]


def test_peak_memory_counts_from_its_start_and_held_bytes_are_those_of_the_result():
    np.ones(160_000_000, np.uint8)
    peak = start_peak()
    np.ones(80_000_000, np.uint8)
    assert peak() == pytest.approx(80_000_000, rel=0.1)
    assert held_bytes(lambda: np.ones(10_000)) == pytest.approx(80_000, rel=0.01)
    assert held_bytes(lambda: np.ones(10_000).sum()) < 1000

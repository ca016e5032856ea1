"""The command line. Otherwise a command would fail, lose what was felt, or hide why it refused."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from command_line import tangible
from ctrl_c import HEARING
from distributions import distribution
from pictures import write_png
from tangible_core.data import ServoReport
from tangible_core.pipeline.output import runs
from tangible_core.session import INTERRUPTED, Recording, run_simulated
from tangible_render import Penalty

TANGIBLE = str(Path(sys.executable).with_name("tangible"))

SMALL = """\
scene: {left: left.png, right: right.png, truth: truth.npy}
want: touch
depth: {use: opencv-sgbm, max_disparity_px: 16}
texture: {use: gradient, segments: 2}
render: {use: penalty-gradient}
device: {use: mock}
"""


def mistake(*words: object, cwd: Path) -> str:
    """What is said of a user's mistake: exit code 2, and no traceback."""
    done = tangible(*words, cwd=cwd)
    assert done.returncode == 2, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    return done.stderr.strip()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A small pair: a textured wall, its right half 8 px nearer than its left one."""
    rng = np.random.default_rng(1)
    wall = rng.integers(0, 255, (64, 120), dtype=np.uint8)
    left = wall[:, 16:112]
    near = np.arange(96) >= 48
    right = np.where(near, wall[:, 24:120], wall[:, 20:116])
    write_png(tmp_path / "left.png", left)
    write_png(tmp_path / "right.png", right)
    np.save(tmp_path / "truth.npy", np.broadcast_to(np.where(near, 8.0, 4.0), (64, 96)))
    (tmp_path / "p.yaml").write_text(SMALL)
    return tmp_path


def test_run_of_a_pair_makes_every_product_and_reports_it(folder: Path):
    done = tangible("run", "p.yaml", "--seconds", 1, "--verbose", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert not [word for word in ("disparity", "opencv-sgbm", "bad2", "out/p/sheet.png") if word not in done.stdout]
    written = {path.name for path in (folder / "out" / "p").iterdir()}
    products = {"disparity.npz", "segments.npz", "materials.npz", "surface.npz"}
    assert written == products | {"config.yaml", "manifest.json", "outcomes.json", "recording.npz", "sheet.png"}
    again = tangible("run", "out/p/config.yaml", "--seconds", 1, "--sheet", "svg", "--json", cwd=folder)
    document = json.loads(again.stdout)
    (sheet,) = (folder / each for each in document["files"] if each.endswith(".svg"))
    assert f"<title>{folder.name}</title>" in sheet.read_text(encoding="utf-8")  # and no path of this machine
    outcomes = {each["product"]: each["outcome"] for each in document["outcomes"]}
    assert outcomes["surface"] == outcomes["disparity"] == "cached"
    assert document["figures"]["disparity"]["bad2"] < 40
    assert document["figures"]["force"]["peak_force_n"] > 0
    assert all(Path(folder, file).exists() for file in document["files"])


def test_plan_runs_nothing_and_reports_a_refusal(folder: Path):
    steps = json.loads(tangible("plan", "p.yaml", "--json", cwd=folder).stdout)
    assert [(step["product"], step["outcome"]) for step in steps][:2] == [("views", "given"), ("disparity", "ran")]
    one = ("p.yaml", "--set", "scene={photo: left.png}", "--set", "depth={use: semi-global}")
    said = mistake("plan", *one, cwd=folder)
    assert "left.png has one: give both" in said
    assert said.removeprefix("this cannot be run: ") == mistake("run", *one, cwd=folder)
    assert not (folder / "out").exists()
    assert json.loads(tangible("plan", *one, "--json", cwd=folder).stdout)[-1]["outcome"] == "refused"


@pytest.mark.usefixtures("loop_in_thread")
def test_feel_records_every_tick(folder: Path):
    done = tangible("feel", "p.yaml", "--seconds", 0.5, "--record", "hand.npz", "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    figures = json.loads(done.stdout)["figures"]
    with np.load(folder / "hand.npz") as recording:
        assert len(recording["time_s"]) == figures["ticks"] == 500


@pytest.mark.usefixtures("loop_in_thread")
def test_feel_with_hardly_any_matches_asks_first(folder: Path, monkeypatch: pytest.MonkeyPatch):
    write_png(folder / "right.png", np.random.default_rng(9).integers(0, 255, (64, 96), dtype=np.uint8))
    words = ("feel", "p.yaml", "--seconds", 0.2)
    said = mistake(*words, cwd=folder)
    assert "hardly anything matches in the two pictures" in said and said.endswith("--yes")
    answers, asked = [False, True], []

    def confirm(text: str, err: bool) -> bool:
        asked.append(text)
        return answers.pop(0)

    monkeypatch.setattr("typer.confirm", confirm)
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(isatty=lambda: True))
    codes = [tangible(*words, *more, cwd=folder).returncode for more in ((), ("--yes",), ())]
    assert (codes, len(asked)) == ([1, 0, 0], 2)


def test_lists_have_units_and_sources():
    methods = json.loads(tangible("plugins", "--json", cwd=Path()).stdout)
    assert {("depth", "opencv-sgbm"), ("device", "mock")} <= {(method["kind"], method["name"]) for method in methods}
    assert all(method["summary"] and "cannot be read" not in method["summary"] for method in methods)
    ice = json.loads(tangible("materials", "--json", cwd=Path()).stdout)["ice"]
    assert ice["dynamic_friction"] <= 0.1 and ice["source"]
    done = tangible("materials", "show", "sand", cwd=Path())
    for word in ("stiffness_n_per_m", "N/m", "HaTT, sandpaper, 140 Hz", "guess", "stochastic: noise", "140 Hz"):
        assert word in done.stdout
    found = json.loads(tangible("materials", "show", "sand", "--json", cwd=Path()).stdout)
    assert found["sources"]["dynamic_friction"].startswith("HaTT")
    assert found["vibration_hz"] == pytest.approx(140, rel=0.01)
    assert json.loads(tangible("materials", "show", "ice", "--json", cwd=Path()).stdout)["vibration_hz"] is None


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("show", "icee"), "'ice'?"),
        (("shw",), "'show'?"),
        (("show",), "Missing argument"),
        (("--library", "nope.yaml"), "nope.yaml: there is no such file"),
        (("show", "ice", "--library", "bad.yaml"), "bad.yaml:1:7: ice.grain_mm: "),
        (("--json", "show", "ice"), "write the options after 'show'"),
    ],
)
def test_materials_with_a_mistake_reports_it(words: tuple[str, ...], said: str, tmp_path: Path):
    (tmp_path / "bad.yaml").write_text("ice: {grain_mm: 1}\n")
    assert said in mistake("materials", *words, cwd=tmp_path)


def test_schema_prints_json():
    assert "felt" not in json.loads(tangible("schema", "--materials", cwd=Path()).stdout)["properties"]
    assert json.loads(tangible("schema", cwd=Path()).stdout)["properties"]["scene"]


def test_check_of_a_declared_failure_reports_it_and_succeeds(monkeypatch: pytest.MonkeyPatch):
    done = tangible("check", "render", "penalty", cwd=Path())
    assert done.returncode == 0, done.stdout
    assert "0 failed, 1 failed as the method declares" in done.stdout
    monkeypatch.setattr(Penalty, "expected_failures", {"pickle_is_small": "a mistake"})
    done = tangible("check", "render", "penalty", "--json", cwd=Path())
    assert done.returncode == 1
    odd = [check for check in json.loads(done.stdout) if check["passed"] == bool(check["expected_failure"])]
    assert {each["name"]: each["passed"] for each in odd} == {"springs_are_exact": False, "pickle_is_small": True}
    assert "did you mean 'depth'" in mistake("check", "depht", "x", cwd=Path())


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("depth.use=opencv-sgmb", "'opencv-sgbm'?"),
        ("scene.left=nope.png", "nope.png: there is no such file"),
        ("scene.left=p.yaml", "p.yaml"),
        ("scene.left=cut.png", "cut.png"),
        ("scene.left=wide.png", "one size"),
        ("scene={height: nan.npy}", "only NaN"),
        ("materials={8: ice}", "no segment 8"),
        ("materials.rules=[{at: [500, 1], material: ice}]", "outside the picture of 96 x 64 pixels"),
    ],
)
def test_pipeline_file_with_a_mistake_gives_one_clear_line(folder: Path, change: str, said: str):
    (folder / "cut.png").write_bytes((folder / "left.png").read_bytes()[:2000])
    write_png(folder / "wide.png", np.zeros((64, 97), np.uint8))
    np.save(folder / "nan.npy", np.full((8, 8), np.nan))
    message = mistake("run", "p.yaml", "--set", change, "--seconds", 0.1, cwd=folder)
    assert said in message
    assert len(message.splitlines()) == 1, message


def test_output_folder_that_cannot_be_written_stops_the_run_at_once(folder: Path):
    (folder / "file").write_text("")
    message = mistake("run", "p.yaml", "--out", "file/out", cwd=folder)
    assert "cannot be written" in message
    message = mistake("feel", "p.yaml", "--record", "file/hand.npz", cwd=folder)
    assert "cannot be written" in message


@pytest.mark.parametrize(
    "words",
    [
        "feel",
        "feel x.yaml --secondss 3",
        "nope",
        *(f"feel p.yaml --seconds {each}" for each in ("0", "-1", "nan", "x")),
    ],
)
def test_command_line_with_a_mistake_exits_with_2(folder: Path, words: str):
    mistake(*words.split(), cwd=folder)


@pytest.mark.usefixtures("loop_in_thread")
def test_recording_is_replayed_through_any_force_law(folder: Path):
    felt = ("feel", "p.yaml", "--set", "safety.ramp_s=0", "--seconds", 1, "--record", "hand.nc")
    assert tangible(*felt, cwd=folder).returncode == 0
    same = tangible("replay", "hand.nc", "p.yaml", cwd=folder)
    assert same.returncode == 0, same.stderr
    assert "noticed_percent" in same.stdout
    other = ("p.yaml", "--set", "render={use: proxy}")
    document = json.loads(tangible("replay", "hand.nc", *other, "--record", "b.nc", "--json", cwd=folder).stdout)
    assert (document["recorded"]["device"], document["recorded"]["renderer"]) == ("mock", "penalty-gradient")
    figures = document["figures"]
    assert 0 < figures["ns_per_tick"] < 1e8
    assert figures["ticks"] == 1000 >= figures["compared"] > 500  # others are over what the device can give
    assert figures["error_n"] > 1e-3
    again = json.loads(tangible("replay", "b.nc", *other, "--json", cwd=folder).stdout)
    assert again["recorded"]["device"] == "replay of hand.nc"
    assert again["figures"]["worst_error_n"] < 1e-5
    played = tangible("feel", "p.yaml", "--set", "device={use: replay, file: hand.nc}", "--seconds", 1, cwd=folder)
    assert played.returncode == 0, played.stderr


def test_recording_missing_or_cut_off_is_reported(folder: Path):
    assert "there is no such file" in mistake("replay", "none.nc", "p.yaml", cwd=folder)
    assert "end of the name" in mistake("replay", "p.yaml", "p.yaml", "--record", "b.txt", cwd=folder)
    Recording(np.zeros((3, 17)), "the cable is out").save(folder / "cut.nc")
    done = tangible("replay", "cut.nc", "p.yaml", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "the recording ended early: the cable is out" in done.stderr


@pytest.mark.whole
def test_recording_of_a_killed_session_is_readable(folder: Path):
    words = [TANGIBLE, "feel", "p.yaml", "--seconds", "6000", "--record", "hand.nc", "--json"]
    process = subprocess.Popen(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        while not (folder / "hand.nc").exists() or (folder / "hand.nc").stat().st_size < 100_000:
            time.sleep(0.05)
            assert process.poll() is None
        assert "another program is writing to it" in mistake("feel", "p.yaml", "--record", "hand.nc", cwd=folder)
    finally:
        process.kill()
        process.wait()
    recording = Recording.load(folder / "hand.nc")
    assert len(recording.rows) > 1000
    assert recording.stopped.startswith("cut off")
    assert (recording.about.device, recording.about.renderer) == ("mock", "penalty-gradient")
    assert "max_disparity_px: 16" in recording.about.configuration


def test_ctrl_c_exits_with_130_and_leaves_no_half_written_file(folder: Path):
    words = [*HEARING, TANGIBLE, "feel", "p.yaml", "--seconds", "600", "--record", "hand.npz", "--json"]
    process = subprocess.Popen(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    growing = folder / "hand.npz.nc"
    try:
        end = time.monotonic() + 200
        while not growing.exists() or growing.stat().st_size < 50_000:  # until it feels
            assert process.poll() is None and time.monotonic() < end
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130, errors
    assert errors.splitlines()[-1] == "interrupted; what was finished is kept"
    assert "Traceback" not in errors
    assert (folder / "hand.npz").exists() and not growing.exists()
    assert not [path for path in folder.iterdir() if path.name.startswith(".")]


def test_ctrl_c_while_a_run_feels_exits_with_130_and_reports_what_is_kept(
    folder: Path, monkeypatch: pytest.MonkeyPatch
):
    def pressed(report: ServoReport) -> None:
        if not report.stopped:
            raise KeyboardInterrupt

    def felt(touch: Any, device: Any, seconds: float, on_report: object, limits: Any) -> Recording:
        return run_simulated(touch, device, seconds, pressed, limits)

    monkeypatch.setattr(runs, "run_simulated", felt)
    done = tangible("run", "p.yaml", "--seconds", 600, cwd=folder)
    assert done.returncode == 130, done.stderr
    assert "recording.npz has those 0.1 s" in done.stderr
    assert done.stderr.splitlines()[-1] == "interrupted; what was finished is kept"
    assert Recording.load(folder / "out/p/recording.npz").stopped == INTERRUPTED
    assert (folder / "out/p/sheet.png").exists()


@pytest.mark.parametrize("words", ["schema | head -1", "plugins | head -c 0"])
def test_output_to_a_closed_pipe_is_not_an_error(folder: Path, words: str):
    done = subprocess.run(f"{TANGIBLE} {words}", shell=True, cwd=folder, capture_output=True, text=True)
    assert done.stdout in ("{\n", "")
    assert done.stderr == ""


ACME = """\
import sys
import numpy as np
from tangible_core.plugins.interfaces import DepthEstimator, ForceRenderer, PlainTouch
from tangible_core.data import Force

class Odd(Exception):
    def __init__(self, what, where):
        super().__init__(f"{what} in {where}")

class Quits(DepthEstimator):
    '''Ends the program.'''
    def estimate(self, views):
        sys.exit(0)

class FaultyTouch(PlainTouch):
    def __init__(self, fault):
        self.fault = fault
    def force(self, state):
        if self.fault == "quit" and state.position_m[2] < 0.5:
            sys.exit(0)
        if state.position_m[2] < 0.5:
            raise Odd("a fault", "the law")
        return Force(0.0, 0.0, 0.0)

class Faulty(ForceRenderer):
    '''Fails in its first tick.'''
    fault: str = "quit"
    def touch(self, surface):
        return FaultyTouch(self.fault)
"""
"""A distribution of somebody else's whose methods end the program, or raise what cannot be sent to another process."""


@pytest.mark.parametrize(
    ("command", "change", "said"),
    [
        pytest.param("run", "depth={use: quits}", "acme called sys.exit(0)", marks=pytest.mark.whole),
        pytest.param("run", "render={use: faulty}", "acme called sys.exit(0)", marks=pytest.mark.whole),
        ("feel", "render={use: faulty}", "acme called sys.exit(0)"),
        pytest.param("feel", "render={use: faulty, fault: odd}", "a fault in the law", marks=pytest.mark.whole),
    ],
)
def test_plugin_that_exits_or_hangs_does_not_end_the_program(folder: Path, command: str, change: str, said: str):
    points = {"tangible.depth": {"quits": "acme:Quits"}, "tangible.render": {"faulty": "acme:Faulty"}}
    site = distribution(folder / "site", "acme", points, acme=ACME)
    words = [TANGIBLE, command, "p.yaml", "--set", change, "--seconds", "600", "--no-cache"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(site), os.environ.get("PYTHONPATH", "")])}
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, timeout=240)
    assert done.returncode == 2, done.stdout + done.stderr
    assert said in done.stderr
    assert "Traceback" not in done.stderr

"""The habits of a command line, and its help. Otherwise people and scripts would be surprised, or wait for it."""

import io
import json
import logging
import os
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from command_line import tangible
from pictures import write_png
from tangible_core.cli import completing, sentences, show
from tangible_core.cli.app import app
from tangible_core.cli.command_table import COMMANDS, GROUPS, load
from tangible_core.data import DisparityMap, Views
from tangible_core.files.paths import without_folders
from tangible_core.pipeline.engine.cache import Cache
from tangible_core.pipeline.output import default_name
from tangible_core.plugins import hooks
from tangible_core.plugins.notes import note
from tangible_core.plugins.registry import default_registry
from tangible_core.runtime import standard_output
from tangible_depth import Luminance

TANGIBLE = str(Path(sys.executable).with_name("tangible"))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_png(tmp_path / "dot.png", np.arange(64, dtype=np.uint8).reshape(8, 8))
    (tmp_path / "p.yaml").write_text("scene: {photo: dot.png}\nwant: relief\ndepth: {use: luminance}\n")
    return tmp_path


def test_version_option_prints_the_version(tmp_path: Path):
    done = tangible("--version", cwd=tmp_path)
    assert done.returncode == 0
    assert re.match(r"tangible \d+\.\d+\.\d+", done.stdout)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("pluins", "Did you mean 'plugins'"),
        ("doctor", "No such command 'doctor'. Did you mean 'devices doctor'?"),
        ("preflight p.yaml --fix", "`tangible preflight --fix OUT.yaml`"),
        ("--lang en legible --width-m", "`tangible legible --width-m VALUE`"),
        ("feel p.yaml --device falcon", "`tangible feel --set device=VALUE`"),
        ("--lang en run p.yaml --device=falcon", "`tangible run --set device=VALUE`"),
        ("feel p.yaml --devise falcon", "No such option: --devise"),
        ("plugins --device falcon", "No such option: --device"),
        ("run q.yaml", "q.yaml: there is no such file\n"),
        ("run q.yaml -q", "q.yaml: there is no such file\n"),
        ("run pp.yaml", "(did you mean 'p.yaml'?)"),
        ("ui dots.png --no-browser", "(did you mean 'dot.png'?)"),
        ("run leaflet.odt", "leaflet.odt: name a picture"),
        ("new leaflet.pdf", "leaflet.pdf: cannot be read as PDF"),
        ("plugins show depth semi-globl", "'semi-global'?"),
        ("plugins show semi-globl", "'semi-global'?"),
        ("plugins show depth sgm", "(did you mean 'semi-global'?)"),
        ("export dot.png --to pdf", "(did you mean 'swell'?)"),
        ("plan dot.png --set workspace.width=1", "--set workspace.width=1: unknown option"),
        ("check report", "write one of them before it: depth, texture"),
        ("compare semi-globl zncc", "'semi-global'?"),
        ("compare semi-global gabor", "are methods of several kinds"),
        ("batch p.yaml", "p.yaml: has nothing to run over"),
        ("run .", "`tangible batch mine.yaml --over .`"),
        ("run empty.yaml", "the file is empty"),
        ("plan dot.png --set workspace.width_m=80", "for millimetres write 80 mm"),
        ("replay hand.nc p.yaml", "hand.nc: there is no such file"),
        ("legible dot.png --for paper", "'--for': 'paper' is not one of"),
        ("run left.yaml", "this one gives left; right is missing"),
    ],
)
def test_mistake_on_the_command_line_is_refused_with_the_cure(words: str, said: str, folder: Path):
    for name in ("leaflet.pdf", "leaflet.odt"):
        (folder / name).write_bytes(b"%PDF-1.7" if name.endswith("pdf") else b"PK\x03\x04")
    (folder / "empty.yaml").touch()
    (folder / "left.yaml").write_text("scene: {left: dot.png}\n")
    done = tangible(*words.split(), cwd=folder)
    assert (done.returncode, done.stdout) == (2, "")
    assert said in done.stderr
    assert ("a key of the pipeline file" in done.stderr) == (said.startswith("`") and "--set" in said)


def test_views_and_words_of_a_picture_are_told_in_the_language_of_the_terminal(folder: Path):
    assert default_name(Path("cones/left.png"), Path("cones/right.png")) == "cones"
    assert default_name(Path("cones/left.png")) == "left"
    assert default_name(Path("a.png"), Path("b.png")) == "a"
    for name, title in (("left.png", "left.png"), ("right.png", folder.name)):  # a pair only once both are there
        write_png(folder / name, np.eye(8, dtype=np.uint8))
        assert without_folders(str(folder / "left.png")) == title
    for width, asked in (("8", True), ("0.08", False)):
        done = tangible("plan", "p.yaml", "--set", f"workspace.width_m={width}", cwd=folder)
        assert ("if 8 cm are meant, write `width_m: 8 cm`" in done.stderr) == asked
    said = [tangible(*lang, "describe", "p.yaml", cwd=folder).stdout for lang in ((), ("--lang", "de"))]
    assert ["A surface 80 mm wide" in said[0], "Eine Fläche, 80 mm breit" in said[1]] == [True, True]
    tangible("--lang", "de", "export", "dot.png", "--to", "pins", "--out", "out", cwd=folder)
    assert json.loads((folder / "out/dot-monarch.json").read_text("utf-8"))["language"] == "de"


def test_commands_have_examples_and_are_offered_by_completion():
    hooks.tell(default_registry().plugins, "tangible_commands", app=app)
    for name, command in COMMANDS.items():
        assert command.example.startswith(f"tangible {name}") and command.group in GROUPS[:-1], name
        assert load(name).epilog == f"Example: {command.example}"
        for below in getattr(load(name), "commands", {}).values():
            assert not below.get_short_help_str(20).endswith("..."), below.name
    assert complete("tangible pre") == ["preflight"]
    assert complete("tangible run p.yaml --set workspace.wid") == ["workspace.width_m="]


def test_list_of_plugins_fits_a_terminal(monkeypatch: pytest.MonkeyPatch):
    terminal = io.StringIO()
    monkeypatch.setattr(terminal, "isatty", lambda: True)
    for module in (standard_output, show):
        monkeypatch.setattr(module, "stream", lambda: terminal)
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("TERM", "dumb")  # no colours
    load("plugins").main([], standalone_mode=False)
    assert len(lines := terminal.getvalue().splitlines()) > 9 and max(map(len, lines)) <= 80


def test_command_that_cannot_be_imported_is_told_in_one_line(tmp_path: Path):
    code = (
        "import sys; from tangible_core.cli import app, command_table; "
        "command_table.add('broken', 'lacking_module:run', 'Run.'); sys.argv[1:] = ['broken']; app.main()"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode in (1, 2)
    assert "lacking_module" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def complete(words: str) -> list[str]:
    """Return what bash offers after these words."""
    cursor = {"COMP_WORDS": words, "COMP_CWORD": str(len(words.split(" ")) - 1)}
    environment = {**os.environ, "_TANGIBLE_COMPLETE": "complete_bash", **cursor}
    return subprocess.run([TANGIBLE], env=environment, capture_output=True, text=True).stdout.split()


@pytest.mark.parametrize(
    ("unfinished", "offered"),
    [
        ("workspace.wid", ["workspace.width_m="]),
        ("render.use=prox", ["render.use=proxy"]),
        ("scene.set=kitti-2015", ["scene.set=kitti-2015"]),
        ("export.hei", ["export.heights."]),
        ("export.heights.w", ["export.heights.width_m="]),
        ("export.nothing.", []),
        ("scene.name=", []),
    ],
)
def test_completion_offers_keys_of_the_file(unfinished: str, offered: list[str]):
    assert completing.keys(SimpleNamespace(params={}), unfinished) == offered
    assert [name for name, _ in completing.exporters("text,hei")] == ["text,heights"]
    assert "export" in completing.kinds("ex")


def test_cache_clear_deletes_only_results(folder: Path, cache_dir: Path):
    assert tangible("run", "p.yaml", cwd=folder).returncode == 0
    (cache_dir / "holiday.npz").write_bytes(b"somebody's own")
    before = json.loads(tangible("cache", "--json", cwd=folder).stdout)
    assert before["folder"] == str(cache_dir) and before["entries"] == 2 and before["bytes"] > 0
    assert tangible("cache", "clear", cwd=folder).returncode == 2, "there is no terminal to ask on"
    assert Cache().size() == (2, before["bytes"])
    (cache_dir / f".{'cd' * 25}.0123456789ab.tangible").write_bytes(b"half")  # a key has 64 digits, and 50 fit
    gone = json.loads(tangible("cache", "clear", "--yes", "--json", cwd=folder).stdout)
    assert (gone["entries"], gone["bytes"]) == (3, before["bytes"] + 4)
    assert [path.name for path in cache_dir.iterdir()] == ["holiday.npz"]


def test_plugins_show_prints_units_bounds_and_measured_figures(tmp_path: Path):
    for kind, name, words in (
        ("depth", "semi-global", ("Hirschm", "(px, integer", "On builtin/motorcycle")),
        ("device", "mock", ("devices stress mock",)),
        ("export", "heights", ("width_m = null",)),
    ):
        done = tangible("plugins", "show", kind, name, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert not [word for word in (name, *words) if word not in done.stdout]
    found = json.loads(tangible("plugins", "show", "render", "proxy", "--json", cwd=tmp_path).stdout)
    (stiffness,) = [each for each in found["options"] if each["name"] == "stiffness_n_per_m"]
    assert (stiffness["unit"], stiffness["default"]) == ("N/m", "800.0")
    assert found["measured"]["machine"]["processor"] and found["measured"]["figures"]["ns a tick"] > 0


def test_quiet_run_prints_only_requested_output_and_errors(folder: Path):
    done = tangible("run", "p.yaml", "-q", cwd=folder)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert (folder / "out" / "p" / "relief.npz").exists()
    assert tangible("plan", "p.yaml", "-q", cwd=folder).stdout, "the plan is requested output"
    assert json.loads(tangible("run", "p.yaml", "-q", "--json", cwd=folder).stdout)["outcomes"]


def test_command_prints_a_summary_above_its_table(folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("COLUMNS", "200")
    plan = tangible("plan", "p.yaml", cwd=folder).stdout
    assert plan.startswith("`run` would make disparity and relief. Nothing is run now.\n")
    summary, results, following = tangible("run", "p.yaml", cwd=folder).stdout.split("\n\n")
    assert "disparity and relief are made" in summary and "out/p/sheet.png" in results and "tangible ui" in following
    table = tangible("run", "p.yaml", "-v", cwd=folder).stdout
    assert re.search(r"^relief .*\bunchanged\b", table, re.MULTILINE)
    assert all(table.count(text) == 1 for text in ("out/p/relief.npz", "tangible ui"))
    assert tangible("plan", "p.yaml", cwd=folder).stdout.startswith("Nothing is left to run")
    assert "tangible ui dot.yaml" in tangible("parts", "dot.png", cwd=folder).stdout
    figures = {"overruns": 0, "ticks": 500, "seconds": 0.5, "contact_share": 0.931, "peak_force_n": 2.04}
    said = sentences.touch_summary("mock", figures)
    assert all(word in said for word in ("mock", "0.5 s", "93 %", "2.0 N", "every tick came in time"))
    late = sentences.touch_summary("mock", {**figures, "overruns": 9500})
    assert "left out 9500 of 10000 ticks" in late  # each was due, and has not been made up for
    assert "Nothing was found" in tangible("devices", "doctor", "mock", cwd=folder).stdout
    stress = tangible("devices", "stress", "mock", "--seconds", 0.01, cwd=folder).stdout
    assert re.match(r"mock can be read and written \d+ times a second", stress)


def test_warning_on_a_product_is_printed_once_whether_it_is_made_or_cached(
    folder: Path, monkeypatch: pytest.MonkeyPatch
):
    def warn(self: Luminance, views: Views) -> DisparityMap:
        note(logging.getLogger("tangible_depth.luminance"), "hardly any contrast", logging.WARNING)
        return estimate(self, views)

    estimate = Luminance.estimate
    monkeypatch.setattr(Luminance, "estimate", warn)
    for words in (("-v",), ("-v",), (), ("-q",)):
        done = tangible("run", "p.yaml", *words, cwd=folder)
        assert done.stderr == "warning: hardly any contrast\n", words
        assert "hardly any" not in done.stdout
    assert "hardly any contrast" in tangible("plan", "p.yaml", cwd=folder).stdout, "no warning stands elsewhere"


def test_help_imports_neither_numpy_nor_the_pipeline():
    code = (
        "import sys; sys.argv[1:] = ['--help']\nfrom tangible_core.cli import main\ntry: main()\nfinally: "
        "print([name for name in sys.modules if name in ('numpy', 'tangible_core.pipeline')], file=sys.stderr)"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stderr.strip() == "[]"

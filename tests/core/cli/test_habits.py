"""Habits of command lines: --version, completion, a cache that can be cleared, --quiet, narrow terminals."""

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
from standard_sets import LAYOUTS, known
from tangible_core.cli import completing, sentences, show, verbosity
from tangible_core.cli.command_table import COMMANDS, load
from tangible_core.data import DisparityMap, Outcome, Relief, Views
from tangible_core.pipeline.engine.cache import Cache
from tangible_core.plugins.notes import note

TANGIBLE = str(Path(sys.executable).with_name("tangible"))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_png(tmp_path / "dot.png", np.arange(64, dtype=np.uint8).reshape(8, 8))
    (tmp_path / "p.yaml").write_text("scene: {photo: dot.png}\nwant: relief\ndepth: {use: luminance}\n")
    return tmp_path


def test_version_option_prints_the_version(tmp_path: Path):
    done = tangible("--version", cwd=tmp_path)
    assert done.returncode == 0
    assert re.fullmatch(r"tangible \d+\.\d+\.\d+(\.dev\d+)?\n", done.stdout)


@pytest.mark.parametrize("name", COMMANDS)
def test_command_help_begins_with_its_summary_in_the_list(name: str):
    assert (load(name).help or "").split("\n")[0] == COMMANDS[name].summary


def test_misspelt_command_is_refused_with_a_suggestion(tmp_path: Path):
    done = tangible("pluins", cwd=tmp_path)
    assert done.returncode == 2
    assert "Did you mean 'plugins'" in done.stderr


@pytest.mark.parametrize(
    ("words", "takes"),
    [
        (("preflight", "p.yaml", "--fix"), "preflight --fix OUT.yaml"),
        (("legible", "--width-m"), "legible --width-m VALUE"),
        (("--lang", "en", "legible", "--width-m"), "legible --width-m VALUE"),
    ],
)
def test_option_with_nothing_after_it_gets_a_sentence_with_what_it_takes(
    words: tuple[str, ...], takes: str, tmp_path: Path
):
    done = tangible(*words, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr == f"{words[-1]}: has nothing after it; write what it takes, as `tangible {takes}`\n"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("feel p.yaml --device falcon", "`tangible feel --set device=VALUE`"),
        ("--lang en run p.yaml --device=falcon", "`tangible run --set device=VALUE`"),
        ("feel p.yaml --devise falcon", "No such option: --devise"),
        ("plugins --device falcon", "No such option: --device"),
    ],
)
def test_key_of_the_file_as_an_option_is_refused_with_how_to_set_it(words: str, said: str, tmp_path: Path):
    done = tangible(*words.split(), cwd=tmp_path)
    assert done.returncode == 2
    assert said in done.stderr
    assert ("--device: no such option, but a key of the pipeline file" in done.stderr) == ("--set" in said)


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
    variables = {
        "_TANGIBLE_COMPLETE": "complete_bash",
        "COMP_WORDS": words,
        "COMP_CWORD": str(len(words.split(" ")) - 1),
    }
    return subprocess.run([TANGIBLE], env={**os.environ, **variables}, capture_output=True, text=True).stdout.split(
        "\n"
    )


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("tangible pre", ["preflight"]),
        ("tangible plugins show depth semi", ["semi-global"]),
        ("tangible run builtin/m", ["builtin/motorcycle"]),
        ("tangible run p.yaml --set workspace.wid", ["workspace.width_m="]),
        ("tangible run p.yaml --set render.use=prox", ["render.use=proxy"]),
        ("tangible run p.yaml --set scene.set=kitti-2015", ["scene.set=kitti-2015"]),
        ("tangible compare kitti-2015", ["kitti-2015"]),
    ],
)
def test_completion_offers_commands_methods_scenes_and_keys(words: str, offered: list[str]):
    assert [word for word in complete(words) if word] == offered


def test_completion_offers_the_pairs_of_a_standard_set(tmp_path: Path):
    LAYOUTS["eth3d"].make(tmp_path, known())
    words = ["scene.set=eth3d", f"scene.folder={tmp_path}"]
    assert completing.keys(SimpleNamespace(params={"sets": words}), "scene.name=deli") == [
        "scene.name=delivery_area_1l"
    ]
    for unfinished in ([], words[:1], ["scene=3"], [*words, "scene.split=no"]):
        assert completing.keys(SimpleNamespace(params={"sets": unfinished}), "scene.name=") == []


def test_completion_is_installed_where_the_shell_looks(tmp_path: Path):
    words = ["bash", "-c", f"{TANGIBLE} --install-completion bash; true"]
    variables = {"HOME": str(tmp_path), "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    done = subprocess.run(words, env={**os.environ, **variables}, capture_output=True, text=True)
    assert "completion installed" in done.stdout, done.stderr
    (script,) = tmp_path.glob(".bash_completions/*")
    assert "_TANGIBLE_COMPLETE" in script.read_text()
    assert str(script) in (tmp_path / ".bashrc").read_text()


def test_cache_clear_deletes_only_results(folder: Path, cache_dir: Path):
    assert tangible("run", "p.yaml", cwd=folder).returncode == 0
    (cache_dir / "holiday.npz").write_bytes(b"somebody's own")
    before = json.loads(tangible("cache", "--json", cwd=folder).stdout)
    assert before["folder"] == str(cache_dir) and before["entries"] == 2 and before["bytes"] > 0
    refused = tangible("cache", "clear", cwd=folder)
    assert (refused.returncode, refused.stderr.count("--yes")) == (2, 1), "there is no terminal to ask on"
    assert Cache().size() == (2, before["bytes"])
    gone = json.loads(tangible("cache", "clear", "--yes", "--json", cwd=folder).stdout)
    assert (gone["entries"], gone["bytes"]) == (2, before["bytes"])
    assert [path.name for path in cache_dir.iterdir()] == ["holiday.npz"]
    assert "0 results" in tangible("cache", cwd=folder).stdout


def test_cache_clear_deletes_temporary_files_of_killed_writers(cache_dir: Path):
    Cache().put("ab" * 16, Relief(np.zeros((2, 2), np.float32), (1.0, 1.0)))
    (cache_dir / f".{'cd' * 25}.0123456789ab.tangible").write_bytes(b"half")  # a key has 64 digits, and 50 fit
    assert Cache().clear()[0] == 2
    assert list(cache_dir.iterdir()) == []


def test_plugins_show_prints_units_bounds_and_measured_figures(tmp_path: Path):
    done = tangible("plugins", "show", "depth", "semi-global", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for word in (
        "semi-global is a depth method of tangible-images",
        "Hirschm",
        "(px, integer",
        "On builtin/motorcycle",
    ):
        assert word in done.stdout
    found = json.loads(tangible("plugins", "show", "render", "proxy", "--json", cwd=tmp_path).stdout)
    (stiffness,) = [each for each in found["options"] if each["name"] == "stiffness_n_per_m"]
    assert (stiffness["unit"], stiffness["default"]) == ("N/m", "800.0")
    assert found["measured"]["machine"]["processor"] and found["measured"]["figures"]["ns a tick"] > 0
    assert "devices stress mock" in tangible("plugins", "show", "device", "mock", cwd=tmp_path).stdout
    missing = tangible("plugins", "show", "depth", "semi-globl", cwd=tmp_path)
    assert missing.returncode == 2 and "did you mean 'semi-global'?" in missing.stderr


def test_quiet_run_prints_only_requested_output_and_errors(folder: Path):
    done = tangible("run", "p.yaml", "-q", cwd=folder)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert (folder / "out" / "p" / "relief.npz").exists()
    assert tangible("plan", "p.yaml", "-q", cwd=folder).stdout, "the plan is requested output"
    assert json.loads(tangible("run", "p.yaml", "-q", "--json", cwd=folder).stdout)["outcomes"]
    assert "no such file" in tangible("run", "q.yaml", "-q", cwd=folder).stderr


def test_log_message_without_log_level_is_a_plain_sentence(caplog: pytest.LogCaptureFixture):
    formatter = verbosity._Plain()
    compiling = logging.LogRecord("tangible_core.compiled.compiling", logging.INFO, "", 0, "compiling", None, None)
    lost = logging.LogRecord("tangible_core.session.live", logging.WARNING, "", 0, "3 ticks were lost", None, None)
    assert [formatter.format(each) for each in (compiling, lost)] == ["compiling", "warning: 3 ticks were lost"]


WORDS = "the disparity map is given, and the file /somewhere/very/deeply/nested/in/a/long/path/left_view.png[1] says so"


@pytest.mark.parametrize("width", [20, 40, 80, 200])
def test_table_on_a_terminal_of_any_width_loses_no_text(
    width: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setenv("COLUMNS", str(width))
    show.outcomes([Outcome("disparity", "ran", WORDS, "semi-global", 0.75)], "a title")
    output = "".join(capsys.readouterr().out.split())
    for text in ("disparity", "semi-global", "0.750", *WORDS.split()):
        assert text in output, width


@pytest.mark.parametrize("words", [["materials"], ["devices"], ["plan", "p.yaml"], ["--help"]])
def test_output_on_forty_columns_loses_no_word(words: list[str], folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("COLUMNS", "200")
    wide = tangible(*words, cwd=folder).stdout
    monkeypatch.setenv("COLUMNS", "40")
    narrow = tangible(*words, cwd=folder).stdout
    assert "…" not in narrow
    missing = set(re.findall(r"\w+", wide)) - set(re.findall(r"\w+", narrow.replace("\n", " ")))
    joined = "".join(narrow.split())
    empty = {"product", "serial", "seconds", "where"}  # headings of a name, and of columns without a value
    assert not [word for word in missing - empty if word not in joined]


def test_command_prints_a_summary_above_its_table(folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("COLUMNS", "200")
    plan = tangible("plan", "p.yaml", cwd=folder).stdout
    assert plan.startswith("`run` would make disparity and relief. Nothing is run now.\n")
    run = tangible("run", "p.yaml", cwd=folder).stdout
    assert run == (
        "dot.png is done: its disparity and relief are made.\n\n"
        "Results: out/p; look at out/p/sheet.png\n\n"
        "Next:\n  tangible ui p.yaml  see it, hear it and feel it with the mouse, on a page in the browser\n"
    )
    table = tangible("run", "p.yaml", "-v", cwd=folder).stdout
    assert re.search(r"^relief .*\bunchanged\b", table, re.MULTILINE)
    assert all(table.count(text) == 1 for text in ("out/p/relief.npz", "tangible ui"))
    assert tangible("plan", "p.yaml", cwd=folder).stdout.startswith("Nothing is left to run")
    figures = {"overruns": 0, "ticks": 500, "seconds": 0.5, "contact_share": 0.931, "peak_force_n": 2.04}
    assert sentences.touch_summary("mock", figures) == (
        "mock was felt for 0.5 s, 93 % of it in contact, with forces of up to 2.0 N; every tick came in time."
    )
    late = sentences.touch_summary("mock", {**figures, "overruns": 9500})
    assert "the loop was late, and left out 9500 of 10000 ticks" in late  # each was due, and has not been made up for
    nothing = sentences.replay_summary("proxy", {"compared": 0, "error_percent": float("nan"), "noticed_percent": 0.0})
    assert nothing.startswith("Nothing was felt")
    check = tangible("check", "render", "penalty", cwd=folder).stdout
    assert re.match(r"render method penalty passes all \d+ conformance checks\.", check)
    assert tangible("devices", "doctor", "mock", cwd=folder).stdout.startswith("Nothing was found that keeps mock from")
    stress = tangible("devices", "stress", "mock", "--seconds", 0.01, cwd=folder).stdout
    assert re.match(r"mock can be read and written \d+ times a second", stress)


NOTHING = SimpleNamespace(params={})


def test_completion_offers_exporters_and_their_options():
    from tangible_core.cli import completing

    assert ("text,heights", True) in [(name, bool(says)) for name, says in completing.exporters("text,hei")]
    assert [name for name, _ in completing.exporters("hei")] == ["heights"]
    assert completing.keys(NOTHING, "export.hei") == ["export.heights."]
    assert completing.keys(NOTHING, "export.heights.w") == ["export.heights.width_m="]
    assert completing.keys(NOTHING, "export.nothing.") == []
    assert "simplify.gap_m=" in completing.keys(NOTHING, "simplify")
    assert "export" in completing.kinds("ex")


def test_plugins_show_prints_the_options_of_an_exporter(tmp_path: Path):
    ran = tangible("plugins", "show", "export", "heights", cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.startswith("heights is an exporter of tangible-images")
    assert "width_m = null" in ran.stdout
    assert re.search("^export +heights", tangible("plugins", cwd=tmp_path).stdout, re.MULTILINE)


def test_warning_on_a_product_is_printed_once_whether_it_is_made_or_cached(
    folder: Path, monkeypatch: pytest.MonkeyPatch
):
    from tangible_depth.luminance import Luminance

    estimate = Luminance.estimate

    def warn(self: Luminance, views: Views) -> DisparityMap:
        note(logging.getLogger("tangible_depth.luminance"), "hardly any contrast", logging.WARNING)
        return estimate(self, views)

    monkeypatch.setattr(Luminance, "estimate", warn)
    for words in (("-v",), ("-v",), (), ("-q",)):
        done = tangible("run", "p.yaml", *words, cwd=folder)
        assert done.stderr == "warning: hardly any contrast\n", words
        assert "hardly any" not in done.stdout
    assert "hardly any contrast" in tangible("plan", "p.yaml", cwd=folder).stdout, "no warning stands elsewhere"


@pytest.mark.parametrize("command", ["new", "run", "plan", "legible"])
def test_file_that_is_not_a_picture_gets_the_same_sentence_everywhere(command: str, folder: Path):
    (folder / "leaflet.pdf").write_bytes(b"%PDF-1.7")
    done = tangible(command, "leaflet.pdf", cwd=folder)
    said = "leaflet.pdf: name a picture (.png, .jpg, ...), left and right, a video, or a map of heights (.npy)\n"
    assert (done.returncode, done.stderr) == (2, said)


def test_page_of_a_missing_file_is_not_opened(folder: Path):
    done = tangible("ui", "dots.png", "--no-browser", cwd=folder)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "dots.png: there is no such file (did you mean 'dot.png'?)\n"


def test_name_with_only_its_ending_in_common_is_not_suggested(folder: Path):
    assert tangible("run", "q.yaml", cwd=folder).stderr == "q.yaml: there is no such file\n"
    assert tangible("run", "pp.yaml", cwd=folder).stderr.endswith("(did you mean 'p.yaml'?)\n")


@pytest.mark.parametrize("command", ["new", "parts"])
def test_command_that_prepares_a_file_names_the_page_next(command: str, folder: Path):
    done = tangible(command, "dot.png", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert re.search(r"^  tangible ui dot\.yaml  ", done.stdout, re.MULTILINE)

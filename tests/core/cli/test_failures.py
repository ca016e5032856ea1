"""Whatever a plugin does, a person is told one sentence; the traceback is in a file that it names."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from command_line import Done, tangible
from tangible_core.cli import app
from tangible_core.errors import ConfigError
from tangible_core.plugins.registry import default_registry

ACME = """
import numpy as np
from tangible_core import DisparityMap
from tangible_core.plugins import DepthEstimator, DeviceSpec, ForceRenderer, HapticDevice, PlainTouch, Segmenter
from tangible_core.data import Force


class Depth(DepthEstimator):
    '''Fails as it is told.'''
    fault: str = "raises"

    def estimate(self, views):
        if self.fault == "raises":
            raise KeyError("no\\nkey")
        return {"an array": np.zeros((2, 3)), "nothing": None, "a list": [[0.0] * 6] * 4}[self.fault]


class Texture(Segmenter):
    '''Calls what fails.'''

    def segment(self, picture):
        return helper()


def helper():
    return 1 // 0


class LawTouch(PlainTouch):
    stiffness_n_per_m = 0.0

    def __init__(self, fault):
        self.fault = fault

    def force(self, state):
        if state.position_m[2] > 0.5:
            return Force(0.0, 0.0, 0.0)
        return {"nothing": None, "two": (0.0, 1.0), "three": [0, 0, 0]}[self.fault]


class Law(ForceRenderer):
    '''Gives what its option says.'''
    fault: str = "raises"

    def touch(self, surface):
        return 7 if self.fault == "no touch" else LawTouch(self.fault)


class Device(HapticDevice):
    '''Knows nothing of itself.'''
    fault: str = "raises"

    def spec(self):
        if self.fault == "raises":
            raise OSError("no such wire")

    def open(self):
        pass
"""
POINTS = {
    "tangible.depth": {"depth": "acme:Depth"},
    "tangible.texture": {"texture": "acme:Texture"},
    "tangible.render": {"law": "acme:Law"},
    "tangible.device": {"device": "acme:Device", "mock": "tangible_devices:Mock"},
}


@pytest.fixture
def folder(tmp_path: Path, install) -> Iterator[Path]:
    """A picture, and a world of one distribution whose plugins all fail."""
    install("acme", POINTS, acme=ACME)
    np.save(tmp_path / "a.npy", np.arange(24, dtype=np.uint8).reshape(4, 6))
    tmp_path.joinpath("p.yaml").write_text("scene: {photo: a.npy}\nwant: disparity\ndepth: {use: depth}\n")
    tmp_path.joinpath("h.yaml").write_text("scene: {height: a.npy}\nrender: {use: law}\ndevice: {use: mock}\n")
    default_registry.cache_clear()
    yield tmp_path
    default_registry.cache_clear()


def failed(done: Done, code: int = 2) -> str:
    """The one line that is said, beside that kernels are compiled."""
    assert done.returncode == code, done.stderr
    assert done.stdout == ""
    (line,) = (line for line in done.stderr.splitlines() if "compiling" not in line)
    return line


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["p.yaml"], r"depth method depth (acme 1.0) failed in estimate: KeyError: 'no\nkey'"),
        (
            ["p.yaml", "--set", "want=segments", "--set", "texture=texture"],
            "texture method texture (acme 1.0) failed in segment: "
            "ZeroDivisionError: integer division or modulo by zero",
        ),
        (
            ["h.yaml", "--set", "want=touch"],
            "render method law (acme 1.0) failed in force: KeyError: 'raises'",
        ),
        (
            ["h.yaml", "--set", "want=touch", "--set", "render.fault=nothing", "--set", "device=device"],
            "device method device (acme 1.0) failed in spec: OSError: no such wire",
        ),
    ],
    ids=["depth", "texture", "law", "device"],
)
def test_a_plugin_that_raises(folder: Path, log_dir: Path, words: list[str], said: str):
    log = log_dir / "failures.log"
    assert failed(tangible("run", *words, "--seconds", "0.1", cwd=folder)) == f"{said}; the traceback is in {log}"
    assert "Traceback" in log.read_text()
    assert "acme.py" in log.read_text()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["p.yaml", "depth.fault=an array"], "depth (acme 1.0): estimate gave an array of float64 (2, 3); it must"),
        (["p.yaml", "depth.fault=nothing"], "depth (acme 1.0): estimate gave None; it must give a DisparityMap"),
        (["h.yaml", "want=touch", "render.fault=no touch"], "law (acme 1.0): touch gave the int 7; it must give"),
        (["h.yaml", "want=touch", "render.fault=nothing"], "law (acme 1.0): force gave None; it must give a Force"),
        (["h.yaml", "want=touch", "render.fault=two"], "law (acme 1.0): force gave the tuple (0.0, 1.0); it must"),
        (["h.yaml", "want=touch", "device={use: device, fault: x}"], "device (acme 1.0): spec gave None; it must give"),
    ],
)  # fmt: skip
def test_a_plugin_that_gives_the_wrong_thing(folder: Path, words: list[str], said: str):
    path, *sets = words
    options = [word for each in sets for word in ("--set", each)]
    assert said in failed(tangible("run", path, *options, "--seconds", "0.1", cwd=folder))


def test_three_numbers_are_a_force(folder: Path):
    words = ("--set", "want=touch", "--set", "render.fault=three", "--seconds", "0.1")
    assert tangible("run", "h.yaml", *words, cwd=folder).returncode == 0


def test_a_law_that_raises_in_the_process_of_the_force_loop(folder: Path, log_dir: Path):
    said = failed(tangible("feel", "h.yaml", "--seconds", "60", cwd=folder))
    assert said.startswith("render method law (acme 1.0) failed in force: KeyError: 'raises'; the traceback is in")
    _, _, there = (log_dir / "failures.log").read_text().partition("In the process that it came from")
    assert 'acme.py", line' in there


def test_a_device_that_fails_costs_its_own_row(folder: Path):
    listed = tangible("devices", "--json", cwd=folder)
    assert listed.returncode == 0, listed.stderr
    assert "device method device (acme 1.0) failed in spec: OSError: no such wire" in listed.stdout
    assert '"simulated": true' in listed.stdout
    examined = tangible("devices", "doctor", "device", "--json", cwd=folder)
    assert examined.returncode == 1
    assert "failed in spec: OSError: no such wire" in examined.stdout


def test_a_plugin_that_cannot_be_imported(folder: Path, install, log_dir: Path):
    install("broken", {"tangible.depth": {"broken": "broken:Depth"}}, broken="1 / 0")
    said = failed(tangible("run", "p.yaml", "--set", "depth=broken", cwd=folder))
    assert "depth method 'broken' (broken:Depth, from broken 1.0) cannot be loaded: ZeroDivisionError" in said
    assert said.endswith(f"the traceback is in {log_dir / 'failures.log'}")


def test_a_fault_of_our_own_is_one_line_too(folder: Path, log_dir: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("tangible_core.cli.commands.run.open_pipeline", lambda *_: [][0])
    said = failed(tangible("plan", "p.yaml", cwd=folder), code=1)
    assert said.startswith("tangible itself failed: IndexError: list index out of range; please report it: ")
    assert "Traceback" in (log_dir / "failures.log").read_text()


def test_a_log_that_cannot_be_written(folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("TANGIBLE_LOG_DIR", str(folder / "p.yaml"))
    said = failed(tangible("run", "p.yaml", cwd=folder))
    assert "KeyError" in said and said.endswith("--log-level debug shows it")
    shown = tangible("run", "p.yaml", "--log-level", "tangible_core.plugins.failures=debug", cwd=folder)
    assert "Traceback" in shown.stderr


def test_a_log_that_grew_large_begins_anew(folder: Path, log_dir: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("tangible_core.runtime.failure_log.MOST_BYTES", 10)
    for _ in range(3):
        tangible("run", "p.yaml", cwd=folder)
    assert sorted(path.name for path in log_dir.iterdir()) == ["failures.log", "failures.old.log"]
    assert all(path.read_text().count("tangible run p.yaml") == 1 for path in log_dir.iterdir())


def test_a_current_folder_that_was_deleted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    with pytest.raises(ConfigError, match="the current folder was deleted"):
        app._check_folder()


class TestHomes:
    @pytest.fixture(autouse=True)
    def home(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
        """A home beside the current folder."""
        home = folder / "home"
        home.mkdir()
        folder.joinpath("a.npy").rename(home / "a.npy")
        home.joinpath("p.yaml").write_text("scene: {photo: ~/a.npy}\nwant: views\n")
        monkeypatch.setenv("HOME", str(home))
        return home

    def test_in_a_file_and_on_the_command_line(self, folder: Path, home: Path):
        text = "scene: {height: ~/a.npy}\nwant: surface\n"
        home.joinpath("p.yaml").write_text(text)
        done = tangible("run", "~/p.yaml", "--out=~/out", cwd=folder)
        assert done.returncode == 0, done.stderr
        assert (home / "out" / "surface.npz").exists()
        assert not (folder / "~").exists()
        library = home / "mine.yaml"
        assert failed(tangible("materials", "--library=~/mine.yaml", cwd=folder)).startswith(f"{library}: there is no")
        done = tangible("plan", "~/p.yaml", "--set", "scene={photo: ~/a.npy}", "--set", "depth=depth", cwd=folder)
        assert done.returncode == 0, done.stderr

    def test_of_somebody_whom_nobody_knows(self, folder: Path):
        said = "~nobody-here/a.npy: no user here is named 'nobody-here', and `~` names a home"
        for words in (("plan", "~nobody-here/a.npy"), ("plan", "p.yaml", "--set", "scene.photo=~nobody-here/a.npy")):
            assert failed(tangible(*words, cwd=folder)).endswith(said)

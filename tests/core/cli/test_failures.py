"""Failures of plugins. Otherwise a user would see a traceback, and not know whose fault it is."""

import stat
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from command_line import Done, tangible
from tangible_core.plugins.registry import default_registry
from tangible_core.runtime.failure_log import keep

ACME = """
import numpy as np
from tangible_core import DisparityMap
from tangible_core.plugins import DepthEstimator, DeviceSpec, ForceRenderer, HapticDevice, PlainTouch, Segmenter
from tangible_core.data import Force


class Depth(DepthEstimator):
    '''A method that fails as its option says.'''
    fault: str = "raises"

    def estimate(self, views):
        if self.fault == "raises":
            raise KeyError("no\\nkey")
        return {"an array": np.zeros((2, 3)), "nothing": None, "a list": [[0.0] * 6] * 4}[self.fault]


class Texture(Segmenter):
    '''A method whose helper fails.'''

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
    '''A law that returns what its option says.'''
    fault: str = "raises"

    def touch(self, surface):
        return 7 if self.fault == "no touch" else LawTouch(self.fault)


class Device(HapticDevice):
    '''A device without a spec.'''
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
    "tangible.hooks": {"devices": "tangible_devices.commands", "report": "tangible_report.commands"},
}


@pytest.fixture
def folder(tmp_path: Path, install) -> Iterator[Path]:
    """Return a folder with a picture; the one installed distribution has only plugins that fail."""
    install("acme", POINTS, acme=ACME)
    np.save(tmp_path / "a.npy", np.arange(24, dtype=np.uint8).reshape(4, 6))
    tmp_path.joinpath("p.yaml").write_text("scene: {photo: a.npy}\nwant: disparity\ndepth: {use: depth}\n")
    tmp_path.joinpath("h.yaml").write_text("scene: {height: a.npy}\nrender: {use: law}\ndevice: {use: mock}\n")
    default_registry.cache_clear()
    yield tmp_path
    default_registry.cache_clear()


def failure(done: Done, code: int = 2) -> str:
    """Return the only line on standard error, apart from the notice that kernels are compiled."""
    assert done.returncode == code, done.stderr
    assert done.stdout == ""
    (line,) = (line for line in done.stderr.splitlines() if "compiling" not in line)
    return line


def run(folder: Path, file: str, *sets: str) -> Done:
    """Run a file for a moment, with these values in place of its own."""
    return tangible("run", file, *(word for each in sets for word in ("--set", each)), "--seconds", "0.1", cwd=folder)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["p.yaml"], r"depth method depth (acme 1.0) failed in estimate: KeyError: 'no\nkey'"),
        (["p.yaml", "want=segments", "texture=texture"], "texture (acme 1.0) failed in segment: ZeroDivisionError"),
        (["h.yaml", "want=touch"], "law (acme 1.0) failed in force: KeyError: 'raises'"),
        (["h.yaml", "want=touch", "render.fault=nothing", "device=device"], "device (acme 1.0) failed in spec: OSErr"),
        (["p.yaml", "depth=broken"], "(broken:Depth, from broken 1.0) cannot be loaded: ZeroDivisionError"),
    ],
    ids=["depth", "texture", "law", "device", "import"],
)  # fmt: skip
def test_plugin_that_raises_gives_one_sentence_and_a_log(
    folder: Path, install, log_dir: Path, words: list[str], message: str
):
    install("broken", {"tangible.depth": {"broken": "broken:Depth"}}, broken="1 / 0")
    log = log_dir / "failures.log"
    said = failure(run(folder, *words))
    assert message in said and said.endswith(f"; the traceback is in {log}")
    assert "Traceback" in log.read_text()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["p.yaml", "depth.fault=an array"], "depth (acme 1.0): estimate gave an array of float64 (2, 3); it must"),
        (["p.yaml", "depth.fault=nothing"], "depth (acme 1.0): estimate gave None; it must give a DisparityMap"),
        (["h.yaml", "want=touch", "render.fault=no touch"], "law (acme 1.0): touch gave the int 7; it must give"),
        (["h.yaml", "want=touch", "render.fault=nothing"], "law (acme 1.0): force gave None; it must give a Force"),
        (["h.yaml", "want=touch", "render.fault=two"], "law (acme 1.0): force gave the tuple (0.0, 1.0); it must"),
        (["h.yaml", "want=touch", "device={use: device, fault: x}"], "device (acme 1.0): spec gave None; it must give"),
    ],
)  # fmt: skip
def test_plugin_that_returns_a_wrong_type_is_named_in_one_sentence(folder: Path, words: list[str], message: str):
    assert message in failure(run(folder, *words))
    assert run(folder, "h.yaml", "want=touch", "render.fault=three").returncode == 0


def test_force_law_raising_in_the_loop_process_is_reported_with_its_traceback(folder: Path, log_dir: Path):
    message = failure(tangible("feel", "h.yaml", "--seconds", "60", cwd=folder))
    assert message.startswith("render method law (acme 1.0) failed in force: KeyError: 'raises'; the traceback is in")
    _, _, there = (log_dir / "failures.log").read_text().partition("In the process that it came from")
    assert 'acme.py", line' in there


def test_device_that_fails_spoils_only_its_own_row(folder: Path):
    listing = tangible("devices", "--json", cwd=folder)
    assert listing.returncode == 0, listing.stderr
    assert "device method device (acme 1.0) failed in spec: OSError: no such wire" in listing.stdout
    assert '"simulated": true' in listing.stdout
    examined = tangible("devices", "doctor", "device", "--json", cwd=folder)
    assert examined.returncode == 1
    assert "failed in spec: OSError: no such wire" in examined.stdout


def test_fault_of_the_program_gives_one_line_and_code_1(folder: Path, log_dir: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("tangible_core.cli.commands.run.open_pipeline", lambda *_: [][0])
    message = failure(tangible("plan", "p.yaml", cwd=folder), code=1)
    assert message.startswith("tangible itself failed: IndexError: list index out of range; please report it: ")
    assert "Traceback" in (log_dir / "failures.log").read_text()


def test_failure_log_is_bounded_and_said_where_it_cannot_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, folder: Path
):
    monkeypatch.setattr("tangible_core.runtime.failure_log.MAX_BYTES", 10)
    monkeypatch.setenv("TANGIBLE_LOG_DIR", str(tmp_path / "logs"))
    for secret in "abc":
        path = keep(ValueError(secret))
    assert [stat.S_IMODE(each.stat().st_mode) for each in (path.parent, path)] == [0o700, 0o600]
    assert sorted(each.name for each in path.parent.iterdir()) == ["failures.log", "failures.old.log"]
    assert all(each.read_text().count("ValueError") == 1 for each in path.parent.iterdir())
    monkeypatch.setenv("TANGIBLE_LOG_DIR", str(folder / "p.yaml"))
    assert failure(run(folder, "p.yaml")).endswith("--log-level debug shows it")
    logged = tangible("run", "p.yaml", "--log-level", "tangible_core.plugins.failures=debug", cwd=folder)
    assert "Traceback" in logged.stderr


class TestHomes:
    @pytest.fixture(autouse=True)
    def home(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
        """Create a home next to the current folder."""
        home = folder / "home"
        home.mkdir()
        folder.joinpath("a.npy").rename(home / "a.npy")
        home.joinpath("p.yaml").write_text("scene: {photo: ~/a.npy}\nwant: views\n")
        monkeypatch.setenv("HOME", str(home))
        return home

    def test_home_is_expanded_and_that_of_an_unknown_user_refused(self, folder: Path, home: Path):
        text = "scene: {height: ~/a.npy}\nwant: surface\n"
        home.joinpath("p.yaml").write_text(text)
        done = tangible("run", "~/p.yaml", "--out=~/out", cwd=folder)
        assert done.returncode == 0, done.stderr
        assert (home / "out" / "surface.npz").exists()
        assert not (folder / "~").exists()
        library = home / "mine.yaml"
        assert failure(tangible("materials", "--library=~/mine.yaml", cwd=folder)).startswith(f"{library}: there is no")
        done = tangible("plan", "~/p.yaml", "--set", "scene={photo: ~/a.npy}", "--set", "depth=depth", cwd=folder)
        assert done.returncode == 0, done.stderr
        message = "~nobody-here/a.npy: no user here is named 'nobody-here', and `~` names a home"
        for words in (("plan", "~nobody-here/a.npy"), ("plan", "p.yaml", "--set", "scene.photo=~nobody-here/a.npy")):
            assert failure(tangible(*words, cwd=folder)).endswith(message)

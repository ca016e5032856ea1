"""Standard output is the program's: whatever a plugin prints, in whatever way, goes to standard error."""

import fcntl
import io
import json
import os
import pty
import re
import struct
import subprocess
import sys
import termios
from pathlib import Path
from typing import Any

import pytest

from distributions import distribution
from tangible_core.runtime.standard_output import protect, stream

TANGIBLE = str(Path(sys.executable).with_name("tangible"))
NOISY = '''
import ctypes, os, subprocess, sys
from tangible_core import DisparityMap
from tangible_core.plugins import DepthEstimator, hookimpl
import numpy as np

C = ctypes.CDLL(None)


def noise(where):
    print(f"print {where}")
    if sys.stdout:
        sys.stdout.write(f"write {where}\\n")
    os.write(1, f"file 1 {where}\\n".encode())
    C.printf(f"C {where}\\n".encode())
    subprocess.run([sys.executable, "-c", f"print('process {where}')"], check=True)


noise("at import")


class Noisy(DepthEstimator):
    """Talks all the time."""

    def estimate(self, views):
        noise("in estimate")
        return DisparityMap(np.zeros(views.shape, np.float32))


@hookimpl
def tangible_stage_started(product, method):
    noise("while watching")


@hookimpl
def tangible_commands(app):
    noise("at the start")

    @app.command()
    def hello():
        print("hello from a command of somebody else's")
'''
WAYS = ("print", "write", "file 1", "C", "process")
PIPELINE = """\
scene: {left: left.png, right: left.png}
want: disparity
depth: {use: noisy}
"""
COMPARE = """\
compare: depth
methods: [noisy]
scenes: [{synthetic: steps, width_px: 64, height_px: 32}]
repeats: 1
warmups: 0
calls: 1
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to work in, with a plugin installed that talks."""
    import numpy as np

    from pictures import write_png

    points = {"tangible.depth": {"noisy": "noisy:Noisy"}, "tangible.hooks": {"n": "noisy"}}
    site = distribution(tmp_path / "site", "noisy", points, noisy=NOISY)
    monkeypatch.setenv("PYTHONPATH", str(site))
    monkeypatch.delenv("PYTHONUNBUFFERED", raising=False)  # it is C's buffer too
    write_png(tmp_path / "left.png", np.random.default_rng(0).integers(0, 255, (16, 24), np.uint8))
    tmp_path.joinpath("p.yaml").write_text(PIPELINE)
    tmp_path.joinpath("c.yaml").write_text(COMPARE)
    return tmp_path


def tangible(folder: Path, *words: str, **how: Any) -> subprocess.CompletedProcess[str]:
    how = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **how}
    return subprocess.run([TANGIBLE, *words], cwd=folder, text=True, timeout=240, **how)


class TestPlugins:
    @pytest.mark.parametrize(
        ("words", "where"),
        [
            (["run", "p.yaml", "--no-cache", "--json"], {"at import", "at the start", "while watching", "in estimate"}),
            (["plan", "p.yaml", "--json"], {"at import", "at the start"}),
            (["plugins", "--json"], {"at import", "at the start"}),
            (["devices", "--json"], {"at import", "at the start"}),
            (["materials", "show", "wood", "--json"], {"at import", "at the start"}),
            (["check", "depth", "noisy", "--json"], {"at import", "at the start", "in estimate"}),
            (["compare", "c.yaml", "--json"], {"at import", "at the start", "while watching"}),
            (["schema"], {"at import", "at the start"}),
        ],
        ids=lambda words: words[0] if isinstance(words, list) else "",
    )
    def test_json_is_all_that_is_on_standard_output(self, folder: Path, words: list[str], where: set[str]) -> None:
        done = tangible(folder, *words)
        json.loads(done.stdout)
        said = {
            line
            for line in done.stderr.splitlines()
            if line.split(" ")[0] in ("print", "write", "file", "C", "process")
        }
        assert said == {f"{way} {place}" for way in WAYS for place in where}

    @pytest.mark.parametrize("words", [["plan", "none.yaml"], ["check", "depth", "nosy"], ["plugins", "--jsn"]])
    def test_nothing_is_on_standard_output_after_a_mistake(self, folder: Path, words: list[str]) -> None:
        done = tangible(folder, *words)
        assert (done.returncode, done.stdout) == (2, "")
        assert "C at import" in done.stderr

    def test_what_is_for_people_is_the_programs_alone_too(self, folder: Path) -> None:
        done = tangible(folder, "run", "p.yaml", "--no-cache")
        assert done.returncode == 0, done.stderr
        assert "".join(done.stdout.split()).startswith(str(folder / "left.png"))  # a long path is broken
        assert not any(way in done.stdout for way in ("print ", "write ", "file 1", "C at", "C in", "process "))

    def test_help_and_the_commands_of_others_write_as_they_like(self, folder: Path) -> None:
        assert tangible(folder, "hello").stdout.splitlines()[-1] == "hello from a command of somebody else's"
        for words in (["--help"], ["run", "--help"], ["devices", "doctor", "--help"]):
            done = tangible(folder, *words)
            assert "Usage: tangible" in done.stdout
            assert "print at import" in done.stderr


class TestTheStreams:
    @pytest.mark.parametrize("words", [["plugins"], ["plugins", "--json"], ["materials"]])
    @pytest.mark.parametrize("lines", [0, 1])
    def test_a_reader_that_goes_away_is_no_error(self, folder: Path, words: list[str], lines: int) -> None:
        done = subprocess.run(
            f"set -o pipefail; {TANGIBLE} {' '.join(words)} | head -{lines}",
            shell=True, executable="/bin/bash", cwd=folder, capture_output=True, text=True, env=quiet(),
        )  # fmt: skip
        assert (done.returncode, done.stderr) == (0, "")
        assert len(done.stdout.splitlines()) == lines

    @pytest.mark.parametrize("unbuffered", ["", "1"])
    @pytest.mark.parametrize("words", [["plugins", "--json"], ["--help"]])
    def test_a_full_disk_is_said_in_one_line(self, folder: Path, words: list[str], unbuffered: str) -> None:
        with Path("/dev/full").open("w") as full:
            done = tangible(folder, *words, stdout=full, env={**quiet(), "PYTHONUNBUFFERED": unbuffered})
        assert done.returncode == 2
        assert done.stderr == "standard output cannot be written: No space left on device\n"

    @pytest.mark.parametrize("words", [["plan", "none.yaml"], ["plan", "--no-such-option"]])
    def test_a_mistake_that_cannot_be_told_is_one_all_the_same(self, folder: Path, words: list[str]) -> None:
        with Path("/dev/full").open("w") as full:
            assert tangible(folder, *words, stderr=full, env=quiet()).returncode == 2

    @pytest.mark.parametrize("closed", [">&-", "2>&-", ">&- 2>&-"])
    def test_streams_that_are_closed(self, folder: Path, closed: str) -> None:
        done = subprocess.run(
            f"{TANGIBLE} run p.yaml --no-cache --json {closed}", shell=True, cwd=folder, capture_output=True, text=True
        )
        assert done.returncode == 0
        if ">&-" not in closed.split():
            json.loads(done.stdout)

    def test_a_mistake_is_told_after_what_was_shown(self, folder: Path) -> None:
        """On one stream, in the order in which it happened."""
        done = tangible(folder, "check", "depth", "nosy", stderr=subprocess.STDOUT, env=quiet())
        assert done.returncode == 2
        assert done.stdout.startswith("no depth method is named 'nosy'")

    def test_encoding_and_its_errors_are_those_of_standard_output(self, folder: Path) -> None:
        code = (
            "from tangible_core.runtime.standard_output import protect, stream\n"
            "with protect(): print('\\u03bc', file=stream())"
        )
        env = {**quiet(), "PYTHONIOENCODING": "ascii:backslashreplace"}
        assert (
            subprocess.run([sys.executable, "-c", code], capture_output=True, env=env, check=True).stdout
            == b"\\u03bc\n"
        )

    def test_a_terminal_keeps_its_colours_and_its_width(self, folder: Path) -> None:
        """132 columns, with standard input and error elsewhere."""
        folder.joinpath("wide.yaml").write_text(PIPELINE.replace("noisy", "semi-global"))
        host, terminal = pty.openpty()
        fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 50, 132, 0, 0))
        env = {name: value for name, value in quiet().items() if name not in ("COLUMNS", "NO_COLOR")}
        done = tangible(
            folder, "plan", "wide.yaml", stdin=subprocess.DEVNULL, stdout=terminal, env={**env, "TERM": "xterm"}
        )
        os.close(terminal)
        shown = b""
        while more := read(host):
            shown += more
        os.close(host)
        assert done.returncode == 0, done.stderr
        assert b"\x1b[" in shown
        plain = re.sub(r"\x1b\[[0-9;]*m", "", shown.decode())
        assert 80 < max(map(len, plain.splitlines())) <= 132


def read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 65536)
    except OSError:  # the other side is closed
        return b""


def quiet() -> dict[str, str]:
    """Without the plugin that talks."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}


class TestKept:
    def test_in_a_process_whose_standard_output_is_not_its_own(self, monkeypatch: pytest.MonkeyPatch) -> None:
        out, err = io.StringIO(), io.StringIO()
        monkeypatch.setattr(sys, "stdout", out)
        monkeypatch.setattr(sys, "stderr", err)
        with protect(), protect():
            print("a plugin")
            print("the program", file=stream())
        print("afterwards")
        assert (out.getvalue(), err.getvalue()) == ("the program\nafterwards\n", "a plugin\n")
        assert stream() is out

    def test_it_is_undone_after_an_error(self, monkeypatch: pytest.MonkeyPatch) -> None:
        out = io.StringIO()
        monkeypatch.setattr(sys, "stdout", out)
        with pytest.raises(ZeroDivisionError), protect():
            raise ZeroDivisionError
        assert sys.stdout is out and stream() is out

    def test_without_any(self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
        monkeypatch.setattr(sys, "stdout", None)
        with protect():
            print("a plugin")
            print("the program", file=stream())
        assert sys.stdout is None
        assert capsys.readouterr().err == "a plugin\n"

    def test_everything_is_as_it_was(self) -> None:
        """In a process of its own: file 1 is its."""
        code = """
import os, sys
from tangible_core.runtime.standard_output import protect, stream
before = sys.stdout, sys.stdout.line_buffering, len(os.listdir("/proc/self/fd"))
print("first")
for _ in range(3):
    with protect():
        print("a plugin"); os.write(1, b"a library\\n"); print("the program", file=stream())
print("last"); sys.stdout.flush(); os.write(1, b"file 1\\n")
assert (sys.stdout, sys.stdout.line_buffering, len(os.listdir("/proc/self/fd"))) == before
"""
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert done.stdout.splitlines() == ["first", *["the program"] * 3, "last", "file 1"]
        assert done.stderr.splitlines() == ["a plugin", "a library"] * 3

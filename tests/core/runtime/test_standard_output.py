"""Standard output is for the program alone: a plugin that prints must not spoil what another program reads."""

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
from contextlib import suppress
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
    subprocess.run(["echo", f"process {where}"], check=False)  # it complains where standard output is closed


noise("at import")


class Noisy(DepthEstimator):
    """A method that prints all the time."""

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
        print("hello from a plugin's command")
'''
WAYS = ("print", "write", "file 1", "C", "process")
DEMO = Path(__file__).parents[3] / "configs/demo.yaml"
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
    """Return a folder to work in; a noisy plugin is installed."""
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
            (["schema"], {"at import", "at the start"}),
            pytest.param(
                ["compare", "c.yaml", "--json"],
                {"at import", "at the start", "while watching"},
                marks=pytest.mark.whole,
            ),
        ],
        ids=lambda words: words[0] if isinstance(words, list) else "",
    )
    def test_standard_output_holds_only_json_with_a_noisy_plugin(
        self, folder: Path, words: list[str], where: set[str]
    ) -> None:
        done = tangible(folder, *words)
        json.loads(done.stdout)
        assert {line for line in done.stderr.splitlines() if line.startswith(WAYS)} == {
            f"{way} {place}" for way in WAYS for place in where
        }

    def test_standard_output_is_empty_after_a_mistake_and_open_to_commands_of_plugins(self, folder: Path) -> None:
        done = tangible(folder, "plan", "none.yaml")
        assert (done.returncode, done.stdout) == (2, "")
        assert "C at import" in done.stderr
        assert tangible(folder, "hello").stdout.splitlines()[-1] == "hello from a plugin's command"


class TestStreams:
    @pytest.mark.parametrize(("words", "lines"), [("plugins", 0), ("plugins --json", 1)])
    def test_reader_that_goes_away_is_not_an_error(self, folder: Path, words: str, lines: int) -> None:
        done = subprocess.run(
            f"set -o pipefail; {TANGIBLE} {words} | head -{lines}",
            shell=True, executable="/bin/bash", cwd=folder, capture_output=True, text=True, env=quiet(),
        )  # fmt: skip
        assert (done.returncode, done.stderr) == (0, "")
        assert len(done.stdout.splitlines()) == lines

    @pytest.mark.parametrize("unbuffered", ["", pytest.param("1", marks=pytest.mark.whole)])
    def test_full_disk_is_reported_in_one_line(self, folder: Path, unbuffered: str) -> None:
        with Path("/dev/full").open("w") as full:
            done = tangible(folder, "plugins", "--json", stdout=full, env={**quiet(), "PYTHONUNBUFFERED": unbuffered})
        assert done.returncode == 2
        assert done.stderr == "standard output cannot be written: No space left on device\n"

    @pytest.mark.parametrize(
        "closed", [">&- 2>&-", *(pytest.param(each, marks=pytest.mark.whole) for each in (">&-", "2>&-"))]
    )
    def test_closed_streams_do_not_stop_a_run(self, folder: Path, closed: str) -> None:
        done = subprocess.run(
            f"{TANGIBLE} run p.yaml --no-cache --json {closed}", shell=True, cwd=folder, capture_output=True, text=True
        )
        assert done.returncode == 0

    def test_stream_writes_any_text_as_wide_as_its_terminal(self, folder: Path) -> None:
        """A console or a pipe that has no sign for something shows its number; nothing ends in an error."""
        code = (
            "from tangible_core.runtime.standard_output import protect, stream\n"
            "with protect(): print('\\u2265\\u2800 \\u00fc', file=stream())"
        )
        env = {**quiet(), "PYTHONIOENCODING": "cp437"}
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, env=env, check=True)
        assert done.stdout.rstrip() == "\u2265\u2800 \u00fc".encode("cp437", "backslashreplace")
        host, terminal = pty.openpty()
        fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 50, 132, 0, 0))
        env = {name: value for name, value in quiet().items() if name not in ("COLUMNS", "NO_COLOR")}
        done = tangible(folder, "plan", DEMO, stdin=subprocess.DEVNULL, stdout=terminal, env={**env, "TERM": "xterm"})
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
    """Return the environment without the noisy plugin."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}


class TestProtect:
    def test_protect_of_a_replaced_stdout_redirects_print(self, monkeypatch: pytest.MonkeyPatch) -> None:
        out, err = io.StringIO(), io.StringIO()
        monkeypatch.setattr(sys, "stdout", out)
        monkeypatch.setattr(sys, "stderr", err)
        with suppress(ZeroDivisionError), protect(), protect():
            print("a plugin")
            print("the program", file=stream())
            raise ZeroDivisionError
        print("afterwards")
        assert (out.getvalue(), err.getvalue()) == ("the program\nafterwards\n", "a plugin\n")
        assert stream() is out

    def test_protect_without_standard_output_redirects_print(
        self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
    ) -> None:
        monkeypatch.setattr(sys, "stdout", None)
        with protect():
            print("a plugin")
            print("the program", file=stream())
        assert sys.stdout is None
        assert capsys.readouterr().err == "a plugin\n"

    def test_protect_restores_streams_and_files(self) -> None:
        """Run in a child process, which owns its file 1."""
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

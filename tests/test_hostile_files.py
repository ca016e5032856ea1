"""Hostile files by the command line, as a user meets them: one line, exit code 2, and neither time nor memory.

What each is limited by is tested in its room; here, that every command stands on these rooms.
"""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from hostile import SIDE, YAML_BOMBS, npy_header, npz, npz_bomb, tiff

TANGIBLE = str(Path(sys.executable).with_name("tangible"))
MOST_MB = 400
"""Of which the program's own libraries are 90; the bombs here are of 1000 to 3200."""
PIPELINE = """\
scene: {height: map.npy}
want: touch
render: {use: penalty-gradient}
"""
MEASURE = """\
import os, subprocess, sys
program = subprocess.Popen(sys.argv[2:])
_, status, used = os.wait4(program.pid, 0)
open(sys.argv[1], "w").write(str(used.ru_maxrss))
sys.exit(os.waitstatus_to_exitcode(status))
"""
"""A program's peak memory, KiB; of a small program, as a process begins with the peak of the one that it comes from."""
TICKS = "time_s,x_m,y_m,z_m,vx_m_per_s,vy_m_per_s,vz_m_per_s,fx_n,fy_n,fz_n,flags\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    np.save(tmp_path / "map.npy", np.arange(12.0).reshape(3, 4))
    (tmp_path / "p.yaml").write_text(PIPELINE)
    return tmp_path


def refused(*words: object, cwd: Path) -> str:
    """What is said, if it is one line, soon, in little memory, and exit code 2."""
    measured = [sys.executable, "-c", MEASURE, str(cwd / "used"), TANGIBLE, *map(str, words)]
    done = subprocess.run(measured, cwd=cwd, capture_output=True, text=True, timeout=100)
    assert done.returncode == 2, done.stderr[-2000:]
    assert done.stdout == ""
    (line,) = done.stderr.splitlines()
    assert line.isprintable()
    assert len(line) <= 1000
    assert int((cwd / "used").read_text()) < MOST_MB * 1000
    return line


pytestmark = pytest.mark.timeout(120)


@pytest.mark.parametrize("name", ["aliases", "keys of keys"])
@pytest.mark.parametrize("words", [("plan",), ("run",), ("compare",), ("materials", "show", "ice", "--library")])
def test_yaml_by_every_command_that_reads_it(folder: Path, name: str, words: tuple[str, ...]):
    (folder / "bomb.yaml").write_text(YAML_BOMBS[name])
    assert refused(*words, "bomb.yaml", cwd=folder).startswith("bomb.yaml")


@pytest.mark.parametrize("name", ["a number of 5000 digits", "a date that is none", "a text without end"])
def test_yaml_that_ended_in_a_traceback_or_a_screen_of_text(folder: Path, name: str):
    (folder / "bomb.yaml").write_text(YAML_BOMBS[name])
    assert refused("plan", "bomb.yaml", cwd=folder).startswith("bomb.yaml:")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("scene=" + "[" * 3000, "blocks are nested"),
        ("scene=" + "9" * 5000, "digits"),
        ("materials." + "9" * 5000 + "=ice", "unknown option"),
        ("materials.²=ice", "unknown option"),
        (".".join("a" * 500) + "=1", "write key.key=value"),
        ("scene=" + "x" * 50_000, "no scene is named"),
        ("sce\x1b[31mne=1\n2", "unknown key"),
    ],
)
def test_an_override(folder: Path, text: str, said: str):
    assert said in refused("plan", "p.yaml", "--set", text, cwd=folder)


def test_maps_and_pictures(folder: Path):
    npz_bomb(folder / "a.npz", a=(20_000, 20_000))
    tiff(folder / "b.tif", SIDE, SIDE)
    tiff(folder / "c.tif", SIDE, SIDE, bits=16, samples=3, sample_format=1)
    (folder / "d.npy").write_bytes(npy_header((200_000, 200_000)))
    assert (folder / "a.npz").stat().st_size < 4e6
    for name, said in (("a.npz", "1424 MB"), ("b.tif", "89 mega"), ("c.tif", "89 mega"), ("d.npy", "89 mega")):
        words = ("plan", "p.yaml", "--set", f"scene.height={name}")
        assert said in refused(*words, cwd=folder)
    assert "1424 MB" in refused("run", "p.yaml", "--set", "scene={photo: a.npz}", cwd=folder)
    assert "89 mega" in refused("run", "p.yaml", "--set", "scene={photo: b.tif}", cwd=folder)


def test_recordings(folder: Path):
    npz_bomb(folder / "a.npz", time_s=(60_000_000,), position_m=(60_000_000, 3))
    npz(folder / "b.npz", zipfile.ZIP_LZMA, time_s=npy_header((1,)) + bytes(8))
    (folder / "c.csv").write_text(TICKS + "x" * 1_000_000 + ",0" * 10 + "\n")
    (folder / "d.csv").write_text(TICKS + "0" + ",0" * 9 + ",nan\n")
    (folder / "zero.csv").symlink_to("/dev/zero")
    os.mkfifo(folder / "pipe.nc")
    for name in ("a.npz", "b.npz", "c.csv", "d.csv", "zero.csv", "pipe.nc"):
        assert refused("replay", name, "p.yaml", cwd=folder).startswith(f"{name}: ")


def test_results(folder: Path):
    (folder / "a.jsonl").write_text("[" * 100_000 + "]" * 100_000 + "\n")
    (folder / "b.jsonl").write_text('{"key": ' + "9" * 5000 + "}\n")
    (folder / "zero.jsonl").symlink_to("/dev/zero")
    for name in ("a.jsonl", "b.jsonl", "zero.jsonl"):
        assert refused("compare", name, cwd=folder).startswith(name)
        assert refused("compare", "p.yaml", "--against", name, cwd=folder).startswith(name)


@pytest.mark.parametrize("words", [("plan",), ("compare",), ("materials", "--library")])
def test_what_is_no_file(folder: Path, words: tuple[str, ...]):
    os.mkfifo(folder / "pipe.yaml")
    (folder / "zero.yaml").symlink_to("/dev/zero")
    for name in ("pipe.yaml", "zero.yaml"):
        assert "not a file but a folder or a device" in refused(*words, name, cwd=folder)


def test_a_name_that_a_terminal_would_obey(folder: Path):
    assert refused("plan", "a\n\x1b[31mb.yaml", cwd=folder).startswith(r"a\n\x1b[31mb.yaml: there is no such file")

"""If one of these fails, a hostile file costs a user of the command line time, memory or a traceback."""

import os
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from command_line import Program
from hostile import SIDE, YAML_BOMBS, npy_header, npz, npz_bomb, tiff

MAX_MB = 400
"""Of which the program's own libraries are 90; the bombs here are of 1000 to 3200."""
PIPELINE = """\
scene: {height: map.npy}
want: touch
render: {use: penalty-gradient}
"""
TICKS = "time_s,x_m,y_m,z_m,vx_m_per_s,vy_m_per_s,vz_m_per_s,fx_n,fy_n,fz_n,flags\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    np.save(tmp_path / "map.npy", np.arange(12.0).reshape(3, 4))
    (tmp_path / "p.yaml").write_text(PIPELINE)
    return tmp_path


@pytest.fixture(scope="module")
def program() -> Iterator[Program]:
    program = Program()
    yield program
    program.close()


@pytest.fixture
def refused(folder: Path, program: Program) -> Callable[..., str]:
    """What is said, if it is one line, soon, in little memory, and exit code 2."""

    def refused(*words: object) -> str:
        done = program(*words, cwd=folder)
        assert done.returncode == 2, done.stderr[-2000:]
        assert done.stdout == ""
        (line,) = done.stderr.splitlines()
        assert line.isprintable()
        assert len(line) <= 1000
        assert program.peak_kib < MAX_MB * 1000
        return line

    return refused


pytestmark = pytest.mark.timeout(120)


@pytest.mark.parametrize("name", ["aliases", "keys of keys"])
@pytest.mark.parametrize("words", [("plan",), ("run",), ("compare",), ("materials", "show", "ice", "--library")])
def test_hostile_yaml_is_refused_by_every_command(refused, folder: Path, name: str, words: tuple[str, ...]):
    (folder / "bomb.yaml").write_text(YAML_BOMBS[name])
    assert refused(*words, "bomb.yaml").startswith("bomb.yaml")


def test_hostile_maps_and_pictures_are_refused(refused, folder: Path):
    npz_bomb(folder / "a.npz", a=(20_000, 20_000))
    tiff(folder / "b.tif", SIDE, SIDE)
    tiff(folder / "c.tif", SIDE, SIDE, bits=16, samples=3, sample_format=1)
    (folder / "d.npy").write_bytes(npy_header((200_000, 200_000)))
    assert (folder / "a.npz").stat().st_size < 4e6
    for name, said in (("a.npz", "1424 MB"), ("b.tif", "89 mega"), ("c.tif", "89 mega"), ("d.npy", "89 mega")):
        words = ("plan", "p.yaml", "--set", f"scene.height={name}")
        assert said in refused(*words)
    assert "1424 MB" in refused("run", "p.yaml", "--set", "scene={photo: a.npz}")
    tiff(folder / "e.tif", 3 * SIDE, 3 * SIDE)  # a photograph is reduced up to ten times as many pixels
    assert "89 mega" in refused("run", "p.yaml", "--set", "scene={photo: e.tif}")


def test_hostile_recordings_and_results_are_refused(refused, folder: Path):
    npz_bomb(folder / "a.npz", time_s=(60_000_000,), position_m=(60_000_000, 3))
    npz(folder / "b.npz", zipfile.ZIP_LZMA, time_s=npy_header((1,)) + bytes(8))
    (folder / "c.csv").write_text(TICKS + "x" * 1_000_000 + ",0" * 10 + "\n")
    (folder / "d.csv").write_text(TICKS + "0" + ",0" * 9 + ",nan\n")
    (folder / "zero.csv").symlink_to("/dev/zero")
    os.mkfifo(folder / "pipe.nc")
    for name in ("a.npz", "b.npz", "c.csv", "d.csv", "zero.csv", "pipe.nc"):
        assert refused("replay", name, "p.yaml").startswith(f"{name}: ")
    (folder / "a.jsonl").write_text("[" * 100_000 + "]" * 100_000 + "\n")
    (folder / "b.jsonl").write_text('{"key": ' + "9" * 5000 + "}\n")
    (folder / "zero.jsonl").symlink_to("/dev/zero")
    for name in ("a.jsonl", "b.jsonl", "zero.jsonl"):
        assert refused("compare", name).startswith(name)
        assert refused("compare", "p.yaml", "--against", name).startswith(name)


@pytest.mark.parametrize("words", [("plan",), ("compare",), ("materials", "--library")])
def test_path_that_is_not_a_file_is_refused(refused, folder: Path, words: tuple[str, ...]):
    os.mkfifo(folder / "pipe.yaml")
    (folder / "zero.yaml").symlink_to("/dev/zero")
    for name in ("pipe.yaml", "zero.yaml"):
        assert "not a file but a folder or a device" in refused(*words, name)


def test_file_name_with_control_characters_is_printed_escaped(refused, folder: Path):
    assert refused("plan", "a\n\x1b[31mb.yaml").startswith(r"a\n\x1b[31mb.yaml: there is no such file")

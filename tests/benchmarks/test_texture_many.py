"""Which pictures of folders and archives are taken for textures."""

from io import BytesIO
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pytest
from PIL import Image

from benchmarks.texture_many import find_textures
from tangible_core.testing.synthetic.textures import FAMILIES


def texture(family: str, seed: int, side: int = 300) -> np.ndarray:
    values = FAMILIES[family]((side, side), np.random.default_rng(seed))
    return np.rint(255 * (values - values.min()) / np.ptp(values)).astype(np.uint8)


def stored(picture: np.ndarray) -> bytes:
    file = BytesIO()
    Image.fromarray(picture).save(file, "PNG")
    return file.getvalue()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "weave.png").write_bytes(stored(texture("weave", 1)))
    return tmp_path


def count(folder: Path) -> int:
    return len(find_textures([folder], processes=1))


def test_textures_of_folders_and_archives_are_found(folder: Path):
    with ZipFile(folder / "more.pk3", "w") as archive:
        archive.writestr("textures/maze.png", stored(texture("maze", 2)))
    found = find_textures([folder], processes=1)
    assert len(found) == 2
    assert all(each.dtype == np.uint8 and each.shape == (300, 300) for each in found)


def test_texture_that_is_there_twice_is_taken_once(folder: Path):
    (folder / "again.png").write_bytes(stored(texture("weave", 1)))
    (folder / "paler.png").write_bytes(stored(100 + texture("weave", 1) // 2))
    assert count(folder) == 1


def half_and_half() -> np.ndarray:
    return np.hstack([texture("weave", 3)[:, :150], texture("dots", 3)[:, 150:]])


def normals() -> np.ndarray:
    slopes = np.dstack([texture("weave", 4) / 255 - 0.5, texture("maze", 4) / 255 - 0.5, np.ones((300, 300))])
    return np.rint(127.5 + 127.5 * slopes / np.linalg.norm(slopes, axis=2, keepdims=True)).astype(np.uint8)


def cut_out() -> np.ndarray:
    grey = texture("weave", 5)
    return np.dstack([grey, grey, grey, np.where(np.arange(300) < 30, 0, 255) + 0 * grey]).astype(np.uint8)


@pytest.mark.parametrize(
    ("name", "picture"),
    [
        ("small.png", texture("weave", 2, 200)),
        ("flat.png", np.full((300, 300), 128, np.uint8)),
        ("two.png", half_and_half()),
        ("wall.png", normals()),
        ("leaf.png", cut_out()),
        ("maze_norm.png", texture("maze", 6)),
    ],
)
def test_what_is_no_texture_is_left_out(folder: Path, name: str, picture: np.ndarray):
    (folder / name).write_bytes(stored(picture))
    assert count(folder) == 1


def test_files_that_cannot_be_read_are_left_out(folder: Path):
    (folder / "broken.png").write_bytes(b"no picture")
    (folder / "broken.zip").write_bytes(b"no archive")
    assert count(folder) == 1

"""What docs/export.md tells from the first file to the print; TANGIBLE_DOCS_PICTURES=1 writes its pictures."""

import os
import re
import shlex
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from command_line import tangible
from drawn_parts import drawn
from exported_pictures import pixels
from pictures import write_png
from solids import is_closed, read, seen_from_above
from tangible_authoring.label_picture import label_picture
from tangible_core import Scene

ROOT = Path(__file__).parents[1]
PAGE = ROOT.joinpath("docs", "export.md").read_text(encoding="utf-8")
[SECTION] = re.findall(r"^## From the first file to the print\n(.*?)^## ", PAGE, re.DOTALL | re.MULTILINE)
PORTRAIT, MAP = re.findall(r"```yaml\n(.*?)```", SECTION, re.DOTALL)
COMMANDS = re.findall(r"^\$ tangible (.*)$", SECTION, re.MULTILINE)
SIDE_PX, MOST_BYTES = 560, 150_000


@pytest.fixture
def keep(tmp_path: Path) -> Callable[[str, Image.Image], None]:
    """Writes a picture, small, to where it is asked for; something is on it, and the page shows it."""

    def kept(name: str, picture: Image.Image) -> None:
        assert f"](export/{name}.png)" in SECTION and np.asarray(picture).std() > 5
        folder = ROOT / "docs" / "export" if os.environ.get("TANGIBLE_DOCS_PICTURES") else tmp_path / "pictures"
        folder.mkdir(exist_ok=True)
        picture.thumbnail((2 * SIDE_PX, SIDE_PX))
        small = picture.convert("L").quantize(32, dither=Image.Dither.NONE)
        small.save(folder / f"{name}.png", optimize=True)
        assert (folder / f"{name}.png").stat().st_size < MOST_BYTES

    return kept


def done(folder: Path, about: str) -> list[str]:
    """What the commands of the page that have this in them print."""
    said = []
    for command in (each for each in COMMANDS if about in each):
        ended = tangible(*shlex.split(command), cwd=folder)
        assert ended.returncode == 0, (command, ended.stderr)
        said.append(ended.stdout)
    return said


def test_export_page_commands_are_all_tried():
    assert len(COMMANDS) == 6
    assert all(any(about in each for about in ("plate.yaml", "left", "hills.yaml")) for each in COMMANDS)


def test_museum_photograph_becomes_a_legible_page_and_plate(tmp_path: Path, keep):
    astronaut = drawn("astronaut")
    write_png(tmp_path / "astronaut.png", astronaut.picture)
    (tmp_path / "parts.png").write_bytes(label_picture(astronaut.parts.labels))
    (tmp_path / "plate.yaml").write_text(PORTRAIT)
    for_print, for_swell, _ = done(tmp_path, "plate.yaml")
    assert "Legible" in for_print
    assert "Legible" in for_swell
    assert is_closed(read(tmp_path / "portrait/plate.3mf"))
    assert "helmet" in (tmp_path / "portrait/plate.txt").read_text()
    keep("portrait", Image.fromarray(pixels(tmp_path / "portrait/plate-swell.svg", 90)))


def test_pair_becomes_a_plate(tmp_path: Path, keep):
    views = Scene.builtin("motorcycle").views
    assert views is not None and views.right is not None
    write_png(tmp_path / "left.png", views.left)
    write_png(tmp_path / "right.png", views.right)
    done(tmp_path, "left")
    plate = read(tmp_path / "motorcycle/left.stl")
    assert is_closed(plate)
    keep("pair", seen_from_above(plate))


def test_height_map_becomes_a_plate(tmp_path: Path, keep):
    Image.fromarray(hills(300, 400)).save(tmp_path / "hills.tif")
    (tmp_path / "hills.yaml").write_text(MAP)
    done(tmp_path, "hills.yaml")
    plate = read(tmp_path / "hills/hills.stl")
    assert is_closed(plate)
    assert plate.vertices[:, 2].max() == pytest.approx(12 + 1.5, abs=0.06)
    keep("map", seen_from_above(plate))


def hills(rows: int, columns: int) -> np.ndarray:
    """An elevation model: noise whose waves are the higher, the longer they are; 400 to 1,300 m."""
    noise = np.fft.rfft2(np.random.default_rng(4).standard_normal((rows, columns)))
    squared = np.fft.fftfreq(rows)[:, None] ** 2 + np.fft.rfftfreq(columns) ** 2
    squared[0, 0] = np.inf
    found = np.fft.irfft2(noise * squared**-1.6 * (squared > 2e-5), s=(rows, columns))
    return (400 + 900 * (found - found.min()) / np.ptp(found)).astype(np.float32)

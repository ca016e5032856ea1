"""First parts: if a case fails, parts are too narrow for a finger, or the file says another size or height."""

import re
from pathlib import Path

import numpy as np
import pytest

from command_line import tangible
from onnx_models import mono
from pictures import write_png
from tangible_authoring.first_parts import first_parts
from tangible_core.errors import OutputError
from tangible_core.files.writing import sole_writer
from tangible_core.pipeline.pipeline import load_pipeline
from tangible_core.scene.scene_files import SceneFiles


@pytest.fixture
def stripes(tmp_path: Path) -> Path:
    """A picture of 160 x 40 pixels in five grey stripes; the one on the right is 6 pixels wide, 3 mm on 80 mm."""
    grey = np.repeat(np.uint8([10, 70, 130, 190, 250]), [38, 38, 39, 39, 6])
    write_png(tmp_path / "stripes.png", np.tile(grey, (40, 1)))
    return tmp_path


def parts_of(folder: Path, **more: object):
    return first_parts([folder / "stripes.png"], folder / "stripes.yaml", method="histogram", **more)


@pytest.mark.parametrize(("smallest_mm", "count"), [(2.4, 5), (3.1, 4), (10.0, 4)])
def test_part_narrower_than_the_smallest_of_the_longer_side_is_joined(stripes: Path, smallest_mm: float, count: int):
    found = parts_of(stripes, overrides=["texture.segments=5"], smallest_mm=smallest_mm)
    assert found.parts.count == count


def test_parts_of_another_picture_are_not_written_meanwhile(stripes: Path):
    found = parts_of(stripes)
    with sole_writer(stripes / "parts.png"), pytest.raises(OutputError, match="another program is writing the same"):
        found.write(force=True)
    assert [path.name for path in stripes.iterdir()] == ["stripes.png"]
    assert {path.name for path in found.write()} == {"parts.png", "parts-numbered.png", "stripes.yaml"}


def test_parts_have_heights_of_whole_tenths_in_their_units(stripes: Path):
    found = parts_of(stripes, overrides=["texture.segments=5"], smallest_mm=2.0)
    heights_mm = sorted(1000 * (each.height_m or 0.0) for each in found.listed)
    assert heights_mm == pytest.approx([0.0, 1.0, 2.1, 3.1, 4.2])  # of 0, 1.05, 2.1, 3.15 and 4.2
    (stripes / "here").mkdir()
    words = ("parts", "../stripes.png", "--out", "..", "--method", "histogram", "--set", "texture.segments=5")
    done = tangible(*words, "--smallest", 2, cwd=stripes / "here")
    assert done.returncode == 0, done.stderr
    text = (stripes / "stripes.yaml").read_text()
    assert text.startswith("# stripes.png in 5 parts, 160 x 40 pixels; parts-numbered.png shows their numbers.")
    assert "width_m: 80 mm " in text and "relief_m: 6 mm " in text
    assert not re.search("^depth:", text, re.MULTILINE), "heights that were guessed need no depth"
    rows = [line.split() for line in done.stdout.splitlines() if re.match(r"\s*[1-5]\s", line)]
    assert rows[-1][-2] == "3.8"  # 6 of 160 columns, in percent
    assert sorted(row[-1] for row in rows) == ["0.0", "1.0", "2.1", "3.1", "4.2"]
    (stripes / "parts-numbered.png").unlink()
    again = tangible("parts", "../stripes.yaml", cwd=stripes / "here")
    assert again.returncode == 0, again.stderr
    assert (stripes / "parts-numbered.png").is_file() and not list((stripes / "here").iterdir())


@pytest.mark.parametrize("name", ["a\nwant: touch\n#.png", "a\x1b\x85\udce9b.png"], ids=ascii)
def test_picture_of_a_hostile_name_is_read_back_from_the_file(stripes: Path, name: str):
    (stripes / name).write_bytes((stripes / "stripes.png").read_bytes())
    first_parts([stripes / name], stripes / "p.yaml", method="histogram").write()
    config = load_pipeline(stripes / "p.yaml").config
    assert isinstance(config.scene, SceneFiles) and config.scene.photo == stripes / name
    assert config.title.startswith("A ")


def test_parts_of_the_figure_that_a_network_sees_are_in_front(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Divided along its outline; a figure of one part has a name. Without a network, parts are as ever."""
    monkeypatch.setenv("TANGIBLE_MODELS_DIR", str(tmp_path / "models"))
    picture = np.full((80, 120), 30, np.uint8)
    picture[:40] = 90
    picture[10:50, 40:80] = 200
    before = listed_parts(tmp_path, picture)
    assert not any(each.name for each in before)
    assert before[2].height_m != max(each.height_m or 0 for each in before), "by its place, the square is not in front"
    (tmp_path / "models").mkdir()
    mono(tmp_path / "models" / "own.onnx")
    (tmp_path / "models" / "own.yaml").write_text("task: figure\noutput: {means: figure}\n")
    found = listed_parts(tmp_path, picture)
    assert [each.name for each in found] == ["", "the figure", ""]
    assert found[1].height_m == pytest.approx(2.1e-3 + (before[1].height_m or 0) / 2, abs=1.1e-4)
    picture[10:50, 60:80] = 240
    assert [listed_part.name for listed_part in listed_parts(tmp_path, picture)] == [""] * 4
    lowest_of_figure, highest_of_ground = sorted(
        listed_part.height_m or 0 for listed_part in listed_parts(tmp_path, picture)
    )[2:0:-1]
    assert highest_of_ground <= 2.1e-3 <= lowest_of_figure


def listed_parts(folder: Path, picture: np.ndarray):
    write_png(folder / "stripes.png", picture)
    return parts_of(folder, overrides=["texture.segments=4"]).listed

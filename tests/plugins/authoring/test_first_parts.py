"""First parts: what is too narrow, how high each is, and what the file and the list say of them."""

import re
from pathlib import Path
from time import perf_counter

import numpy as np
import pytest

from command_line import tangible
from pictures import write_png
from tangible_authoring.first_parts import first_parts
from tangible_authoring.listed_parts import ListedPart
from tangible_authoring.parts_starter import title_of
from tangible_authoring.renumbering import MOST_NAMED, Moved, in_words
from tangible_core.data import Outcome
from tangible_core.errors import OutputError
from tangible_core.files.writing import sole_writer
from tangible_core.pipeline.pipeline import load_pipeline
from tangible_core.plugins import hooks
from tangible_core.plugins.registry import Registry
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


def test_observers_hear_that_parts_are_made_and_no_more_time_than_passed(stripes: Path):
    heard: list[tuple[str, str]] = []
    ended: list[Outcome] = []

    class Observer:
        @hooks.hookimpl
        def tangible_stage_started(self, product: str, method: str) -> None:
            heard.append((product, method))

        @hooks.hookimpl
        def tangible_stage_finished(self, outcome: Outcome) -> None:
            ended.append(outcome)

    registry = Registry()
    registry.plugins.register(Observer())
    begun_s = perf_counter()
    parts_of(stripes, registry=registry)
    passed_s = perf_counter() - begun_s
    assert heard[-1] == ("parts", "core")
    last = ended[-1]
    assert (last.product, last.outcome, last.why, last.method) == ("parts", "ran", "requested", "core")
    assert 0 < last.seconds <= passed_s


def test_heights_are_whole_tenths_of_a_millimetre_below_the_top(stripes: Path):
    found = parts_of(stripes, overrides=["texture.segments=5"], smallest_mm=2.0)
    heights_mm = sorted(1000 * (each.height_m or 0.0) for each in found.listed)
    assert heights_mm == pytest.approx([0.0, 1.0, 2.1, 3.1, 4.2])  # of 0, 1.05, 2.1, 3.15 and 4.2


def test_file_and_list_say_sizes_in_their_units(stripes: Path):
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


@pytest.mark.parametrize(("share", "said"), [(0.6, "60 %"), (0.01, "1 %"), (0.0042, "0.4 %"), (0.0001, "0.1 %")])
def test_share_of_a_part_is_said_to_a_tenth_below_one_percent(share: float, said: str):
    part = ListedPart(0, "", "on the left", share, None, "", "")
    assert part.where == f"on the left, {said} of the picture"
    assert part._replace(place="").where == f"{said} of the picture"


def test_title_is_the_name_of_the_picture_in_words():
    titles = {"girl_with-a pearl.jpg": "Girl with a pearl", "IMG_2041.JPG": "IMG 2041", "_.png": "_"}
    assert {name: title_of(Path("old") / name) for name in titles} == titles


def test_message_names_as_many_moved_parts_as_a_line_holds():
    moved = [Moved(number, number + 1, "") for number in range(MOST_NAMED + 2)]
    said = in_words(moved)
    assert said.endswith(f"{MOST_NAMED} is now {MOST_NAMED + 1}, and 2 more")
    assert in_words(moved[:MOST_NAMED]).endswith(f"{MOST_NAMED} is now {MOST_NAMED + 1}")


@pytest.mark.parametrize("name", ["a\nwant: touch\n#.png", "a\x1b\x85\udce9b.png"], ids=ascii)
def test_picture_of_a_hostile_name_is_read_back_from_the_file(stripes: Path, name: str):
    (stripes / name).write_bytes((stripes / "stripes.png").read_bytes())
    first_parts([stripes / name], stripes / "p.yaml", method="histogram").write()
    config = load_pipeline(stripes / "p.yaml").config
    assert isinstance(config.scene, SceneFiles) and config.scene.photo == stripes / name
    assert config.title.startswith("A ")

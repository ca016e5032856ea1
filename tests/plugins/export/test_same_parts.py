"""One export. Otherwise readers of the words would look for parts that page and solid lack, or for other heights."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solids import bare, from_above, read
from tangible_core import Pipeline, Scene
from tangible_core.pipeline.output.export_result import Exported
from tangible_depth import Luminance
from tangible_export import Glb, Stl, Swell, ThreeMF
from tangible_export.paper.marks.reading import read as read_marks
from tangible_report import Text
from tangible_send.page import Page
from tangible_texture import Histogram

LABELS = np.zeros((300, 400), np.int32)
LABELS[60:200, 40:180] = LABELS[120:125, 180:187] = 1  # with a tab, short for a corner of 160 mm, and too long on paper
LABELS[60:84, 280:304], LABELS[200:213, 280:293] = 2, 3  # 9.6 and 5.2 mm in a solid
NAMES, BASE_MM = ("sea", "isle", "rock", "buoy"), 1.5
PARTS = {n: {"name": name, "height_m": 0.002 * (n > 1)} for n, name in enumerate(NAMES, 1)}
NAMELESS = {n: {**part, "name": ""} for n, part in PARTS.items()}
SOLIDS = [bare(each) for each in (Stl, ThreeMF, Glb)]


def export(folder: Path, exporters: list[Any], parts: Any = PARTS, **relief: Any) -> dict[str, Exported]:
    scene = Scene.photo((LABELS * 60).astype(np.uint8), segments=LABELS, kind="photograph", name="coast")
    done = Pipeline(scene, parts=parts, cached=False, **relief or {"heights": "given"}).export(folder, exporters)
    return {each.name: each for each in done.exports}


def parts_of(file: Path) -> set[str]:
    """Return the parts in a file as a reader finds them; in a solid, those that are higher than the sea."""
    if file.suffix in (".stl", ".3mf", ".glb"):
        at = [np.argwhere(number == LABELS).mean(axis=0) * 0.4 for number in range(4)]
        high = [from_above(read(file), np.array([x]), np.array([120 - y])).item() for y, x in at]
        return {"sea", *(name for name, each in zip(NAMES, high, strict=True) if each > BASE_MM + 0.5)}
    text = file.read_text("utf-8")
    if file.suffix == ".svg":
        return {mark.label for mark in read_marks(text).marks if mark.what == "outline"}
    return {*re.findall(r"(?:^- |<li><bdi>)([\w ]+)", text, re.MULTILINE)}


@pytest.mark.parametrize(("parts", "left"), [(PARTS, {*NAMES[:3]}), (NAMELESS, {"part 1", "part 2", "part 3"})])
def test_all_files_of_an_export_have_the_parts_of_the_narrowest(tmp_path: Path, parts: Any, left: set[str]):
    for number, exporters in enumerate(([Swell(), Text(), *SOLIDS, Page()], [Page(), SOLIDS[0], Text(), Swell()])):
        done = export(tmp_path / f"{number}", exporters, parts)
        found = {name: parts_of(each.files[0]) for name, each in done.items()}
        assert found == {name: left if name in ("Swell", "Text", "Page") else {*NAMES[:3]} for name in done}
        legible = done["Swell"].legible
        assert legible is not None and legible.readable, "the tab is cut for the width of the page too"
        made = [outcome for each in done.values() for outcome in each.made if outcome.product == "simplified"]
        assert ["merged" in outcome.why for outcome in made] == [parts is PARTS], "made once, and told once"


def test_solid_that_is_not_made_of_parts_takes_none_from_the_page(tmp_path: Path):
    done = export(tmp_path, [SOLIDS[0], Swell(), Text(), Page()], dict(enumerate(NAMES, 1)), depth=Luminance())
    assert all(parts_of(done[name].files[0]) == {*NAMES} for name in ("Swell", "Text", "Page"))


@pytest.mark.parametrize("exporters", [[SOLIDS[0]], [Text()], [Page()], [SOLIDS[0], Text(), Page()]])
def test_named_parts_stay_where_no_page_simplifies_them(tmp_path: Path, exporters: list[Any]):
    assert all(parts_of(each.files[0]) == {*NAMES} for each in export(tmp_path, exporters).values())


def test_words_state_the_size_and_the_heights_of_the_file_beside_them(tmp_path: Path):
    picture = np.full((120, 160), 40, np.uint8)
    picture[:, 80:83] = 220  # a ridge that ramps of a device lower
    pipeline = Pipeline(Scene.photo(picture), relief="edges", workspace={"relief_m": 0.008}, cached=False)
    words, solid, _ = pipeline.export(tmp_path, [Text(), SOLIDS[0], Swell()]).exports
    high_mm = read(solid.files[0]).vertices[:, 2].max() - BASE_MM
    assert f"160 mm wide and 120 mm long, up to {high_mm:.2g} mm high" in words.files[0].read_text("utf-8")
    wrong = Swell.model_construct(width_m=float("nan"))
    for swell, width in ((Swell(), "237 mm"), (wrong, "80 mm")):
        words = export(tmp_path / width, [swell, Text()])["Text"]
        assert f"A surface {width} wide" in words.files[0].read_text("utf-8")


def test_too_many_parts_are_told_for_the_page_and_refuse_no_other_file(tmp_path: Path):
    squares = (np.indices((140, 140)).sum(axis=0) % 2 * 200).astype(np.uint8)
    pipeline = Pipeline(
        Scene.photo(squares), relief="edges", texture=Histogram(sigma_px=0, smallest_px=1), cached=False
    )
    done = {each.name: each for each in pipeline.export(tmp_path, ["swell", "page", "stl"]).exports}
    assert "19600 parts, and at most 4096" in str(done["swell"].outcome)
    assert done["page"].files and done["stl"].files

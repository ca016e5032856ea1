from dataclasses import replace

import cv2
import numpy as np
import pytest
import shapely

from drawings import countries, house, page
from tangible_core import Pipeline, Scene
from tangible_core.data import PartMap, PictureText
from tangible_core.drawing import DrawnPicture, PictureKind, find_marks
from tangible_core.pipeline import Feeling
from tangible_export.paper.marks.reading import read
from tangible_export.paper.marks.rendering import black
from tangible_export.paper.sheet import sheet_for
from tangible_export.paper.strokes import strokes_on
from tangible_legibility.legible import legibility
from tangible_texture import Flat


def exported(picture, folder, **options):
    pipeline = Pipeline(Scene.photo(picture), texture=Flat(), title="House", **options)
    return pipeline.export(folder, ["swell"]).exports[0]


def test_strokes_lie_on_the_lines_of_the_drawing():
    picture, mask = house()
    sheet = sheet_for("a4", 4 / 3, None)
    strokes = strokes_on(picture, sheet)
    at = np.concatenate([shapely.get_coordinates(stroke.segmentize(0.2)) for stroke in strokes])
    px = (at - (sheet.left_mm, sheet.top_mm)) / sheet.picture_mm * (480, 360)
    columns, rows = np.clip(px.astype(int).T, 0, [[479], [359]])
    assert not find_marks(picture).texts.boxes and mask[rows, columns].mean() > 0.98
    length_px = shapely.length(strokes).sum() / sheet.picture_mm[0] * 480
    assert abs(length_px / (680 + 268 + 440 - 180 + 157) - 1) < 0.03  # the wall stands on the ground


def test_page_of_line_art_has_its_lines_and_empty_paper(tmp_path):
    done = exported(house()[0], tmp_path)
    svg = next(path for path in done.files if path.name.endswith("swell.svg")).read_text()
    assert 'data-mark="line"' in svg and 'data-mark="outline"' not in svg and 'data-mark="fill"' not in svg
    assert done.legible.readable and black(read(svg), 2).mean() < 0.03


def test_page_of_flat_drawing_keeps_all_areas_and_paper_is_empty(tmp_path):
    done = exported(countries()[0], tmp_path)
    svg = next(path for path in done.files if path.name.endswith("swell.svg")).read_text()
    assert svg.count('data-mark="outline"') == 4 and svg.count('data-mark="fill"') <= 3
    assert len([mark for mark in read(svg).marks if mark.what == "braille" and "part 1" in mark.label]) == 0
    assert done.legible.readable


def test_page_of_text_is_refused_and_has_no_verdict(tmp_path):
    done = exported(page(), tmp_path)
    assert (done.outcome.outcome, done.files, done.legible) == ("refused", (), None)
    assert "fingers cannot read as a picture" in done.outcome.why


@pytest.mark.parametrize(("medium", "readable"), [("swell", True), ("force", True), ("pins", False)])
def test_line_art_is_legible_where_its_lines_are(medium, readable):
    found = Feeling(Pipeline(Scene.photo(house()[0]), texture=Flat(), relief="lines")).legible(medium)
    assert found.readable == readable, found.sentence
    assert readable or "% of the length of the drawing's lines is left out" in found.sentence


def test_page_of_text_is_never_legible():
    found = Feeling(Pipeline(Scene.photo(page()), texture=Flat(), relief="lines")).legible("print")
    assert not found.readable and "page of text" in found.sentence


def test_lost_parts_and_texts_are_named():
    picture, labels = countries()
    picture[320:345, 20:200] = page()[20:45, 20:200]
    whole, left = (PartMap(each.astype(np.int32), (0, 1, 2, 3)) for each in (labels, np.where(labels == 3, 0, labels)))
    texts = [PictureText("", (0.1, 0.85, 0.4, 0.95)), PictureText("sea", (0.8, 0.1, 0.9, 0.2))]
    drawing = DrawnPicture(PictureKind.drawing, picture, True, whole, lost_texts=tuple(texts), text_count=4)
    found = legibility("swell", left, 0.25, names=["", "", "", "lake"], drawing=drawing)
    says = " ".join(each.says for each in found)
    assert "parts are left out (part 4 (lake) at the lower right; 2.9 % of the picture)" in says, says
    assert "texts are left out (2: at the lower left and sea at the upper right)" in says and not found.readable, says


@pytest.mark.parametrize(("long_px", "grade"), [(0, "ok"), (16, "warn"), (120, "illegible")])
def test_lost_lines_are_named_by_length_and_place(long_px, grade):
    picture, labels = countries()
    cv2.line(picture, (40, 10), (40, 350), (0, 0, 0), 2)
    parts = PartMap(np.where(np.arange(480) < 40, 4, labels).astype(np.int32), (0, 1, 2, 3, 4))  # stands for the line
    cv2.line(picture, (340, 330), (340 + long_px, 330), (0, 0, 0), 2 * (long_px > 0) or 1)
    cv2.line(picture, (60, 20), (60 + long_px // 2, 20), (0, 0, 0), 2 * (long_px > 0) or 1)
    found = legibility("pins", parts, 0.24, drawing=DrawnPicture(PictureKind.drawing, picture, False, parts))
    [lines] = [verdict for verdict in found if verdict.check == "kept lines"]
    assert lines.verdict == grade
    if grade == "illegible":
        assert lines.says.endswith(
            "is left out: a line of 60 mm at the lower right and a line of 30 mm at the upper left"
        )
        np.testing.assert_allclose(lines.at, [(400 / 480, 330 / 360), (90 / 480, 20 / 360)], atol=0.01)


LABELLED = replace(
    Scene.photo(countries()[0], name="map"),
    texts=(
        PictureText("Lands", (0.4, 0.01, 0.6, 0.08)),
        PictureText("north", (0.3, 0.3, 0.4, 0.35)),
        PictureText("sea", (0.55, 0.91, 0.65, 0.96)),
        PictureText("harbour", (0.66, 0.7, 0.7, 0.74)),
        PictureText("", (0.7, 0.3, 0.8, 0.35)),
    ),
)


def test_texts_are_on_the_page_at_their_place_or_by_a_letter_of_the_key(tmp_path):
    [done] = Pipeline(LABELLED, texture=Flat(), parts={2: "north"}).export(tmp_path, ["swell"]).exports
    svg, key = (done.files[number].read_text() for number in (0, 1))
    assert ">Lands</title>" in svg and "Lands: key" in key
    assert svg.count('aria-label="sea"') == 1 and 'aria-label="sea"' not in key
    assert 'aria-label="h harbour"' in svg and 'aria-label="h"' in key and 'aria-label="harbour"' in key
    [sea] = {mark.group for mark in read(svg).marks if mark.label == "sea"}
    dots = [mark.place_mm for mark in read(svg).marks if mark.group == sea]
    sheet = sheet_for("a4", 4 / 3, None).below(6.12)
    place = np.array([sheet.left_mm, sheet.top_mm]) + np.multiply((0.6, 0.935), sheet.picture_mm)
    assert np.hypot(*(np.mean(dots, axis=0) - place)) < 12
    assert [each.says for each in done.legible if each.check == "texts"] == [
        "texts are left out (1: at the upper right)"
    ]


@pytest.mark.parametrize("name", ["stl", "glb", "3mf", "pins", "heights", "text", "page", "swell"])
def test_every_exporter_lists_what_it_leaves_out_and_a_refused_one_has_no_verdict(tmp_path, name):
    scene, names = LABELLED, {2: "north", 4: "lake"}
    [done] = Pipeline(scene, texture=Flat(), relief="lines", parts=names).export(tmp_path, [name]).exports
    lost = "1: at the upper right" if name == "swell" else "2: sea at the bottom in the middle and at the upper right"
    assert done.outcome.outcome == "ran" and lost in " ".join(note.text for note in done.outcome.notes), done.outcome
    done.files[0].write_text("somebody's own")
    [refused] = Pipeline(scene, texture=Flat(), relief="lines", parts=names).export(tmp_path, [name]).exports
    assert (refused.outcome.outcome, refused.legible, refused.files) == ("refused", None, ())


def test_page_comes_back_as_the_same_parts(tmp_path):
    names = {1: "paper", 2: "north", 3: "east", 4: "lake"}
    pipeline = Pipeline(Scene.photo(countries()[0]), texture=Flat(), title="A map", parts=names)
    [done] = pipeline.export(tmp_path, ["swell"]).exports
    scene, parts = Scene.photo(done.files[0]), pipeline.make("simplified")
    labels = scene.segments.labels
    down, across = np.nonzero(labels)
    whole = labels[down.min() : down.max() + 1, across.min() : across.max() + 1]
    rows, columns = ((np.arange(n) * own // n) for n, own in zip(whole.shape, parts.labels.shape, strict=True))
    before = parts.labels[np.ix_(rows, columns)]
    assert (scene.title, sorted(scene.segment_names)) == ("A map", ["", *sorted(names.values())])
    for number, name in names.items():
        one, other = before == number - 1, whole == scene.segment_names.index(name)
        assert (one & other).sum() / (one | other).sum() > 0.9, name


@pytest.mark.parametrize(("lost", "grade"), [(2, "warn"), (3, "illegible")])
def test_drawing_that_loses_more_than_half_of_its_texts_is_illegible(lost, grade):
    picture, texts = countries()[0], [PictureText(f"text {number}", (0.1, 0.1, 0.2, 0.2)) for number in range(4)]
    parts = Pipeline(Scene.photo(picture), texture=Flat(), cached=False).engine.make("parts")
    drawing = DrawnPicture(PictureKind.drawing, picture, True, parts, tuple(texts[:lost]), 4)
    verdicts = legibility("swell", parts, 0.16, drawing=drawing)
    assert [verdict.verdict for verdict in verdicts if verdict.check == "texts"] == [grade]

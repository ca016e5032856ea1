"""Dashed and dotted lines of drawings. Otherwise dots are lost as specks, or letters and hatching become lines."""

import cv2
import numpy as np
import pytest

from drawings import house, page, scanned
from tangible_core import Pipeline, Scene
from tangible_core.drawing import DrawnPicture, PictureKind, find_marks
from tangible_export.paper.marks.gaps import too_near
from tangible_export.paper.marks.reading import read
from tangible_legibility.legible import legibility

TURN = np.linspace(0, 2 * np.pi, 200)
WAVE = np.stack([60 + 80 * TURN, 200 + 60 * np.sin(TURN)], axis=1)
RING = np.stack([300 + 150 * np.cos(TURN), 200 + 110 * np.sin(TURN)], axis=1)


def dashed(at, lengths, gap):
    """Return a picture of 400 x 640 pixels with a line of round dashes of these lengths, 4 px wide."""
    picture, along = np.full((1600, 2560, 3), 255, np.uint8), np.cumsum([0, *np.hypot(*np.diff(at, axis=0).T)])
    start, turn = 0.0, 0
    while (end := start + lengths[turn % len(lengths)] - 4) < along[-1]:
        points = [np.interp(np.linspace(start, end, 20), along, at[:, axis]) for axis in (0, 1)]
        cv2.polylines(picture, [np.rint(4 * np.stack(points, axis=1)).astype(np.int32)], False, (20, 20, 20), 16)
        start, turn = end + 4 + gap, turn + 1
    return cv2.resize(picture, (640, 400), interpolation=cv2.INTER_AREA)


def drawn(way):
    return cv2.polylines(np.zeros((400, 640), np.uint8), [np.rint(way).astype(np.int32)], False, 1) > 0


@pytest.mark.parametrize("copy", [{}, {"noise": 6}, {"noise": 2, "shadow": 0, "quality": 60}])
@pytest.mark.parametrize(("lengths", "gap"), [((16,), 8), ((4,), 7), ((4, 16), 7)])
def test_dashed_line_is_one_with_its_pattern(lengths, gap, copy):
    for at in (WAVE, RING):
        picture = dashed(at, lengths, gap)
        [line] = find_marks(scanned(picture, **copy) if copy else picture).lines.dashed
        assert (cv2.dilate(drawn(line.way) * np.uint8(1), np.ones((5, 5))) > 0)[drawn(at)].mean() > 0.9
        assert sorted(line.lengths_px) == pytest.approx(lengths, abs=1.5)
        assert line.gap_px == pytest.approx(gap, abs=1.5) and line.width_px == pytest.approx(4, abs=1.3)


def test_dashed_line_goes_on_behind_a_solid_one_and_counts_like_one():
    picture = cv2.line(dashed(WAVE, (16,), 8), (256, 20), (256, 380), (20, 20, 20), 5)
    lines = find_marks(picture).lines
    assert len(lines.dashed) == 1 and lines.share_near(25) < 0.3 and lines.solid.sum() < 420
    assert lines.centre.sum() == pytest.approx(drawn(WAVE).sum() + 360, rel=0.05)
    drawing = DrawnPicture(PictureKind.lines, dashed(WAVE, (4,), 7), False)
    assert any("100 % of the length" in verdict.says for verdict in legibility("pins", None, 0.2, drawing=drawing))


def fill(kind):
    picture, rng = np.full((400, 640, 3), 255, np.uint8), np.random.default_rng(1)
    right, down = {"dashes": (8, 0), "hatched": (6, 8)}.get(kind, (0, 0))
    for x, y in np.stack(np.meshgrid(np.arange(20, 600, 16), np.arange(20, 380, 12)), axis=2).reshape(-1, 2).tolist():
        at = rng.integers(20, 380, 2).tolist() if kind == "stippled" else (x + right * (y // 12 % 2), y)
        cv2.line(picture, at, (at[0] + right, at[1] + down), 0, 2)
    return picture


@pytest.mark.parametrize("picture", [page(), house()[0], *map(fill, ("dots", "dashes", "hatched", "stippled"))])
def test_letters_and_fills_are_no_dashed_lines(picture):
    assert find_marks(picture).lines.dashed == find_marks(scanned(picture)).lines.dashed == ()


def test_dashes_are_ridges_and_gaps_stay():
    picture = dashed(WAVE, (24,), 16)
    columns, rows = find_marks(picture).lines.dashed[0].way.astype(int).T
    height_m = Pipeline(Scene.photo(picture, kind="lines"), relief="lines").relief.height_m[rows, columns]
    assert height_m.max() > 0.0019 and height_m.min() < 0.0013 and np.diff(height_m > 0.0016).sum() > 20


@pytest.mark.parametrize(("lengths", "dots"), [((16,), [False]), ((4,), [True]), ((4, 16), [False, True])])
def test_swell_page_has_dashes_clear_of_each_other_and_comes_back(lengths, dots, tmp_path):
    picture = cv2.line(dashed(WAVE, lengths, 7), (140, 20), (140, 380), (20, 20, 20), 5)
    [done] = Pipeline(Scene.photo(picture, kind="lines")).export(tmp_path, ["swell"]).exports
    marks = [mark for mark in read(done.files[0].read_text()).marks if mark.what == "line"]
    assert {mark.stroke_mm for mark in marks} == {1.0, *[0.0] * any(dots)} and len(marks) > 20
    assert done.legible.readable and too_near(read(done.files[0].read_text())) == []
    back = find_marks(Scene.photo(done.files[0]).views.left).lines.dashed
    assert {tuple(sorted(line.dots)) for line in back} == {tuple(dots)}


def test_dashed_stroke_of_an_svg_stays_and_leads_to_its_part(tmp_path):
    (tmp_path / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 400 300"><circle cx="90" cy="150" r="50" fill="#b080c0"/>'
        '<path d="M90 150H290" fill="none" stroke="#000" stroke-width="2" stroke-dasharray="6 4"/>'
        '<text x="295" y="155" font-size="14">nucleus</text></svg>'
    )
    scene = Scene.photo(tmp_path / "a.svg")
    [line] = find_marks(scene.views.left).lines.dashed
    assert scene.segment_names == ("", "nucleus")
    assert (line.lengths_px[0], line.gap_px) == pytest.approx((24, 16), abs=1)  # the ink is 1600 px wide

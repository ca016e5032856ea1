import cv2
import numpy as np
import pytest
from matplotlib.font_manager import findfont
from PIL import Image, ImageDraw, ImageFont

from drawings import COLOURS, countries, house, page, scanned
from tangible_core import Scene
from tangible_core.data import SegmentMap
from tangible_core.drawing import PictureKind, find_areas, find_ink, find_lines, find_marks, find_texts, picture_kind
from tangible_core.drawing.kind import measure_kind
from tangible_core.drawing.text import _neighbours
from tangible_core.parts import find_parts


def written(words: str) -> np.ndarray:
    """Return a sheet with these words."""
    sheet = Image.new("L", (600, 600), 255)
    ImageDraw.Draw(sheet).text((60, 90), words, 20, ImageFont.truetype(findfont("DejaVu Sans"), 26), spacing=2)
    return np.array(sheet)


PICTURES = {"lines": house()[0], "drawing": countries()[0], "text": page()}


@pytest.mark.parametrize("kind", PICTURES)
@pytest.mark.parametrize("copy", [{}, {"shadow": 0}, {"quality": 60}])
def test_picture_kind_copied_drawings(kind, copy):
    found = picture_kind(scanned(PICTURES[kind], **copy) if copy else PICTURES[kind])
    assert (found.kind, found.confidence > 0.5) == (kind, True)


@pytest.mark.parametrize("name", ["coins", "brick", "grass", "gravel", "motorcycle"])
def test_picture_kind_photographs(name):
    found = picture_kind(Scene.builtin(name).views.left)
    assert found.kind == "photograph" and found.confidence > 0.5


@pytest.mark.parametrize(
    "picture", [np.zeros((1, 1)), np.full((30, 40, 3), 7, np.uint16), np.full((9, 9), np.nan), np.zeros((2, 90, 4))]
)
def test_picture_kind_nothing_drawn_is_photograph(picture):
    assert picture_kind(picture) == (PictureKind.photograph, 0.5)
    assert not find_ink(picture).mask.any() and find_areas(picture).labels.max() == 0


def test_scene_kind_given_or_measured():
    drawing = PICTURES["lines"]
    assert Scene.photo(drawing).kind.kind == "lines"
    assert Scene.photo(drawing, kind="drawing").kind == ("drawing", 1.0)
    assert Scene.pair(drawing, drawing).kind.kind == "photograph"


@pytest.mark.parametrize("copy", [{"noise": 0, "shadow": 0}, {}, {"noise": 2, "shadow": 0.5}])
def test_ink_of_scan_is_that_of_drawing(copy):
    picture, mask = house()
    found = find_ink(scanned(picture, **copy)).mask
    assert (found & mask).sum() / (found | mask).sum() > 0.8


def test_ink_lighter_than_its_ground_is_inverted():
    picture, mask = house()
    ink = find_ink(255 - picture)
    assert ink.inverted and (ink.mask & mask).sum() / (ink.mask | mask).sum() > 0.8


def test_lines_have_their_width_and_no_specks():
    picture, _ = house()
    picture[20:22, 20:22] = 0
    ink = find_ink(picture)
    lines = find_lines(ink, np.zeros_like(ink.mask))
    assert not lines.mask[:40, :40].any()
    assert 2.5 <= np.median(lines.width_px[lines.centre]) <= 3.5


@pytest.mark.parametrize("quality", [40, 60])
def test_lines_of_jpeg_are_no_ripples_beside_edges(quality):
    picture, _ = countries()
    for target in (picture, drawn := np.zeros(picture.shape[:2], np.uint8)):
        cv2.line(target, (90, 250), (400, 330), (20, 20, 20), 2)
    ink = find_ink(scanned(picture, noise=0, shadow=0, quality=quality))
    centre = find_lines(ink, np.zeros_like(ink.mask)).centre
    near = cv2.dilate(drawn, np.ones((5, 5))) > 0
    assert (centre & ~near).sum() < 20 and (centre & near).sum() > 300


@pytest.mark.parametrize("degrees", [15, 30, 60, 90])
@pytest.mark.parametrize("ground", [(255, 255, 255), (230, 200, 60)])
def test_tip_of_an_area_is_not_a_line(degrees, ground):
    picture = np.full((4 * 500, 4 * 700, 3), ground, np.uint8)
    half = np.tan(np.radians(degrees / 2)) * 400
    corners = [(100, 250), (500, 250 - half), (560, 250 + half)]
    cv2.fillPoly(picture, [np.rint(np.array(corners) * 4).astype(np.int32)], (90, 60, 140))
    picture = cv2.resize(picture, (700, 500), interpolation=cv2.INTER_AREA)
    for copy in (picture, scanned(picture, noise=3, shadow=0), scanned(picture, noise=0, shadow=0, quality=75)):
        assert not find_marks(copy).lines.centre.any()


@pytest.mark.parametrize("width", [2, 3, 5])
@pytest.mark.parametrize("area", [(20, 20, 20), (60, 40, 40)])
def test_dark_lines_beside_dark_areas_are_found(width, area):
    picture, drawn = np.full((500, 700, 3), 255, np.uint8), np.zeros((500, 700), np.uint8)
    for target, colour in ((picture, (20, 20, 20)), (drawn, 1)):
        cv2.line(target, (60, 225), (640, 225), colour, width)  # through both areas
        cv2.line(target, (30, 30), (150, 160), colour, width)  # ends at a corner
        x = 250 + 3 + width // 2  # two pixels off an area
        cv2.line(target, (x, 90), (x, 460), colour, width)
        for left in (150, 450):
            cv2.rectangle(target, (left, 160), (left + 100, 290), area if target is picture else 0, -1)
    centre = find_marks(picture).lines.centre
    assert (centre & ~(cv2.dilate(drawn, np.ones((3, 3))) > 0)).sum() <= 20
    near = cv2.dilate(centre.astype(np.uint8), np.ones((2 * width + 3, 2 * width + 3))) > 0
    assert near[drawn > 0].mean() > 0.98


def test_line_between_colours_is_darker_than_both_but_not_in_each_channel():
    picture = np.full((400, 400, 3), (175, 40, 95), np.uint8)
    picture[:, 200:] = 85, 165, 190
    picture[:, 198:202] = 82, 40, 92
    centre = find_marks(picture).lines.centre
    assert centre[10:-10, 198:202].any(axis=1).all() and not centre[:, :196].any() and not centre[:, 204:].any()


def test_kind_is_measured_on_all_ink_with_ripples(monkeypatch):
    picture = scanned(countries()[0], noise=0, shadow=0, quality=50)
    measures = measure_kind(picture)
    monkeypatch.setattr("tangible_core.drawing.ink.RINGING", 0)
    np.testing.assert_array_equal(measures, measure_kind(picture))


def test_texts_places_and_nothing_else():
    texts = find_texts(find_ink(PICTURES["text"]))
    assert len(texts.boxes) == 9
    assert all(box.left < 0.06 and box.letters > 10 for box in texts.boxes)
    assert find_texts(find_ink(PICTURES["lines"])).boxes == ()


@pytest.mark.parametrize("words", ["rain, mm", "Height, m", "litres"])
def test_title_of_an_axis_runs_upwards(words):
    letters = np.rot90(written(words))
    texts = find_marks(letters).texts
    assert [text.direction_deg for text in texts.boxes] == [90]
    assert texts.ink[letters < 100].mean() > 0.95


@pytest.mark.parametrize("words", ["7\n8\n5\n6\n4", "12\n15\n18\n20", "Oslo\nLima"])
def test_words_and_numbers_above_each_other_do_not_run_upwards(words):
    texts = find_marks(written(words)).texts
    assert texts.boxes and all(text.direction_deg < 45 for text in texts.boxes)


@pytest.mark.parametrize(("high", "pairs"), [(23, 1), (25, 0)])
def test_letters_of_one_row_are_of_like_height(high, pairs):
    left, top, wide, highs = np.array([(0, 0, 8, 10), (10, 0, 8, high)]).T
    assert len(_neighbours(left, top, wide, highs)[0]) == pairs


@pytest.mark.parametrize(
    ("copy", "off"), [(None, 0.1), ({"shadow": 0}, 0.2), ({"noise": 0, "shadow": 0, "quality": 50}, 0.2)]
)
def test_areas_are_colours_with_edges_in_place(copy, off):
    picture, truth = countries()
    areas = find_areas(scanned(picture, **copy) if copy else picture)
    assert len(areas.colours) == 4 and areas.paper == areas.labels[0, 0]
    for number, colour in COLOURS.items():
        match = areas.labels == np.abs(areas.colours - colour).sum(axis=1).argmin()
        rim = np.count_nonzero(truth[:, 1:] != truth[:, :-1])
        assert np.count_nonzero(match != (truth == number)) < 2 * off * rim


def test_place_where_areas_meet_is_no_area():
    pie = np.full((400, 400, 3), 255, np.uint8)
    for turn, colour in enumerate([(31, 119, 180), (255, 127, 14), (44, 160, 44), (214, 39, 40), (148, 103, 189)]):
        cv2.ellipse(pie, (200, 200), (150, 150), 0, 72 * turn + 5, 72 * turn + 77, colour, -1, cv2.LINE_AA)
    sizes = np.bincount(find_parts(SegmentMap(find_areas(pie).labels)).labels.reshape(-1))
    assert len(sizes) == 6 and sizes.min() > 9_000


def test_marks_are_found_once_for_equal_pictures():
    picture, _ = house()
    assert find_marks(picture).lines is find_marks(picture.copy()).lines
    picture[100:104, 10:90] = 0
    assert find_marks(picture).lines.mask[102, 50]

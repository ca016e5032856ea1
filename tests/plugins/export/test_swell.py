"""Pages for swell paper, measured by programs that did not draw them: if a case fails, a finger cannot read a page."""

import re
import subprocess
from functools import partial
from pathlib import Path
from xml.etree import ElementTree

import cv2
import numpy as np
import pytest
import shapely
from scipy import ndimage

from exported_pictures import labels_work, pdf_pixels, pixels, work_of
from tangible_core.errors import GeometryError, PictureError
from tangible_core.plugins.notes import collected
from tangible_export.paper import fills, page
from tangible_export.paper.marks import gaps
from tangible_export.swell import Swell

PER_MM = 10
GAP_MM = 3.2
ROUNDING_MM = 1e-5
"""Of single precision; the next smaller distance between pixels is a hundred times as far off."""
SIZES_MM = {"a4": (210, 297), "letter": (215.9, 279.4), "a3": (297, 420)}


@pytest.fixture(
    scope="module",
    params=["coffee", *(pytest.param(each, marks=pytest.mark.whole) for each in ("astronaut", "motorcycle"))],
)
def exported(request, tmp_path_factory) -> tuple[str, tuple[Path, ...], list[str]]:
    swell, folder = Swell(), tmp_path_factory.mktemp("swell")
    with collected() as notes:
        files = swell.write(work_of(request.param, swell), folder / request.param)
    return request.param, files, notes


def svgs(files) -> list[Path]:
    """The pages for the heater, without the copy in ink."""
    return [file for file in files if file.suffix == ".svg" and not file.stem.endswith("-ink")]


def named(files, ending: str) -> Path:
    return next(file for file in files if file.name.endswith(ending))


def halves(labels=(0, 1), shape=(300, 400)) -> np.ndarray:
    labels_of_halves = np.full(shape, labels[0], np.int32)
    labels_of_halves[:, shape[1] // 2 :] = labels[1]
    return labels_of_halves


def braille_dots(root) -> list[np.ndarray]:
    """The dots of each text, in millimetres."""
    groups = root.iterfind(".//*[@data-mark='braille']")
    return [np.array([(float(dot.get("cx")), float(dot.get("cy"))) for dot in group]) for group in groups]


def distances(free: np.ndarray) -> np.ndarray:
    """From each pixel to the nearest that is not free, exact; OpenCV takes a tenth of scipy's time."""
    return cv2.distanceTransform(free.astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)


def least_gap_mm(svg: Path) -> float:
    """Between any two blots of ink but the dots of one text. Outlines that touch are one."""
    root = ElementTree.parse(svg).getroot()
    ink = pixels(svg, 25.4 * PER_MM) < 128
    blots, count = ndimage.label(ink, np.ones((3, 3)))
    text_of = np.zeros(count + 1, int)
    for number, dots in enumerate(braille_dots(root), 1):
        text_of[[blots[int(y * PER_MM), int(x * PER_MM)] for x, y in dots]] = number
    least = np.inf
    reach = int(GAP_MM * PER_MM) + 5
    for number, box in enumerate(ndimage.find_objects(blots), 1):
        window = tuple(slice(max(0, each.start - reach), each.stop + reach) for each in box)
        if np.ptp([box[0].start, box[0].stop]) * np.ptp([box[1].start, box[1].stop]) > 1e6:
            continue  # the net of outlines: each of the others is measured to it
        here = blots[window]
        others = (here > 0) & (here != number)
        if text_of[number]:
            others &= text_of[here] != text_of[number]
        if others.any():
            far = distances(~others)[here == number].min()
            least = min(least, (far - 1) / PER_MM)
    return least


def test_page_marks_keep_the_gap_of_a_finger(exported):
    _, files, _ = exported
    for svg in svgs(files):
        assert least_gap_mm(svg) >= GAP_MM - ROUNDING_MM, svg.name


def test_key_lists_every_part_with_letter_and_fill(exported):
    _, files, _ = exported
    picture, *keys = (ElementTree.parse(svg).getroot() for svg in svgs(files))
    letters, fill_of = {}, {}
    for area in picture:
        if (letter := area.find("./*[@data-mark='braille']")) is not None:
            letters[area.get("aria-label")] = letter.get("aria-label")
    labels_in_key = [each.get("aria-label") for key in keys for each in key.iterfind(".//*[@data-mark='braille']")]
    for key in keys:
        fill_of |= dict(
            each.get("aria-label").split(": ") for each in key if each.find("./*[@data-mark='outline']") is not None
        )
    parts = {each.get("aria-label") for each in picture if each.find("./*[@data-mark='outline']") is not None}
    assert parts <= set(labels_in_key)
    assert set(letters.values()) <= set(labels_in_key)
    assert len(set(letters.values())) == len(letters)
    assert fill_of.keys() == parts
    assert len({*fill_of.values()}) <= 5


def test_pdf_has_all_pages_in_true_size(exported):
    _, files, _ = exported
    pdf, pages = named(files, "-swell.pdf"), svgs(files)
    data = pdf.read_bytes()
    assert b"/Image" not in data.replace(b"/ImageB", b"").replace(b"/ImageC", b"").replace(b"/ImageI", b"")
    assert b"/BaseFont" not in data
    boxes = re.findall(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+) ?\]", data)
    assert len(boxes) == len(pages)
    for number, (svg, box) in enumerate(zip(pages, boxes, strict=True), 1):
        root = ElementTree.parse(svg).getroot()
        sides_mm = [float(root.get(side).removesuffix("mm")) for side in ("width", "height")]
        assert sorted(sides_mm) == list(SIZES_MM["a4"])
        assert [float(side) / 72 * 25.4 for side in box] == pytest.approx(sides_mm, abs=0.01)
        drawn, printed = pixels(svg, 100), pdf_pixels(pdf, number, 100)
        rows, columns = (min(sides) for sides in zip(drawn.shape, printed.shape, strict=True))
        differ = (drawn[:rows, :columns] < 128) != (printed[:rows, :columns] < 128)
        assert differ.mean() < 0.01


def test_parts_without_a_name_have_letters_in_order(tmp_path):
    picture = ElementTree.parse(Swell().write(labels_work(halves(), ("", "sea")), tmp_path / "map")[0]).getroot()
    marks = ((area.get("aria-label"), area.find("./*[@data-mark='braille']")) for area in picture)
    assert {name: mark.get("aria-label") for name, mark in marks if mark is not None} == {"part 1": "b", "sea": "s"}


def test_ink_copy_has_names_and_letters_where_the_parts_are_and_a_scale(tmp_path):
    work = labels_work(halves(), ("land", "sea <1> & $x$"), title="Coast", language="de")
    files = Swell().write(work, tmp_path / "map")
    page_root, ink = (ElementTree.parse(each).getroot() for each in (files[0], named(files, "-swell-ink.svg")))
    for svg in (file for file in files if file.suffix == ".svg"):
        root = ElementTree.parse(svg).getroot()
        assert {root.get("lang"), root.get("{http://www.w3.org/XML/1998/namespace}lang")} == {"de"}, svg.name
    texts = {each.text: (float(each.get("x")), float(each.get("y"))) for each in ink.iterfind("{*}text")}
    for area in page_root.iterfind("{*}g[@aria-label]/*[@data-mark='outline']/.."):
        name, letter = area.get("aria-label"), area.find("./*[@data-mark='braille']").get("aria-label")
        at = np.array(re.findall(r"[ML]([\d.]+) ([\d.]+)", area.find("./*[@data-mark='outline']").get("d")), float)
        assert (at.min(axis=0) < texts[f"{letter} {name}"]).all() and (texts[f"{letter} {name}"] < at.max(axis=0)).all()
    assert {"Coast", "5 cm"} < texts.keys() and any("nicht schwellen" in text for text in texts)
    (scale,) = re.findall(r"M([\d.]+) [\d.]+L([\d.]+) ", ink.find(".//*[@data-mark='scale']").get("d"))
    assert float(scale[1]) - float(scale[0]) == 50
    words = ["pdftotext", "-layout", str(named(files, "-swell-ink.pdf")), "-"]
    pages = subprocess.run(words, check=True, capture_output=True, text=True).stdout.split("\f")[:-1]
    assert len(pages) == len(svgs(files))
    assert all("land" in each and "sea <1> & $x$" in each and "5 cm" in each for each in pages)


@pytest.mark.parametrize(
    ("paper", "shape"), [("letter", (450, 300)), pytest.param("a3", (300, 450), marks=pytest.mark.whole)]
)
def test_page_picture_has_largest_or_given_width(tmp_path, paper, shape):
    for width_m in (None, 0.1):
        swell = Swell(page=paper, width_m=width_m)
        svg = swell.write(labels_work(halves(shape=shape)), tmp_path / "map")[0]
        root = ElementTree.parse(svg).getroot()
        size = [float(root.get(side).removesuffix("mm")) for side in ("width", "height")]
        assert (size[0] > size[1]) == (shape[1] > shape[0])
        assert sorted(size) == sorted(SIZES_MM[paper])
        at = np.array(re.findall(r"[ML]([\d.]+) ([\d.]+)", " ".join(
            each.get("d") for each in root.iterfind(".//*[@data-mark='outline']"))), float)  # fmt: skip
        width, length = np.ptp(at, axis=0)
        assert width == pytest.approx(1000 * swell.picture_width_m(shape[1] / shape[0]), abs=0.011)
        assert length == pytest.approx(width * shape[0] / shape[1], abs=0.011)
        assert at.min() >= 10
        assert (at.max(axis=0) <= np.array(size) - 10).all()
        if width_m:
            assert width == pytest.approx(100, abs=0.011)
        else:
            assert min(size[0] - 20 - width, size[1] - 20 - length) < 13  # the title takes 12 mm


@pytest.mark.parametrize("clear_mm", [0.5, pytest.param(2.0, marks=pytest.mark.whole)])
def test_page_marks_drawn_too_near_are_moved_or_left_out(tmp_path, monkeypatch, clear_mm):
    """The drawing keeps too little from outlines; the page that is measured does not pass until that is corrected."""
    monkeypatch.setattr(fills, "CLEAR_MM", clear_mm)
    monkeypatch.setattr(page, "CLEAR_MM", clear_mm)
    monkeypatch.setattr(page, "fill_shape", partial(fills.fill_shape, clear_mm=clear_mm))
    monkeypatch.setattr(page, "around", lambda dots: shapely.MultiPoint(dots).convex_hull.buffer(0.72 + clear_mm))
    measured: list[int] = []

    def too_near(marks):
        found = gaps.too_near(marks)
        measured.append(len(found))
        return found

    monkeypatch.setattr(page, "too_near", too_near)
    labels = np.zeros((300, 450), np.int32)
    labels[:, 260:], labels[100:200, 100:180] = 1, 2
    svg = Swell().write(labels_work(labels, ("land", "sea", "isle")), tmp_path / "map")[0]
    assert measured[0] > 0 and 0 in measured[1:], "too near at first"
    assert least_gap_mm(svg) >= GAP_MM - ROUNDING_MM
    root = ElementTree.parse(svg).getroot()
    assert len(braille_dots(root)) == 4, "the title and three letters"
    marks = [len(list(each)) or each.get("d").count("M") for each in root.iterfind(".//*[@data-mark='fill']")]
    assert marks and min(marks) > 4, "what is left of a fill is one still"


@pytest.mark.parametrize("width_m", [0.1, None])
def test_page_options_for_a_width_are_those_of_the_least_page_that_takes_it(width_m):
    """On A4, 189 mm upright and 276 mm on its side; on A3, 276 mm and 399 mm; less for the corner."""
    swell = Swell(width_m=width_m)
    own = {} if width_m is None else {"width_m": 0.18}
    assert swell.options_for_width(0.18, 1.0) == own
    assert swell.options_for_width(0.27, 2.0) == ({} if width_m is None else {"width_m": 0.27})
    assert swell.options_for_width(0.27, 1.0) == {"page": "a3"} | ({} if width_m is None else {"width_m": 0.27})
    assert swell.options_for_width(0.28, 1.0) == swell.options_for_width(0.5, 9.0) == {}
    assert Swell(page="a3").options_for_width(0.27, 1.0) == {}


HUNDREDS = np.arange(900, dtype=np.int32).reshape(30, 30).repeat(20, 0).repeat(20, 1)


@pytest.mark.parametrize(
    ("labels", "options", "message", "error"),
    [
        (None, {}, "no parts", PictureError),
        (np.zeros((40, 60), np.int32), {}, "one part", PictureError),
        (halves(shape=(3, 600)), {}, "a finger needs", GeometryError),
        (halves(), {"width_m": 0.4}, "no room", GeometryError),
        (HUNDREDS, {}, "900 parts", PictureError),
    ],
)
def test_page_unreadable_by_finger_is_refused(tmp_path, labels, options, message, error):
    work = labels_work(halves() if labels is None else labels)
    if labels is None:
        work.products["simplified"] = None
    with pytest.raises(error, match=message):
        Swell(**options).write(work, tmp_path / "map")
    assert not list(tmp_path.iterdir())


def test_neighbours_that_feel_the_same_are_a_warning(tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(page, "choose_fills", lambda neighbours, *_: (["blank"] * len(neighbours), [(0, 1)]))
    Swell().write(labels_work(halves(), ("sea", "land")), tmp_path / "map")
    [warning] = [record for record in caplog.records if "neighbours with the same fill" in record.getMessage()]
    assert warning.levelname == "WARNING" and {"sea", "land"} <= set(warning.getMessage().split())


def test_title_without_braille_is_left_out_of_page_and_key(tmp_path):
    with collected() as notes:
        page, key, *_ = Swell().write(labels_work(halves(), ("sea", "land"), title="東京"), tmp_path / "map")
    assert any(note.startswith("the title is left out: '東京'") for note in notes)
    plain, plain_key, *_ = Swell().write(labels_work(halves(), ("sea", "land"), title=""), tmp_path / "plain")
    assert page.read_text().replace("東京", "") == plain.read_text()
    assert key.read_text() == plain_key.read_text()

"""Pins, compared with borders that other code found: if a case fails, a display lacks a border or has a false one."""

import base64
import json
import re
from xml.etree import ElementTree

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from exported_pictures import alpha, labels_work, work_of
from tangible_core.data import PartMap, Relief
from tangible_core.errors import PictureError
from tangible_core.plugins.notes import collected
from tangible_export.pin_display import raising
from tangible_export.pin_display.displays import Display
from tangible_export.pins import Pins


def heights_in(files) -> np.ndarray:
    [path] = [file for file in files if file.suffix == ".json" and "graphic" not in file.name]
    return np.array(json.loads(path.read_text())["heights"])


def wanted(labels: np.ndarray, columns: int, rows: int) -> np.ndarray:
    """Pins on which a border of the map itself lies: each side between two pixels, one after the other."""
    height, width = labels.shape
    scale = min(columns / width, rows / height)
    wide, long = max(1, round(width * scale)), max(1, round(height * scale))
    left, top = (columns - wide) // 2, (rows - long) // 2
    border = np.zeros((rows, columns), bool)
    row, column = np.nonzero(labels[:, 1:] != labels[:, :-1])
    border[top + (2 * row + 1) * long // (2 * height), left + np.minimum(wide - 1, (column + 1) * wide // width)] = True
    row, column = np.nonzero(labels[1:] != labels[:-1])
    border[top + np.minimum(long - 1, (row + 1) * long // height), left + (2 * column + 1) * wide // (2 * width)] = True
    return border


def near(pins: np.ndarray) -> np.ndarray:
    return cv2.dilate(pins.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0


def shares(up: np.ndarray, want: np.ndarray) -> tuple[float, float]:
    """Of borders that have a pin within one pin, and of pins that have no border within one."""
    return float((want & near(up)).sum() / want.sum()), float((up & ~near(want)).sum() / up.sum())


@given(st.data())
def test_pins_of_fields_show_all_borders(tmp_path_factory, data):
    columns, rows = data.draw(st.integers(12, 90)), data.draw(st.integers(12, 60))
    fields = np.random.default_rng(data.draw(st.integers(0, 99))).integers(0, 9, (rows // 4, columns // 4))
    grain = data.draw(st.integers(3, 9))
    labels = fields.repeat(4 * grain, 0).repeat(4 * grain, 1)
    if len(np.unique(labels)) == 1:
        return
    folder = tmp_path_factory.mktemp("pins")
    heights = heights_in(Pins(display={"columns": columns, "rows": rows}).write(labels_work(labels), folder / "fields"))
    shown, false = shares(heights > 0, wanted(labels, columns, rows))
    assert (shown, false) == (1, 0)


def test_pins_picture_is_centred_and_upright(tmp_path):
    labels = np.zeros((60, 60), np.int32)
    labels[:30, :30] = 1  # the upper left quarter
    heights = heights_in(Pins().write(labels_work(labels), tmp_path / "quarter"))
    expected = np.zeros((40, 96), int)
    expected[:20, 28 + 19] = expected[19, 28 : 28 + 20] = 1
    assert np.array_equal(heights, expected)


def test_pins_with_heights_keep_areas_below_borders(tmp_path):
    labels = np.zeros((40, 60), np.int32)
    labels[:, 30:] = 1
    pins = Pins(display="graphiti")
    work = labels_work(labels)
    work.products["relief"] = Relief(np.float32([0, 0.006])[labels], (0.15, 0.1))
    assert (pins.needs, Pins().needs) == (("simplified", "relief"), ("simplified",))
    heights = heights_in(pins.write(work, tmp_path / "step"))
    assert (set(heights[:, :29].ravel()), set(heights[:, 29])) == ({0}, {4})
    assert set(heights[:, 30:].ravel()) == {3}
    text = pins.write(work, tmp_path / "step")
    [patterns] = [each.read_text() for each in text if each.suffix == ".txt"]
    assert patterns == ("\u2800" * 14 + "⢸" + "⣿" * 15 + "\n") * 10
    [svg] = [each.read_text() for each in text if each.suffix == ".svg"]
    assert re.findall(r'fill-opacity="([\d.]+)" d="M(\d+) 0h(\d+)', svg) == [("0.75", "30", "30")]


def test_pin_heights_are_counted_from_the_lowest_and_rounded():
    relief = Relief(np.float32([[2, 3.8, 5.4, 8]]) / 1000, (0.04, 0.01))
    assert raising.heights(relief, 1, 4, 3).tolist() == [[0, 1, 2, 3]]


def test_pin_heights_are_means_of_their_cells_of_which_the_highest_is_the_top():
    relief = Relief(np.float32([[1, 5, 9, 3], [1, 1, 7, 1]]) / 1000, (0.02, 0.01))
    assert raising.heights(relief, 1, 2, 8).tolist() == [[2, 8]]  # means of 1 and 4 mm over the lowest


def test_pin_has_the_part_of_most_of_its_cell_or_the_lower_number():
    def most(columns: list[int], pins: int) -> list[int]:
        labels = np.tile(np.int32(columns), (len(columns), 1))
        return raising.largest_shares(PartMap(labels, (0, 1)), pins, pins)[0].tolist()

    assert most([1, 1, 0, 0] * 3, 3) == [0, 0, 0]
    assert most([1, 1, 1, 0, 0, 0, 0, 1, 0, 1, 0, 1], 3) == [1, 0, 0]
    assert most([1, 0, 0, 0, 0], 3) == [1, 0, 0]  # the first pin has a whole cell and two thirds of the next


@pytest.mark.parametrize(
    ("aspect", "size"), [(0.3, (2, 8)), (1.0, (8, 8)), (1.25, (10, 8)), (4.0, (10, 2)), (99.0, (10, 1)), (0.01, (1, 8))]
)
def test_picture_on_a_display_is_as_large_as_it_can_be(aspect: float, size: tuple[int, int]):
    assert Display(columns=10, rows=8).picture_size(aspect) == size


def test_pins_png_has_a_pixel_a_pin(tmp_path):
    pins = Pins(display="graphiti")
    files = pins.write(work_of("coffee", pins), tmp_path / "coffee")
    picture = cv2.imread(str(files[0]), cv2.IMREAD_UNCHANGED)
    assert np.array_equal(np.rint((255 - picture) / 255 * 4), heights_in(files))


def test_pins_hexadecimal_digits_fit_dot_pad(tmp_path):
    """Written again from the description of the community's toolkit: a digit a half cell, neighbours swapped."""
    pins = Pins(display="dotpad")
    files = pins.write(work_of("motorcycle", pins), tmp_path / "motorcycle")
    up = heights_in(files) > 0
    nibbles = np.zeros(60 * 10, int)
    for row, column in np.argwhere(up):
        nibbles[(column ^ 1) + row // 4 * 60] |= 1 << row % 4
    [digits] = [file.read_text() for file in files if file.suffix == ".hex"]
    assert digits == "".join(f"{nibble:X}" for nibble in nibbles)
    assert not [each for each in Pins().write(work_of("coffee", Pins()), tmp_path / "b") if each.suffix == ".hex"]


@pytest.mark.parametrize(
    "display", [{"columns": 33, "rows": 21, "levels": 2}, pytest.param("monarch", marks=pytest.mark.whole)]
)
def test_pins_svg_alpha_equals_the_pins(tmp_path, display):
    pins = Pins(display=display)
    files = pins.write(work_of("astronaut", pins), tmp_path / "astronaut")
    heights = heights_in(files)
    [svg] = [file for file in files if file.suffix == ".svg"]
    assert np.array_equal(alpha(svg, *heights.shape[::-1]) > 0, heights > 0)


def test_pins_svg_layers_are_named_parts(tmp_path):
    labels = np.zeros((40, 60), np.int32)
    labels[:, 30:] = 1
    files = Pins().write(
        labels_work(labels, ("sea & <sky>", ""), title="Bay & <isle>", language="de"), tmp_path / "map"
    )
    [svg] = [file for file in files if file.suffix == ".svg"]
    root = ElementTree.parse(svg).getroot()
    assert root.get("viewBox") == "0 0 96 40"
    assert [each.tag.rpartition("}")[2] for each in root] == ["title", "g", "g"]
    assert [each.get("data-image-layer") for each in root[1:]] == ["layer-1", "layer-2"]
    assert [each.get("aria-label") for each in root[1:]] == ["sea & <sky>", "Teil 2"]
    head = json.loads(next(file for file in files if file.name == "map-monarch.json").read_text())
    assert head.pop("heights")
    assert [*head.values()] == ["Bay & <isle>", "de", "monarch", 96, 40, 1, ["sea & <sky>", "Teil 2"]]
    assert root[0].text == "Bay & <isle>"
    assert all(len(each) for each in root[1:])  # both sides of a border have it
    [content] = [json.loads(file.read_text()) for file in files if file.name.endswith("-graphic.json")]
    assert content == {"graphic": f"data:image/svg+xml;base64,{base64.b64encode(svg.read_bytes()).decode()}"}


def test_pins_note_names_part_without_a_pin(tmp_path):
    labels = np.zeros((400, 600), np.int32)
    labels[:, 300:], labels[10:12, 10:12] = 1, 2
    with collected() as notes:
        files = Pins().write(labels_work(labels, ("left", "right", "speck")), tmp_path / "map")
    [svg] = [file for file in files if file.suffix == ".svg"]
    assert [layer.get("aria-label") for layer in ElementTree.parse(svg).getroot()[1:]] == ["left", "right"]
    size, count = (
        "60 x 40 of 96 x 40 pins; 1 % are up",
        "2 parts, simplified for this display; other files may have more",
    )
    assert notes == ["too small for a pin: speck", size, count]


FLAT = np.zeros((40, 60), np.int32)
STRIP = np.arange(2, dtype=np.int32).repeat(300)[None].repeat(3, 0)


@pytest.mark.parametrize(
    ("labels", "message"),
    [(None, "no parts"), (FLAT, "one part"), (STRIP, "96 pins wide and 1 long"), (STRIP.T.copy(), "wide and 40 long")],
)
def test_pins_without_border_are_refused(tmp_path, labels, message):
    work = labels_work(FLAT if labels is None else labels)
    if labels is None:
        work.products["simplified"] = None
    with pytest.raises(PictureError, match=message):
        Pins().write(work, tmp_path / "map")
    assert not list(tmp_path.iterdir())


def test_pins_picture_of_three_pins_is_written_and_of_two_refused(tmp_path):
    pins, labels = Pins(display={"columns": 30, "rows": 3}), np.arange(2, dtype=np.int32).repeat(150)[None]
    assert heights_in(pins.write(labels_work(labels.repeat(30, 0)), tmp_path / "map"))[:, 14].tolist() == [1, 1, 1]
    with pytest.raises(PictureError, match="30 pins wide and 2 long"):
        pins.write(labels_work(labels.repeat(20, 0)), tmp_path / "map")


@pytest.mark.parametrize("display", ["braillex", {"columns": 2, "rows": 40}, {"columns": 60, "rows": 40, "levels": 0}])
def test_pins_with_invalid_display_are_refused(display):
    with pytest.raises(ValueError):
        Pins(display=display)

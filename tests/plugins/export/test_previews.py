"""Pictures of what exporters would write: if a case fails, a person judges by a picture of another page or print."""

import numpy as np

from exported_pictures import labels_work, pixels, work_of
from tangible_core.data import Relief, Work
from tangible_core.plugins.notes import collected
from tangible_export.pins import Pins
from tangible_export.stl import Stl
from tangible_export.swell import PREVIEW_PER_MM, Swell


def relief_work(height_m: np.ndarray) -> Work:
    rows, columns = height_m.shape
    return Work("", "en", {"relief": Relief(np.float32(height_m), (0.16, 0.16 * rows / columns))}, None, ())


def test_preview_of_swell_paper_is_the_page_that_is_written(tmp_path):
    work = labels_work(np.arange(2, dtype=np.int32).repeat(150)[None].repeat(200, 0))
    found, svg = Swell().preview(work), Swell().write(work, tmp_path / "a")[0]
    wanted = pixels(svg, 25.4 * PREVIEW_PER_MM)
    rows, columns = (min(sides) for sides in zip(found.shape, wanted.shape, strict=True))
    assert abs(found.shape[0] - wanted.shape[0]) <= 1 and set(np.unique(found)) == {0, 255}
    assert ((found[:rows, :columns] < 128) != (wanted[:rows, :columns] < 128)).mean() < 0.01


def test_preview_of_pins_has_a_dark_disc_for_each_pin_that_is_up(tmp_path):
    import cv2

    work = work_of("coffee", Pins())
    found = Pins().preview(work)
    up = (cv2.imread(str(Pins().write(work, tmp_path / "a")[0]), cv2.IMREAD_GRAYSCALE) == 0).sum()
    assert cv2.connectedComponents((found < 100).astype(np.uint8))[0] - 1 == up > 0


def test_preview_of_a_print_shows_its_higher_half_and_the_light_from_the_left():
    height_m = np.zeros((90, 120))
    height_m[20:70, 30:90] = 0.008
    with collected():
        found = Stl(braille=False, corner_mark=False).preview(relief_work(height_m))
    plate = found[found < 255]
    assert found.shape[1] == 640 and plate.size > 0.5 * found.size
    middle = found[found.shape[0] // 2]
    left, right = (np.flatnonzero(middle < 255)[each] for each in (0, -1))
    inside = middle[left : right + 1].astype(int)
    top = np.median(inside)
    walls = np.flatnonzero(np.abs(inside - top) > 5)
    assert inside[walls[walls < inside.size / 2]].min() > inside[walls[walls > inside.size / 2]].min()

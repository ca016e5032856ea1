"""Label pictures to edit in a paint program."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from tangible_authoring.label_picture import SPARE, distinct_colours, label_picture
from tangible_core.data import SegmentMap
from tangible_core.parts import find_parts
from tangible_core.scene.formats.pictures import read_labels


@pytest.mark.parametrize("count", [1, 2, 12, 255, 256, 257, 1000])
def test_label_picture_is_read_back_as_the_same_parts(count: int, tmp_path: Path):
    labels = (np.arange(count * 6, dtype=np.int32) // 6).reshape(count, 6)
    (tmp_path / "parts.png").write_bytes(label_picture(labels))
    parts = find_parts(SegmentMap(read_labels(tmp_path / "parts.png")))
    assert (parts.labels == labels).all()
    image = Image.open(tmp_path / "parts.png")
    assert image.mode == ("P" if count <= 256 else "RGB")
    colours = np.unique(np.asarray(image.convert("RGB")).reshape(-1, 3), axis=0)
    assert len(colours) == count and not image.has_transparency_data


def test_label_picture_saved_in_rgb_keeps_the_parts(tmp_path: Path):
    labels = np.repeat(np.repeat(np.array([[3, 1, 0], [2, 2, 0]], np.int32), 4, axis=0), 4, axis=1)
    (tmp_path / "parts.png").write_bytes(label_picture(labels))
    Image.open(tmp_path / "parts.png").convert("RGB").save(tmp_path / "saved.png")
    before, after = (find_parts(SegmentMap(read_labels(tmp_path / name))) for name in ("parts.png", "saved.png"))
    assert (before.labels == after.labels).all(), "numbers go by first pixels, not by colours"


def test_palette_has_spare_colours_for_new_parts():
    from io import BytesIO

    image = Image.open(BytesIO(label_picture(np.array([[0, 1]], np.int32))))
    assert image.palette is not None and len(image.palette.palette) == 3 * (2 + SPARE)


def test_distinct_colours_differ_and_few_are_the_first_of_many():
    few, many = distinct_colours(12), distinct_colours(40)
    assert (many[:12] == few).all()
    lab = cv2.cvtColor(few[None].astype(np.float32) / 255, cv2.COLOR_RGB2LAB)[0]
    apart = np.linalg.norm(lab[:, None] - lab, axis=2) + 1e3 * np.eye(12)
    assert apart.min() > 40, "a difference of 2.3 is just noticed"
    assert lab[:, 0].min() > 25 and lab[:, 0].max() < 95, "none is taken for black or white"

"""Label pictures to edit in a paint program: if a case fails, painted parts are read back as others."""

from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from tangible_authoring.label_picture import distinct_colours, label_picture
from tangible_core.data import SegmentMap
from tangible_core.errors import PictureError
from tangible_core.parts import find_parts
from tangible_core.scene.formats.pictures import read_labels


@pytest.mark.parametrize("count", [1, 256, 257, 1000])
def test_label_picture_is_read_back_as_the_same_parts(count: int, tmp_path: Path):
    labels = (np.arange(count * 6, dtype=np.int32) // 6).reshape(count, 6)
    (tmp_path / "parts.png").write_bytes(label_picture(labels))
    parts = find_parts(SegmentMap(read_labels(tmp_path / "parts.png")))
    assert (parts.labels == labels).all()
    image = Image.open(tmp_path / "parts.png")
    assert image.mode == ("P" if count <= 256 else "RGB")
    colours = np.unique(np.asarray(image.convert("RGB")).reshape(-1, 3), axis=0)
    assert len(colours) == count and not image.has_transparency_data


def test_distinct_colours_differ_and_few_are_the_first_of_many():
    few, many = distinct_colours(12), distinct_colours(40)
    assert (many[:12] == few).all()
    lab = cv2.cvtColor(few[None].astype(np.float32) / 255, cv2.COLOR_RGB2LAB)[0]
    apart = np.linalg.norm(lab[:, None] - lab, axis=2) + 1e3 * np.eye(12)
    assert apart.min() > 40, "a difference of 2.3 is just noticed"
    assert lab[:, 0].min() > 25 and lab[:, 0].max() < 95, "none is taken for black or white"


LABELS = np.add.outer(np.arange(60) // 10, np.arange(80) // 10).astype(np.int32)
"""Thirteen labels in squares of 10 pixels."""


def shuffled(image: Image.Image) -> Image.Image:
    """Return the picture with the entries of its palette in another order."""
    order = np.random.default_rng(2).permutation(13)
    other = Image.fromarray(np.argsort(order).astype(np.uint8)[np.asarray(image)])
    other.putpalette(np.reshape(image.getpalette(), (-1, 3))[order].astype(np.uint8).tobytes())
    return other


SAVED: dict[str, Callable[[Image.Image], Image.Image]] = {
    "ours": lambda image: image,
    "colours": lambda image: image.convert("RGB"),
    "alpha": lambda image: image.convert("RGBA"),
    "another palette": lambda image: image.convert("RGB").quantize(16),
    "a palette in another order": shuffled,
}


@pytest.mark.parametrize("save", SAVED.values(), ids=SAVED)
def test_labels_keep_their_numbers(tmp_path: Path, save: Callable[[Image.Image], Image.Image]):
    save(Image.open(BytesIO(label_picture(LABELS)))).save(tmp_path / "a.png")
    assert np.array_equal(read_labels(tmp_path / "a.png"), LABELS)


def test_part_that_was_painted_over_is_gone_and_others_keep_their_order(tmp_path: Path):
    picture = np.array(Image.open(BytesIO(label_picture(LABELS))).convert("RGB"))
    picture[LABELS == 4] = picture[LABELS == 5][0]
    Image.fromarray(picture).save(tmp_path / "a.png")
    without_four = np.where(LABELS > 4, LABELS - 1, LABELS)
    assert np.array_equal(read_labels(tmp_path / "a.png"), without_four)


@pytest.mark.parametrize("how", ["scaled", "compressed"])
def test_mixed_colours_are_refused(tmp_path: Path, how: str):
    image = Image.open(BytesIO(label_picture(LABELS))).convert("RGB")
    if how == "scaled":
        image.resize((240, 180), Image.Resampling.BICUBIC).save(tmp_path / "a.png")
    else:
        image.resize((320, 240), Image.Resampling.NEAREST).save(tmp_path / "a.jpg", quality=95)
    path = next(tmp_path.iterdir())
    with pytest.raises(PictureError, match=r"mixed|mixes"):
        read_labels(path)

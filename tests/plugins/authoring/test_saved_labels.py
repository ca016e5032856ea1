"""Label pictures of ours that a paint program saved again: the parts keep their numbers, or the picture is refused."""

from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tangible_authoring.label_picture import label_picture
from tangible_core.errors import PictureError
from tangible_core.scene.formats.pictures import read_labels

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
    with pytest.raises(PictureError, match=r"colours of parts are mixed|JPEG mixes the colours"):
        read_labels(path)


def test_colours_of_other_programs_keep_the_order_of_their_values(tmp_path: Path):
    colours = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255], [128, 64, 0]], np.uint8)
    Image.fromarray(colours[LABELS % 4]).save(tmp_path / "a.png")
    order = np.argsort(np.argsort(colours.astype(int) @ [1, 1 << 16, 1 << 32]))
    assert np.array_equal(read_labels(tmp_path / "a.png"), order[LABELS % 4])

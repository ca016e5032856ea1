"""Cards of scenes: the picture before its product, lit from the upper left."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tangible_batch import card
from tangible_core import Pipeline

PITCH_M = (0.001, 0.002)
"""Of a column and of a row."""


def middle(height_m: np.ndarray) -> int:
    """Brightness of the middle of a shaded slope."""
    shaded = card._shade(height_m.astype(np.float32), PITCH_M)  # pyright: ignore[reportPrivateUsage]
    return int(shaded[shaded.shape[0] // 2, shaded.shape[1] // 2, 0])


def expected(right: float, down: float) -> int:
    """Brightness of a slope that rises so much to the right and downwards, lit from the upper left."""
    normal, light = np.array([-right, -down, 1.0]), np.array([-1.0, -1.0, 1.2])
    return round(255 * max(0.0, normal @ light / np.linalg.norm(normal) / np.linalg.norm(light)))


@pytest.mark.parametrize("shape", [(160, 160), (640, 640)])
@pytest.mark.parametrize(("right", "down"), [(0.0, 0.0), (0.5, 0.0), (-0.3, 0.0), (0.0, 0.5), (0.2, -0.4)])
def test_slope_is_as_bright_as_its_angle_to_the_light(shape: tuple[int, int], right: float, down: float):
    y, x = np.mgrid[: shape[0], : shape[1]]
    assert middle(right * x * PITCH_M[0] + down * y * PITCH_M[1]) == pytest.approx(expected(right, down), abs=2)


def test_unknown_values_are_black():
    values = np.array([[1.0, 2.0], [np.nan, 3.0]]).repeat(80, 0).repeat(80, 1)
    drawn = card._grey(values)  # pyright: ignore[reportPrivateUsage]
    assert [int(drawn[row, column, 0]) for row in (10, 150) for column in (10, 150)] == [0, 128, 0, 255]


@pytest.mark.parametrize("want", ["parts", "relief"])
def test_card_shows_the_picture_and_then_the_parts_or_the_relief(tmp_path: Path, want: str):
    labels = np.repeat([[0, 1]], 40, 0).repeat(40, 1).astype(np.uint8)
    Image.fromarray(labels).save(tmp_path / "parts.png")
    Image.fromarray(np.full((40, 80, 3), (200, 30, 30), np.uint8)).save(tmp_path / "red.png")
    text = "scene: {photo: red.png, segments: parts.png}\nheights: {by: given}\n"
    (tmp_path / "mine.yaml").write_text(f"{text}want: {want}\n")
    card.write_card(Pipeline.from_yaml(tmp_path / "mine.yaml"), tmp_path)
    with Image.open(tmp_path / card.CARD) as drawn:
        pixels = np.asarray(drawn).astype(int)
    assert np.ptp(pixels[40, 80]) > 100  # red: the picture
    left, right = pixels[40, 200], pixels[40, 280]
    assert np.ptp(left) < 10 and np.ptp(right) < 10
    assert (right[0] > 240 and left[0] < 15) == (want == "parts")

"""Cards of scenes: the picture before its product, lit from the upper left."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tangible_batch.job import CARD, write_card
from tangible_core import Pipeline


@pytest.mark.parametrize("want", ["parts", "relief"])
def test_card_shows_the_picture_and_then_the_parts_or_the_relief(tmp_path: Path, want: str):
    labels = np.repeat([[0, 1]], 40, 0).repeat(40, 1).astype(np.uint8)
    Image.fromarray(labels).save(tmp_path / "parts.png")
    Image.fromarray(np.full((40, 80, 3), (200, 30, 30), np.uint8)).save(tmp_path / "red.png")
    text = "scene: {photo: red.png, segments: parts.png}\nheights: {by: given}\n"
    (tmp_path / "mine.yaml").write_text(f"{text}want: {want}\n")
    write_card(Pipeline.from_yaml(tmp_path / "mine.yaml"), tmp_path)
    with Image.open(tmp_path / CARD) as drawn:
        pixels = np.asarray(drawn).astype(int)
    assert np.ptp(pixels[40, 80]) > 100  # red: the picture
    left, right = pixels[40, 200], pixels[40, 280]
    assert np.ptp(left) < 10 and np.ptp(right) < 10
    assert (right[0] > 240 and left[0] < 15) == (want == "parts")


@pytest.mark.parametrize(("right", "down"), [(0.0, 0.0), (0.5, 0.0), (-0.3, 0.0), (0.0, 0.5), (0.2, -0.4)])
def test_slope_is_as_bright_as_its_angle_to_the_light(tmp_path: Path, right: float, down: float):
    """The relief is 0.04 m wide, of 160 cells or 640, and rises so much to the right and downwards."""
    normal, light = np.array([-right, -down, 1.0]), np.array([-1.0, -1.0, 1.2])
    expected = 255 * max(0.0, normal @ light / np.linalg.norm(normal) / np.linalg.norm(light))
    for cells in (160, 640):
        y, x = np.mgrid[:cells, :cells] * 0.04 / cells
        np.save(tmp_path / "slope.npy", (right * x + down * y).astype(np.float32))
        height_m = float(np.ptp(right * x + down * y)) or 0.01
        space = f"{{width_m: 0.04, relief_m: {height_m}, smooth_m: 0}}"
        (tmp_path / "mine.yaml").write_text(f"scene: {{height: slope.npy}}\nwant: relief\nworkspace: {space}\n")
        write_card(Pipeline.from_yaml(tmp_path / "mine.yaml"), tmp_path)
        with Image.open(tmp_path / CARD) as drawn:
            assert int(np.asarray(drawn)[80, 80, 0]) == pytest.approx(expected, abs=3)

"""If one of these fails, a rule by colour finds other segments than people would name so."""

import cv2
import numpy as np
import pytest
from matplotlib.colors import XKCD_COLORS, to_rgb

from tangible_core.data import SegmentMap
from tangible_core.materials.rules import COLOURS, colour_names, segment_colours

BASIC = [name for name in COLOURS if name not in ("black", "white", "grey")]
SHADES = ("", "light ", "pale ", "bright ", "dull ", "dusty ", "dark ")
SURVEY = {
    f"{shade}{name}": (name, to_rgb(XKCD_COLORS[f"xkcd:{shade}{name}"]))
    for name in BASIC
    for shade in SHADES
    if f"xkcd:{shade}{name}" in XKCD_COLORS
}


def name_of(rgb: tuple[float, float, float]) -> str:
    (name,) = colour_names(cv2.cvtColor(np.float32([[rgb]]), cv2.COLOR_RGB2LAB)[0])
    return COLOURS[name]


@pytest.mark.parametrize("name", SURVEY)
def test_colour_names_agree_with_the_survey(name: str):
    expected, rgb = SURVEY[name]
    assert name_of(rgb) == expected


def test_colours_without_a_hue_are_black_grey_and_white():
    assert [name_of((share,) * 3) for share in (0, 0.5, 1)] == ["black", "grey", "white"]


def test_segment_colour_is_that_of_most_pixels():
    picture = np.zeros((2, 8, 3), np.uint8)
    picture[:, :3] = (0, 0, 255)
    picture[:, 3:4] = (255, 0, 0)
    picture[:, 4:] = (255, 255, 255)
    labels = np.repeat(np.int32([[0, 1]]), 4, axis=1).repeat(2, axis=0)
    assert segment_colours(SegmentMap(labels), picture) == [("blue", 0.75), ("white", 1.0)]

"""Colour names, compared with a survey, and the colours of segments."""

import cv2
import numpy as np
import pytest
from matplotlib.colors import XKCD_COLORS, to_rgb

from tangible_core.data import SegmentMap
from tangible_core.materials.colours import COLOURS, colour_names, segment_colours

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


@pytest.mark.parametrize(
    ("rgb", "expected"),
    [
        ((0, 0, 0), "black"),
        ((1, 1, 1), "white"),
        ((0.5, 0.5, 0.5), "grey"),
        ((0.45, 0.31, 0.19), "brown"),
        ((0.35, 0.55, 0.78), "blue"),
        ((0.24, 0.47, 0.2), "green"),
        ((0.6, 0.25, 0.2), "red"),
    ],
)
def test_colour_names_of_plain_cases(rgb: tuple[float, float, float], expected: str):
    assert name_of(rgb) == expected


def test_segment_colour_is_that_of_most_pixels():
    picture = np.zeros((2, 8, 3), np.uint8)
    picture[:, :3] = (0, 0, 255)
    picture[:, 3:4] = (255, 0, 0)
    picture[:, 4:] = (255, 255, 255)
    labels = np.repeat(np.int32([[0, 1]]), 4, axis=1).repeat(2, axis=0)
    assert segment_colours(SegmentMap(labels), picture) == [("blue", 0.75), ("white", 1.0)]


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "float64", "bool"])
def test_segment_colours_take_any_picture(dtype: str):
    labels = SegmentMap(np.zeros((1, 1), np.int32))
    white = {"uint8": 255, "uint16": 65535, "float64": 1.0, "bool": True}[dtype]
    for shape in ((1, 1), (1, 1, 3), (1, 1, 4)):
        assert segment_colours(labels, np.full(shape, white, dtype)) == [("white", 1.0)]

import numpy as np
from PIL import Image

from drawings import countries, house, page
from tangible_core import Pipeline, Scene
from tangible_core.pipeline.starter import starter


def test_relief_lines_raises_every_line_and_keeps_paper():
    picture, mask = house()
    relief = Pipeline(Scene.photo(picture), relief="lines").relief
    height_m = relief.height_m
    assert height_m[mask].min() > 0.0015 and height_m.max() <= 0.002
    assert (height_m[5:50, 5:100] == 0).all() and height_m.min() == 0
    steepness = np.hypot(*np.gradient(height_m)) / relief.pitch_m[0]
    assert steepness.max() < 1.2


def test_relief_lines_areas_are_steps_and_letters_are_left_out():
    picture, truth = countries()
    relief = Pipeline(Scene.photo(picture), relief="lines").relief.height_m
    levels = [np.median(relief[truth == number]) for number in range(4)]
    assert levels[0] == 0 and min(levels[1:]) > 0.0004 and abs(levels[1] - levels[2]) > 0.0004
    engine = Pipeline(Scene.photo(page(2), kind="lines"), relief="lines")
    assert engine.relief.height_m.max() == 0
    notes = " ".join(outcome.why for outcome in engine.outcomes)
    assert "letters are left out of the relief, at 2 places" in notes and "a line drawing" in notes


def test_starter_of_drawing_has_lines(tmp_path):
    for picture in (house()[0], countries()[0], page()):
        Image.fromarray(picture).save(tmp_path / "picture.png")
        text = starter([tmp_path / "picture.png"], tmp_path / "picture.yaml").text
        assert "relief: lines" in text and "use: flat" in text

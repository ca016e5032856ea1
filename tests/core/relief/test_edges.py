"""If one of these fails, an edge of a picture is not a raised line, or a line is where no edge is."""

import numpy as np
import pytest
from PIL import Image

from drawings import countries, house, page
from onnx_models import mono
from tangible_core import Pipeline, Scene
from tangible_core.data import Views
from tangible_core.data.views import border_pixels
from tangible_core.pipeline.starter import starter
from tangible_core.relief import ReliefChoice, edge_relief
from tangible_core.scene.workspace import FeltSize
from tangible_texture import Hierarchy

SIZE = FeltSize(0.08, 0.002, 0.00025, 3e-5, "fill")
PITCH_M = 0.08 / 320


def lines_of(picture, slope=1.1, **sizes):
    return edge_relief(Views(np.ascontiguousarray(picture)), SIZE._replace(**sizes), ReliefChoice(slope=slope)).height_m


def block(low=60, high=180, shape=(240, 320)):
    """Return a lighter block in the middle."""
    picture = np.full((*shape, 3), low, np.uint8)
    rows, columns = shape
    picture[rows // 4 : 3 * rows // 4, columns // 4 : 3 * columns // 4] = high
    return picture


def test_edge_is_a_line_over_both_sides_and_a_millimetre_wide():
    found = lines_of(block())[120]
    assert found[80] > found[60] + 0.0008, "over the dark side"
    assert found[80] > found[110] + 0.0003, "over the light side"
    assert found[110] > found[40] + 0.0005, "light is higher than dark"
    assert np.abs(np.argmax(found[60:100]) + 60 - 79.5) <= 1.5
    found = lines_of(block())
    assert np.abs(np.diff(found, axis=1)).max() <= 1.1 * PITCH_M * 1.001
    steep = lines_of(block(), slope=0)
    assert np.abs(np.diff(steep, axis=1)).max() > 1.2 * PITCH_M
    foot, top, plateau = (found[120, column] for column in (88, 80, 110))
    assert foot - plateau < 0.1 * (top - plateau), "2 mm from its middle"
    over = np.flatnonzero(found[120, 60:100] > (found[120, 80] + found[120, 110]) / 2)
    assert 0.0005 <= np.ptp(over) * PITCH_M <= 0.0025


def test_weak_edges_and_those_of_colour_alone_are_lines_in_uneven_light():
    picture = np.full((240, 320, 3), (200, 90, 90), np.uint8)
    picture[:, 160:] = (60, 139, 60)
    found = lines_of(picture)[120]
    assert found[159:161].max() > found[100] + 0.0008 and found[159:161].max() > found[220] + 0.0008
    picture = np.full((240, 320), 100.0)
    picture[:, :160] += 100 * (np.arange(160) // 20 % 2)
    picture[100:140, 160:] += np.linspace(100, 75, 160)
    picture[200:230, 250:300] += 75
    found = lines_of(np.repeat(picture[..., None], 3, axis=2).astype(np.uint8))
    steps = 0.4 * SIZE.relief_m
    assert found[98:103, 290].max() > steps + 0.0003, "it continues"
    assert found[195:235, 245:305].max() < steps + 0.0002, "it is alone"
    picture = block().astype(np.int32)
    picture += (
        np.rint(np.random.default_rng(2).normal(0, 5, (120, 160))).astype(np.int32).repeat(2, 0).repeat(2, 1)[..., None]
    )
    found = lines_of(picture.astype(np.uint8))
    rough = 0.4 * SIZE.relief_m * 5 / 120
    assert found[100:140, 110:210].std() < 0.3 * rough
    assert found[120, 160] > found[120, 30] + 0.0005


@pytest.mark.parametrize(("side", "is_line"), [(4, False), (10, False), (12, True)])
def test_edges_shorter_than_ten_times_the_blur_are_no_lines(side, is_line):
    """The blur is 1 mm, so that an edge is a line from 40 pixels of 0.25 mm on: those round a square."""
    picture = np.full((240, 320, 3), 60, np.uint8)
    half = side // 2
    picture[120 - half : 120 + half, 160 - half : 160 + half] = 255
    assert (lines_of(picture).max() > 0.4 * SIZE.relief_m + 1e-4) == is_line


def test_pipeline_by_edges_needs_no_depth():
    pipeline = Pipeline(Scene.photo(block()), relief="edges", cached=False)
    found = pipeline.relief.height_m
    assert np.array_equal(found, lines_of(block()))
    assert pipeline.config.relief_kind == "edges" and pipeline.config.size[1:3] == (0.002, 0.00025)
    assert {outcome.product: outcome.outcome for outcome in pipeline.outcomes}["disparity"] == "skipped"


def test_borders_of_regions_and_maps_are_lines_and_edges_are_not():
    """The regions' border is at column 200; the picture's edges are elsewhere."""
    regions = (np.arange(320) >= 200).astype(np.int32) * np.ones((240, 1), np.int32)
    found = edge_relief(Views(block()), SIZE, ReliefChoice(slope=0), regions).height_m[20]
    assert found.max() > 0.8 * 0.6 * SIZE.relief_m
    assert found[199:201] == pytest.approx(found.max(), rel=1e-5)
    assert np.allclose(found[190:200], found[209:199:-1]), "the line is symmetric"
    assert found[:190].max() < 1e-9, "the step of the picture at column 160 is none"
    seen = np.zeros((240, 320), np.float32)
    seen[:, 196:205] = np.float32([0.3, 0.4, 0.6, 0.7, 0.8, 0.7, 0.6, 0.4, 0.3])
    seen[100:120, 40:43], seen[:, 280:283] = 1, 0.5
    whole = edge_relief(Views(block()), SIZE, ReliefChoice(slope=0), borders=seen).height_m
    found = whole[20]
    assert whole[110, 30:52].max() < 1e-9, "the short ridge"
    assert found[200] > 0.8 * 0.6 * SIZE.relief_m
    assert np.flatnonzero(found > 0.5 * found.max()).tolist() == list(range(198, 203)), "1 mm"
    assert found[:190].max() < 1e-9, "the steps of the picture are none"
    assert found[215:].max() < 1e-9


def woven():
    """Two weaves of equal brightness, upright on the left and lying on the right."""
    rows, columns = np.indices((240, 320))
    phase = np.where(columns < 160, columns, rows)
    return np.repeat((120 + 60 * np.sin(2 * np.pi * phase / 6))[..., None], 3, axis=2).astype(np.uint8)


def test_pipeline_draws_the_border_that_people_would_draw():
    pipeline = Pipeline(Scene.photo(woven()), relief="edges", texture=Hierarchy(), cached=False)
    found = pipeline.relief.height_m
    lines = found[40:200].mean(axis=0)
    assert abs(int(np.argmax(lines)) - 160) <= 4
    assert lines[155:165].max() > lines[40:140].max() + 0.0005
    assert lines[155:165].max() > lines[180:280].max() + 0.0005
    said = {outcome.product: outcome.why for outcome in pipeline.outcomes}["relief"]
    assert "borders that people would draw are raised lines" in said


def test_pipeline_draws_what_a_network_sees(tmp_path, monkeypatch):
    monkeypatch.setenv("TANGIBLE_MODELS_DIR", str(tmp_path))
    picture = block(0, 130)
    picture[:, 30:33] = 255

    def relief(**options):
        pipeline = Pipeline(Scene.photo(picture), relief={"by": "edges", "slope": 0}, **options)
        heights = pipeline.relief.height_m[120]
        return heights, {outcome.product: outcome.why for outcome in pipeline.outcomes}["relief"]

    def has_line(heights, column):
        return heights[column - 2 : column + 3].max() > heights[column + 15] + 0.0006

    before, said = relief()
    assert "edges are raised lines" in said
    assert has_line(before, 80)
    mono(tmp_path / "own.onnx")
    (tmp_path / "own.yaml").write_text("task: borders\noutput: {means: borders}\n")
    found, said = relief()
    assert "borders that people would draw are raised lines; borders: seen by the network own" in said
    assert has_line(found, 31)
    assert not has_line(found, 80)
    regions, said = relief(texture=Hierarchy())
    assert "borders: seen by the network own" in said
    labels = Hierarchy().tree(picture).cut(64, 0.4).labels
    assert (regions[border_pixels(labels)[120]] > 0.9 * 0.6 * SIZE.relief_m).all()
    (tmp_path / "own.onnx").unlink()
    assert np.array_equal(relief(cached=False)[0], before)


def test_lines_and_areas_are_raised_on_paper():
    picture, mask = house()
    relief = Pipeline(Scene.photo(picture), relief="lines").relief
    height_m = relief.height_m
    assert height_m[mask].min() > 0.0015 and height_m.max() <= 0.002
    assert (height_m[5:50, 5:100] == 0).all() and height_m.min() == 0
    steepness = np.hypot(*np.gradient(height_m)) / relief.pitch_m[0]
    assert steepness.max() < 1.2
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

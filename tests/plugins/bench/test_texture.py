"""Texture as a kind to compare: scenes by name, their damage, measures, and a comparison from end to end."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tangible_bench.config.reading import Comparison, parse_comparison
from tangible_bench.measuring.plan import measurements
from tangible_bench.measuring.run import look, run
from tangible_bench.results.summary import cells
from tangible_bench.results.table import Results, tables
from tangible_bench.tasks import damage
from tangible_bench.tasks.texture import PERTURBATIONS, TASK, TextureScene
from tangible_core.errors import ConfigError, PictureError
from tangible_core.plugins.registry import Registry
from tangible_core.testing.synthetic.texture_scenes import KnownSegments, smooth_scene, texture_mosaic

SCENE = smooth_scene(4, (40, 60), seed=1)
TURNED = {"quarter": 1, "flip": 1, "rotate": 20, "scale": 0.5}


def parse(text: str, registry: Registry) -> Comparison:
    return parse_comparison(text, Path("c.yaml"), registry)


@pytest.mark.parametrize(
    ("scene", "what"),
    [
        ("mosaic", "write mosaic/4"),
        ("mosaic/0", "equal to 1"),
        ("{mosaic: 2, smooth: 3}", "mosaic and smooth"),
        ("{smooth: 3, textures: here}", "textures"),
        ("{folder: nowhere}", "picture.png and labels.png"),
        ("mosaic/99", "as many textures"),
    ],
)
def test_invalid_scene_is_refused_before_measuring(registry: Registry, scene: str, what: str):
    with pytest.raises(ConfigError, match=what):
        measurements(parse(f"compare: texture\nmethods: [gradient]\nscenes: [{scene}]\n", registry))


def test_scenes_are_made_or_read_by_their_names(registry: Registry, tmp_path: Path):
    text = "compare: texture\nmethods: [gradient]\nscenes: [smooth/14, {mosaic: 3, seed: 2, width_px: 64}]\n"
    scenes = parse(text, registry).scenes
    assert list(scenes) == ["smooth 14 512x512", "mosaic 3 64x512 seed 2"]
    assert scenes["mosaic 3 64x512 seed 2"].open().digest() == texture_mosaic(3, (512, 64), 2).digest()
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        Image.fromarray(SCENE.picture).save(tmp_path / name / "picture.png")
        Image.fromarray((40 * SCENE.labels).astype(np.uint8)).save(tmp_path / name / "labels.png")
    several = TextureScene(folder=tmp_path).expand()
    assert list(several) == ["one", "two"]
    np.testing.assert_array_equal(several["two"].open().labels, SCENE.labels)
    of_folder = TextureScene(mosaic=2, textures=tmp_path / "one", width_px=32, height_px=48).expand()
    assert [(name, each.open().picture.shape) for name, each in of_folder.items()] == [
        ("mosaic 2 of one 32x48", (48, 32))
    ]
    Image.fromarray(SCENE.picture[1:]).save(tmp_path / "one" / "picture.png")
    with pytest.raises(PictureError, match="60 x 39"):
        TextureScene(folder=tmp_path / "one").open()


@pytest.mark.parametrize(("name", "value"), [("noise", 8), ("gain", 0.5), ("offset", 20), ("light", 0.4)])
def test_damage_to_light_keeps_the_labels(name: str, value: float):
    changed = PERTURBATIONS[name].apply(SCENE, value)
    assert (changed.picture != SCENE.picture).any()
    np.testing.assert_array_equal(changed.labels, SCENE.labels)


@pytest.mark.parametrize(("name", "value"), TURNED.items())
def test_transformed_labels_follow_the_picture(name: str, value: float):
    """A picture of the labels themselves, turned, still shows them, but for pixels that a border crosses."""
    colours = KnownSegments((50 * SCENE.labels).astype(np.uint8), SCENE.labels)
    changed = PERTURBATIONS[name].apply(colours, value)
    assert changed.picture.shape == changed.labels.shape != ()
    agree = np.abs(changed.picture / 50 - changed.labels) < 0.1
    assert agree.mean() > (0.999 if name in ("quarter", "flip") else 0.8)
    assert changed.count == SCENE.count


def test_quarter_turns_flips_and_rotation_by_90_degrees_are_exact():
    back = damage.quarter(damage.quarter(SCENE, 1), 3)
    np.testing.assert_array_equal(back.picture, SCENE.picture)
    np.testing.assert_array_equal(damage.flip(SCENE, 1).labels, SCENE.labels[:, ::-1])
    np.testing.assert_array_equal(damage.flip(SCENE, 0).labels, SCENE.labels[::-1])
    square = smooth_scene(4, (41, 41), seed=1)
    turned, expected = damage.rotate(square, 90), damage.quarter(square, 1)
    np.testing.assert_array_equal(turned.labels, expected.labels)
    np.testing.assert_array_equal(turned.picture, expected.picture)


@pytest.mark.parametrize("degrees", [-45, -10, 3, 30, 45])
@pytest.mark.parametrize("shape", [(40, 40), (30, 90), (90, 30)])
def test_rotated_scene_has_no_empty_corners(degrees: float, shape: tuple[int, int]):
    """A slope stays one: anything from outside would bend it."""
    rows, columns = np.indices(shape)
    slope = KnownSegments((20 + rows + columns).astype(np.uint8), np.zeros(shape, np.int32))
    grey = damage.rotate(slope, degrees).picture.astype(np.float64)
    assert np.abs(np.diff(grey, 2, axis=0)).max() <= 2
    assert np.abs(np.diff(grey, 2, axis=1)).max() <= 2
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    assert np.diff(grey, axis=0).mean() == pytest.approx(cos - sin, abs=0.15)
    assert np.diff(grey, axis=1).mean() == pytest.approx(cos + sin, abs=0.15)


@pytest.mark.parametrize(("factor", "shape"), [(0.5, (20, 30)), (2, (80, 120)), (0.1, (4, 6))])
def test_scaled_scene_has_the_scaled_shape(factor: float, shape: tuple[int, int]):
    scaled = damage.scale(SCENE, factor)
    assert scaled.labels.shape == scaled.picture.shape == shape
    assert scaled.picture.mean() == pytest.approx(SCENE.picture.mean(), abs=4)
    stripes = KnownSegments(np.uint8(255 * (np.indices((40, 60))[1] % 2)), np.zeros((40, 60), np.int32))
    assert factor != 0.5 or damage.scale(stripes, 0.45).picture.std() < 30, "no aliasing"


@pytest.mark.usefixtures("cells_here")
def test_texture_comparison_end_to_end_has_exact_results(registry: Registry, tmp_path: Path):
    """Told the count, `gradient` finds a scene of two greys exactly, turned or not."""
    methods = "[{use: gradient, given: [segments]}, {use: gradient, label: one, segments: 1}]"
    scenes = "[{smooth: 2, width_px: 64, height_px: 48, seed: 1}]\nperturb: [none, {quarter: 1}]"
    text = f"compare: texture\nmethods: {methods}\nscenes: {scenes}\nrepeats: 1\nwarmups: 0\ncalls: 1\n"
    wanted = measurements(parse(text, registry))
    rows = run(look(wanted, tmp_path / "r"), tmp_path / "r", 60, lambda *_: None, lambda *_: None).values()
    assert {(row.method, row.perturb) for row in rows} == set(product(("gradient", "one"), ("none", "quarter 1")))
    one = {"ari": 0, "accuracy": pytest.approx(0.5, abs=0.4), "boundary_px": pytest.approx(80), "segments": 1}
    for row in rows:
        if row.method == "gradient":
            assert row.options["segments"] == 2 and row.measures["ari"] > 0.9 and row.measures["segments"] == 0
        else:
            assert row.error is None and row.measures == one
    means = tables(Results(TASK, cells(rows, None), None))[0]
    assert means.headings == ("method", "*", "ms", "peak MB", "ARI", "accuracy", "boundary px", "segments off")
    assert [row[0] for row in means.rows] == ["gradient", "one"]

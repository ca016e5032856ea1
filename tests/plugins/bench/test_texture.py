"""Texture as a kind to compare: scenes by name, their damage, measures, and a comparison from end to end."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tangible_bench.config.reading import Comparison, parse_comparison
from tangible_bench.measuring.plan import measurements
from tangible_bench.measuring.run import look, run
from tangible_bench.results.summary import cells
from tangible_bench.results.table import Results, tables
from tangible_bench.tasks import transforms
from tangible_bench.tasks.texture import PERTURBATIONS, TASK, measure
from tangible_bench.tasks.texture_scenes import TextureScene
from tangible_core.data import SegmentMap
from tangible_core.errors import ConfigError, PictureError
from tangible_core.plugins.registry import Registry
from tangible_core.testing.synthetic.texture_scenes import KnownSegments, smooth_scene, texture_mosaic

SCENE = smooth_scene(4, (40, 60), seed=1)
TURNED = {"quarter": 1, "flip": 1, "rotate": 20, "scale": 0.5}


def parse(text: str, registry: Registry) -> Comparison:
    return parse_comparison(text, Path("c.yaml"), registry)


def test_measures_of_small_segments_equal_those_by_hand():
    truth = np.repeat(np.int32([[0, 0, 1, 1]]), 3, axis=0)
    found = np.repeat(np.int32([[0, 1, 2, 2]]), 3, axis=0)
    scene = KnownSegments(np.zeros((3, 4), np.uint8), truth)
    assert measure(SegmentMap(truth), scene) == {"ari": 1, "accuracy": 1, "boundary_px": 0, "segments": 0}
    assert measure(SegmentMap(found), scene)["accuracy"] == 0.75
    assert measure(SegmentMap(found), scene)["segments"] == 1
    assert measure(SegmentMap(np.zeros_like(truth)), scene)["segments"] == 1
    assert set(TASK.measures) == set(measure(SegmentMap(found), scene))


def test_scene_names_give_their_options(registry: Registry):
    text = "compare: texture\nmethods: [gradient]\nscenes: [mosaic/4, smooth/14, {mosaic: 3, seed: 2, width_px: 64}]\n"
    scenes = parse(text, registry).scenes
    assert list(scenes) == ["mosaic 4 512x512", "smooth 14 512x512", "mosaic 3 64x512 seed 2"]
    assert scenes["mosaic 3 64x512 seed 2"].open().digest() == texture_mosaic(3, (512, 64), 2).digest()


@pytest.mark.parametrize(
    ("scene", "what"),
    [
        ("mosaic", "no scene is named 'mosaic'; write mosaic/4, smooth/14"),
        ("tiles/4", "no scene is named 'tiles/4'"),
        ("mosaic/0", "greater than or equal to 1"),
        ("{mosaic: 2, smooth: 3}", "one of mosaic, smooth, folder and pairs; this one is mosaic and smooth"),
        ("{smooth: 3, textures: here}", "textures: only a mosaic is made of them; leave them out of smooth"),
        ("{folder: nowhere}", "neither it nor a folder in it holds picture.png and labels.png"),
    ],
)
def test_invalid_scene_is_refused(registry: Registry, scene: str, what: str):
    with pytest.raises(ConfigError, match=what):
        parse(f"compare: texture\nmethods: [gradient]\nscenes: [{scene}]\n", registry)


def test_mosaic_of_too_many_textures_is_refused_before_measuring(registry: Registry):
    wanted = parse("compare: texture\nmethods: [gradient]\nscenes: [mosaic/99]\n", registry)
    with pytest.raises(ConfigError, match="scene mosaic 99 512x512: a mosaic of 99 needs as many textures"):
        measurements(wanted)


def test_folder_of_pictures_with_labels_gives_scenes(tmp_path: Path):
    for name in ("one", "two"):
        folder = tmp_path / name
        folder.mkdir()
        Image.fromarray(SCENE.picture).save(folder / "picture.png")
        Image.fromarray((40 * SCENE.labels).astype(np.uint8)).save(folder / "labels.png")
    several = TextureScene(folder=tmp_path).expand()
    assert list(several) == ["one", "two"]
    np.testing.assert_array_equal(several["two"].open().labels, SCENE.labels)
    Image.fromarray(SCENE.picture[1:]).save(tmp_path / "one" / "picture.png")
    with pytest.raises(PictureError, match=r"picture\.png is 60 x 39 and .*labels\.png 60 x 40"):
        TextureScene(folder=tmp_path / "one").open()


def test_folder_of_textures_makes_a_mosaic(tmp_path: Path):
    for name, seed in (("bark", 0), ("sand", 1)):
        noise = np.random.default_rng(seed).integers(0, 255, (40, 40), dtype=np.uint8)
        Image.fromarray(noise).save(tmp_path / f"{name}.png")
    ((name, scene),) = TextureScene(mosaic=2, textures=tmp_path, width_px=32, height_px=48).expand().items()
    assert name == f"mosaic 2 of {tmp_path.name} 32x48"
    assert scene.open().picture.shape == (48, 32)


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


@pytest.mark.parametrize("scene", [SCENE, KnownSegments(np.dstack([SCENE.picture] * 4), SCENE.labels)])
@pytest.mark.parametrize(("name", "value"), TURNED.items())
def test_transform_accepts_any_picture(scene: KnownSegments, name: str, value: float):
    changed = PERTURBATIONS[name].apply(scene, value)
    assert changed.picture.shape[:2] == changed.labels.shape
    assert np.unique(changed.labels).tolist() == list(range(changed.count))


def test_quarter_turns_and_flips_are_exact():
    back = transforms.quarter(transforms.quarter(SCENE, 1), 3)
    np.testing.assert_array_equal(back.picture, SCENE.picture)
    np.testing.assert_array_equal(transforms.flip(SCENE, 1).labels, SCENE.labels[:, ::-1])
    np.testing.assert_array_equal(transforms.flip(SCENE, 0).labels, SCENE.labels[::-1])


def test_rotation_by_90_degrees_is_a_quarter_turn():
    square = smooth_scene(4, (41, 41), seed=1)
    turned, expected = transforms.rotate(square, 90), transforms.quarter(square, 1)
    np.testing.assert_array_equal(turned.labels, expected.labels)
    np.testing.assert_array_equal(turned.picture, expected.picture)


@pytest.mark.parametrize("degrees", [-45, -10, 3, 30, 45])
@pytest.mark.parametrize("shape", [(40, 40), (30, 90), (90, 30)])
def test_rotated_scene_has_no_empty_corners(degrees: float, shape: tuple[int, int]):
    """A slope stays one: anything from outside would bend it."""
    rows, columns = np.indices(shape)
    slope = KnownSegments((20 + rows + columns).astype(np.uint8), np.zeros(shape, np.int32))
    grey = transforms.rotate(slope, degrees).picture.astype(np.float64)
    assert np.abs(np.diff(grey, 2, axis=0)).max() <= 2
    assert np.abs(np.diff(grey, 2, axis=1)).max() <= 2
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    assert np.diff(grey, axis=0).mean() == pytest.approx(cos - sin, abs=0.15)
    assert np.diff(grey, axis=1).mean() == pytest.approx(cos + sin, abs=0.15)


@pytest.mark.parametrize(("factor", "shape"), [(0.5, (20, 30)), (2, (80, 120)), (0.1, (4, 6))])
def test_scaled_scene_has_the_scaled_shape(factor: float, shape: tuple[int, int]):
    scaled = transforms.scale(SCENE, factor)
    assert scaled.labels.shape == scaled.picture.shape == shape
    assert scaled.picture.mean() == pytest.approx(SCENE.picture.mean(), abs=4)


def test_scaling_down_avoids_aliasing():
    stripes = KnownSegments(np.uint8(255 * (np.indices((40, 60))[1] % 2)), np.zeros((40, 60), np.int32))
    assert transforms.scale(stripes, 0.45).picture.std() < 30


@pytest.mark.usefixtures("cells_here")
def test_texture_comparison_end_to_end_has_exact_results(registry: Registry, tmp_path: Path):
    """Told the count, `gradient` finds a scene of two greys exactly, turned or not."""
    text = """\
compare: texture
methods: [{use: gradient, given: [segments]}, {use: gradient, label: one, segments: 1}]
scenes: [{smooth: 2, width_px: 64, height_px: 48, seed: 1}]
perturb: [none, {quarter: 1}]
repeats: 1
warmups: 0
calls: 1
"""
    wanted = measurements(parse(text, registry))
    path = tmp_path / "r.jsonl"
    rows = run(look(wanted, path), path, 60, lambda *_: None, lambda *_: None).values()
    found = {(row.method, row.perturb): row for row in rows}
    assert {row.error for row in rows} == {None}
    for perturb in ("none", "quarter 1"):
        assert found["gradient", perturb].options["segments"] == 2
        assert found["gradient", perturb].measures["ari"] > 0.9
        assert found["one", perturb].measures == {
            "ari": 0,
            "accuracy": pytest.approx(0.5, abs=0.4),
            "boundary_px": pytest.approx(80),
            "segments": 1,
        }
    results = Results(TASK, cells(rows, None), None)
    means = tables(results)[0]
    assert means.headings == ("method", "*", "ms", "peak MB", "ARI", "accuracy", "boundary px", "segments off")
    assert [row[0] for row in means.rows] == ["gradient", "one"]

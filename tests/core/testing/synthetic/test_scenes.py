"""Synthetic pairs and segments. Otherwise methods would be measured against a wrong truth."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tangible_bench.metrics.standard_sets import visible_pixels
from tangible_core.testing.synthetic.stereo_scenes import (
    SCENES,
    Surface,
    cap,
    everywhere,
    rectangle,
    right_view,
    slanted_plane,
    synthetic_pair,
    texture,
    truly_visible,
)
from tangible_core.testing.synthetic.texture_scenes import (
    CONTRAST,
    FAMILIES,
    GREY,
    builtin_textures,
    curvy_regions,
    folder_textures,
    smooth_scene,
    texture_mosaic,
    without_grey,
)

SHAPE = (24, 96)


def step(far: float, near: float, edge: int = 60) -> list[Surface]:
    return [slanted_plane(1, everywhere, far), slanted_plane(2, rectangle(edge - 0.5, -1, 1000, 1000), near)]


@pytest.mark.parametrize(("far", "near"), [(3, 8), (0, 17), (5.25, 9.75)])
def test_visible_occluded_strip_at_a_step_is_as_wide_as_the_jump(far: float, near: float):
    hidden = ~truly_visible(step(far, near), SHAPE)
    columns = np.arange(SHAPE[1])
    occluded = (columns - far >= 59.5 - near) & (columns < 60)
    outside = columns - far < -0.5
    np.testing.assert_array_equal(hidden, np.tile(occluded | outside, (SHAPE[0], 1)))
    if float(near - far).is_integer():
        assert occluded.sum() == near - far


@pytest.mark.parametrize(
    "surface",
    [
        slanted_plane(1, everywhere, 6.3),
        slanted_plane(1, everywhere, 12, 0.08, -0.05),
        slanted_plane(1, everywhere, 12, -0.2, 0.1),
        cap(1, (48, 12), 60, 9.5),
        cap(1, (40, 10), 80, 3.0, flatness=1.0),
    ],
)
def test_right_view_shows_the_surface_at_its_disparity(surface: Surface):
    """The right view at x - d(x) shows the surface at x: its texture there, and nothing that was resampled."""
    rows, columns = np.indices(SHAPE, np.float64)
    seen = surface.seen_at(columns, rows)
    np.testing.assert_allclose(seen - surface.disparity_px(seen, rows), columns, atol=1e-9)
    inside = surface.region(seen, rows)
    np.testing.assert_allclose(
        right_view([surface], SHAPE)[inside], texture(1, seen, rows)[inside], atol=40 * (~inside).any()
    )


@pytest.mark.parametrize("name", SCENES)
def test_synthetic_pair_is_repeatable_and_explained_by_its_truth(name: str):
    pair = synthetic_pair(name, 160, 120, seed=2)
    again = synthetic_pair(name, 160, 120, seed=2)
    assert pair.digest() == again.digest()
    assert pair.digest() != synthetic_pair(name, 160, 120, seed=3).digest()
    assert pair.views.left.dtype == pair.views.right.dtype == np.uint8
    assert pair.truth_px.shape == pair.visible.shape == (120, 160)
    assert pair.truth_px.min() > 0
    assert pair.truth_px.max() < 0.2 * 160
    assert 0.8 < pair.visible.mean() < 1
    # The mask that is made from pixels alone agrees with the exact one except next to edges.
    assert (visible_pixels(pair.truth_px) == pair.visible).mean() > 0.98
    pair = synthetic_pair(name, 200, 120)
    rows, columns = np.indices(pair.truth_px.shape)
    place = columns - pair.truth_px
    left, share = np.floor(place).astype(int), place % 1
    right = pair.views.right.astype(float)
    sampled = (1 - share) * right[rows, left.clip(0, 199)] + share * right[rows, (left + 1).clip(0, 199)]
    error = np.abs(sampled - pair.views.left)
    assert np.median(error[pair.visible]) < 6
    assert np.median(error[~pair.visible]) > 15


PICTURE_SHAPE = (70, 101)


def random(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def test_without_grey_values_are_the_same_for_all_textures():
    made = [without_grey(family((256, 256), random())) for family in builtin_textures().values()]
    for each in made[1:]:
        np.testing.assert_array_equal(np.sort(each, axis=None), np.sort(made[0], axis=None))
    assert made[0].mean() == pytest.approx(GREY, abs=0.05)
    assert made[0].std() == pytest.approx(CONTRAST, rel=0.01)
    for each in made:
        blocks = each.reshape(4, 64, 4, 64)
        assert blocks.mean(axis=(1, 3)).std() < 0.2 * CONTRAST
        assert blocks.std(axis=(1, 3)).std() < 0.2 * CONTRAST


@pytest.mark.parametrize(
    ("name", "across", "down"),
    [
        ("fibres", 1 / 6, 0),
        ("ripples", 0.03, 1 / 12),
        ("stripes", np.sin(0.6) / 8, np.cos(0.6) / 8),
        ("zigzag", 1 / 7, 1 / 7),
        ("bricks", 0, 1 / 10),
    ],
)
def test_texture_family_has_its_stated_frequency(name: str, across: float, down: float):
    """The strongest wave is within 0.05 cycles a pixel of the stated one, of either sign."""
    made = FAMILIES[name]((512, 512), random())
    power = np.abs(np.fft.rfft2(made - made.mean())) ** 2
    columns, rows = np.meshgrid(np.fft.rfftfreq(512), np.fft.fftfreq(512))
    apart = np.minimum(np.hypot(columns - across, rows - down), np.hypot(columns - across, rows + down))
    assert apart.flat[power.argmax()] < 0.05


def test_curvy_regions_are_large_with_short_borders():
    labels = curvy_regions((256, 256), 6, random())
    areas = np.bincount(labels.ravel())
    assert len(areas) == 6
    assert areas.min() > 256 * 256 / 40
    assert (np.diff(labels, axis=1) != 0).sum() + (np.diff(labels, axis=0) != 0).sum() < 10 * 256


@pytest.mark.parametrize("shape", [(64, 64), PICTURE_SHAPE, (128, 40)])
@pytest.mark.parametrize("segments", [1, 2, 5])
def test_mosaic_has_the_requested_size_and_segments(segments: int, shape: tuple[int, int]):
    scene = texture_mosaic(segments, shape, seed=2)
    assert scene.picture.shape == scene.labels.shape == shape
    assert (scene.picture.dtype, scene.labels.dtype) == (np.uint8, np.int32)
    assert np.unique(scene.labels).tolist() == list(range(segments))
    assert scene.count == segments
    assert scene.digest() == texture_mosaic(segments, shape, seed=2).digest()
    assert scene.digest() != texture_mosaic(segments, shape, seed=3).digest()


def test_scenes_have_textures_and_noise_as_asked(tmp_path: Path):
    flat = {f"grey{level}": lambda shape, _, level=level: np.indices(shape).sum(axis=0) % level for level in (3, 4, 5)}
    scene = texture_mosaic(3, PICTURE_SHAPE, seed=1, textures=flat)
    made = [np.rint(without_grey(each(PICTURE_SHAPE, random()))).astype(np.uint8) for each in flat.values()]
    fits = [[(scene.picture == each)[scene.labels == label].mean() for each in made] for label in range(3)]
    assert (sorted(np.argmax(fits, axis=1)), np.max(fits, axis=1).tolist()) == ([0, 1, 2], [1, 1, 1])
    scene = smooth_scene(7, (200, 150), seed=4)
    assert scene.picture.dtype == np.uint8
    assert scene.count == 7
    plain = smooth_scene(7, (200, 150), seed=4, noise=0)
    difference = scene.picture.astype(float) - plain.picture
    assert difference[(plain.picture > 30) & (plain.picture < 225)].std() == pytest.approx(6, rel=0.1)
    inside = [plain.picture[plain.labels == label] for label in range(7)]
    assert max(np.median(np.abs(each - np.median(each))) for each in inside) <= 12
    Image.fromarray(np.arange(30 * 20, dtype=np.uint8).reshape(30, 20)).save(tmp_path / "ramp.png")
    Image.fromarray(random().integers(0, 255, (50, 60, 3), dtype=np.uint8)).save(tmp_path / "noise.png")
    tmp_path.joinpath("readme.txt").write_text("no picture")
    found = folder_textures(tmp_path)
    assert (list(found), texture_mosaic(2, (80, 90), textures=found).count) == (["noise", "ramp"], 2)
    small = found["ramp"]((90, 20), random())
    np.testing.assert_array_equal(small[:30], small[59:29:-1])
    large = found["noise"]((10, 10), random())
    assert large.shape == (10, 10)
    assert large.max() <= 1

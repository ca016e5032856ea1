"""Nearest points and controlled damage: what they are on surfaces and pictures of which the answer is known."""

import numpy as np
import pytest

from tangible_bench.strokes import (
    LOOP_TICKS,
    LOOPS,
    SURFACES,
    analytic_stroke,
    on_ridge,
    on_step,
    on_waves,
    relief_stroke,
)
from tangible_bench.tasks import damage
from tangible_bench.tasks.depth import PERTURBATIONS
from tangible_core.testing.synthetic.stereo_scenes import synthetic_pair

SMOOTH = ("plane", "ramp", "sphere", "sine", "cone")


def hands(name: str, count: int = 40) -> np.ndarray:
    """Return hands up to 1.5 mm under the surface, on either side of its edges."""
    random, known = np.random.default_rng(5), SURFACES[name].surface((16, 16))
    places = random.uniform(-0.03, 0.03, (count, 2)).tolist()
    return np.array(
        [known.at(x, y, depth) for (x, y), depth in zip(places, random.uniform(0, 0.0015, count), strict=True)]
    )


@pytest.mark.parametrize("name", [*SMOOTH, "ridge"])
def test_nearest_point_no_other_point_is_nearer(name: str):
    known = SURFACES[name].surface((16, 16))
    offsets = np.linspace(-0.004, 0.004, 81)
    for hand in hands(name):
        (found,) = SURFACES[name].nearest(hand[None])
        assert found[2] == pytest.approx(known.height_m(*found[:2]), abs=1e-12)
        others = [(hand[0] + dx, hand[1] + dy) for dx in offsets for dy in offsets]
        squares = [(x - hand[0]) ** 2 + (y - hand[1]) ** 2 + (known.height_m(x, y) - hand[2]) ** 2 for x, y in others]
        assert np.sum((found - hand) ** 2) <= min(squares) + 1e-15


def test_nearest_point_on_ridge_stays_on_its_face():
    """Slope 1, 1 mm under the top: the foot on the left is at x / 2 - 0.5 mm, and leaves its face at x = 1 mm."""
    across = np.linspace(-0.004, 0.004, 801)
    way = np.column_stack([across, np.zeros(801), np.full(801, 0.029)])
    way = way[np.abs(way[:, 0]) > 1e-9]
    found = on_ridge(way, 1.0, 0.03)
    inside = np.abs(way[:, 0]) < 0.001 - 1e-9
    np.testing.assert_allclose(found[inside, 0], way[inside, 0] / 2 - 0.0005, atol=1e-12)
    back = on_ridge(way[::-1], 1.0, 0.03)
    np.testing.assert_allclose(back[inside[::-1], 0], way[::-1][inside[::-1], 0] / 2 + 0.0005, atol=1e-12)
    lower = on_ridge(way - (0, 0, 0.001), 1.0, 0.03)
    right = lower[:, 0] > 0
    assert way[right, 0].min() == pytest.approx(0.002, abs=1.1e-5)
    assert right[np.argmax(right) :].all()


@pytest.mark.parametrize(
    ("hand", "point"),
    [
        ((-0.01, 0.0, -0.001), (-0.01, 0.0, 0.0)),  # under the ground
        ((0.001, 0.002, 0.003), (0.0, 0.002, 0.003)),  # in the wall
        ((0.001, 0.0, -0.001), (0.0, 0.0, 0.0)),  # in the corner
    ],
)
def test_nearest_point_on_step_depends_on_the_way(hand: tuple[float, ...], point: tuple[float, ...]):
    way = np.array([(-0.01, 0.0, 0.001), (-0.001, 0.0, 0.001), hand])
    np.testing.assert_allclose(on_step(way, 0.004)[2], point, atol=1e-15)
    above = np.array([(0.01, 0.0, 0.005), (0.01, 0.0, 0.003), (0.001, 0.0, 0.001), (-0.001, 0.0, -0.001)])
    expected = [(0.01, 0, 0.004), (0.001, 0, 0.004), (-0.001, 0, 0)]
    np.testing.assert_allclose(on_step(above, 0.004)[1:], expected, atol=1e-15)


def test_nearest_point_far_below_a_crest_is_unknown():
    """Beyond the centre of curvature, 1 / (A k^2) = 2.53 mm under the crest, the point above is not a minimum."""
    crest = np.array([0.005, 0.005, 0.008])
    above, beyond = on_waves(np.array([crest - (0, 0, 0.0025), crest - (0, 0, 0.0026)]), 0.004, 0.02)
    np.testing.assert_allclose(above, crest, atol=1e-12)
    assert np.isnan(beyond).all()


@pytest.mark.parametrize("name", SURFACES)
def test_analytic_stroke_scripted_path_is_in_and_out_of_contact(name: str):
    stroke = analytic_stroke(name, 32)
    assert len(stroke.position_m) == LOOPS * LOOP_TICKS + 1
    assert (stroke.position_m[::LOOP_TICKS, 2] > stroke.surface.height_m.max()).all()
    assert np.isfinite(stroke.nearest_m).all()
    away = np.linalg.norm(stroke.nearest_m - stroke.position_m, axis=1)
    assert not away[::LOOP_TICKS].any()
    assert 0.0008 < away.max() < 0.002
    assert (away > 0).mean() > 0.6
    speeds = np.linalg.norm(np.diff(stroke.position_m[:, :2], axis=0), axis=1) / stroke.period_s
    assert speeds.max() < 0.084
    assert speeds.mean() < 0.058


def test_nearest_points_are_unknown_outside_the_surface_and_on_a_relief():
    way = np.array([(0.0, 0.0, 0.019), (0.0, 0.0, 0.021), (0.05, 0.0, 0.0), (1.0, 1.0, 0.0)])
    stroke = analytic_stroke("sphere", 16, path_m=way)
    np.testing.assert_allclose(stroke.nearest_m[:2], [(0, 0, 0.02), (0, 0, 0.021)], atol=1e-15)
    assert np.isnan(stroke.nearest_m[2:]).all()
    surface = SURFACES["sine"].surface((64, 32)).surface
    stroke = relief_stroke(surface)
    assert np.isnan(stroke.nearest_m).all()
    known = SURFACES["sine"].surface((16, 16))
    depths = [known.height_m(x, y) - z for x, y, z in stroke.position_m]
    assert 0.0005 < np.percentile(depths, 90) < 0.0015
    assert np.abs(stroke.position_m[:, :2]).max(axis=0) == pytest.approx([0.03, 0.06], rel=1e-3)


GREY = np.full((64, 64), 100, np.uint8)


def test_damage_follows_its_formulas_and_spreads_by_its_quality():
    assert (damage.gain(GREY, 0.8) == 80).all()
    assert (damage.gain(GREY, 5) == 255).all()
    assert (damage.gamma(GREY, 1.4) == round(255 * (100 / 255) ** 1.4)).all()
    assert (damage.offset(GREY, 20) == 120).all()
    assert (damage.offset(GREY, -200) == 0).all()
    lit = damage.light(GREY, 0.4)
    assert (lit[:, 0] == 60).all() and (lit[:, -1] == 140).all()
    np.testing.assert_array_equal(lit, np.rint(lit[:1].repeat(64, axis=0)))
    np.testing.assert_array_equal(damage.light(np.dstack([GREY] * 3), 0.4)[..., 1], lit)
    point = np.zeros((33, 33), np.uint8)
    point[16, 16] = 255
    blurred = damage.blur(point, 1.0)
    assert blurred[16, 16] == round(255 / (2 * np.pi)) or abs(int(blurred[16, 16]) - 255 / (2 * np.pi)) < 1
    assert (damage.blur(GREY, 3) == 100).all()
    picture = np.random.default_rng(0).integers(0, 255, (64, 64, 3), dtype=np.uint8)
    losses = [np.abs(damage.jpeg(picture, quality) - picture.astype(float)).mean() for quality in (95, 50, 5)]
    assert losses == sorted(losses)
    assert damage.jpeg(GREY, 50).shape == GREY.shape


@pytest.mark.parametrize(("rows", "expected"), [(1, [0, 0, 10, 20]), (-1, [10, 20, 30, 30]), (0.5, [0, 5, 15, 25])])
def test_shift_down_interpolates_and_repeats_the_border(rows: float, expected: list[int]):
    ramp = np.uint8([[0], [10], [20], [30]])
    assert damage.shift_down(ramp, rows)[:, 0].tolist() == expected


def test_noise_has_its_standard_deviation_and_seed_and_is_independent_in_each_channel():
    changes = damage.noise(np.full((64, 64, 3), 100, np.uint8), 5, 0).astype(float) - 100
    assert changes.std() == pytest.approx(5, rel=0.05) and changes.mean() == pytest.approx(0, abs=0.3)
    assert np.abs(np.corrcoef(changes.reshape(-1, 3).T) - np.eye(3)).max() < 0.1
    np.testing.assert_array_equal(damage.noise(GREY, 5, 0), damage.noise(GREY, 5, 0))
    assert (damage.noise(GREY, 5, 0) != damage.noise(GREY, 5, 1)).any()


@pytest.mark.parametrize(
    "picture", [np.full((8, 8), 0.5, np.float32), np.full((8, 8, 4), 32768, np.uint16), np.ones((1, 1), np.bool_)]
)
def test_damage_accepts_every_kind_of_picture(picture: np.ndarray):
    for change in (damage.jpeg, damage.blur, damage.gamma, damage.shift_down, damage.gain):
        changed = change(picture, 1)
        assert changed.dtype == np.uint8 and changed.shape == (*picture.shape[:2], 3)[: picture.ndim]


@pytest.mark.parametrize(
    ("name", "value"), [("noise", 5), ("gain", 0.8), ("gamma", 1.4), ("jpeg", 50), ("blur", 1), ("shift", 1)]
)
def test_perturbation_of_a_pair_changes_its_views_only(name: str, value: float):
    pair = synthetic_pair("steps", 64, 32)
    changed = PERTURBATIONS[name].apply(pair, value)
    off = [
        np.subtract(getattr(changed.views, side), getattr(pair.views, side), dtype=int) for side in ("left", "right")
    ]
    assert off[1].any() and off[0].any() == (name in ("noise", "jpeg", "blur"))
    assert name != "noise" or abs(np.corrcoef(off[0].ravel(), off[1].ravel())[0, 1]) < 0.1
    np.testing.assert_array_equal(changed.truth_px, pair.truth_px)

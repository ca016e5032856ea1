"""Controlled damage: what it does to pictures of which the answer is known."""

import numpy as np
import pytest

from tangible_bench.tasks import damage
from tangible_bench.tasks.depth import PERTURBATIONS
from tangible_core.testing.synthetic.stereo_scenes import synthetic_pair

GREY = np.full((64, 64), 100, np.uint8)


def test_gain_and_gamma_follow_their_formulas():
    assert (damage.gain(GREY, 0.8) == 80).all()
    assert (damage.gain(GREY, 5) == 255).all()
    assert (damage.gamma(GREY, 1.4) == round(255 * (100 / 255) ** 1.4)).all()


def test_offset_and_light_follow_their_formulas():
    assert (damage.offset(GREY, 20) == 120).all()
    assert (damage.offset(GREY, -200) == 0).all()
    lit = damage.light(GREY, 0.4)
    assert (lit[:, 0] == 60).all() and (lit[:, -1] == 140).all()
    np.testing.assert_array_equal(lit, np.rint(lit[:1].repeat(64, axis=0)))
    np.testing.assert_array_equal(damage.light(np.dstack([GREY] * 3), 0.4)[..., 1], lit)


def test_blur_keeps_the_sum_and_spreads_a_point():
    point = np.zeros((33, 33), np.uint8)
    point[16, 16] = 255
    blurred = damage.blur(point, 1.0)
    assert blurred[16, 16] == round(255 / (2 * np.pi)) or abs(int(blurred[16, 16]) - 255 / (2 * np.pi)) < 1
    assert (damage.blur(GREY, 3) == 100).all()


def test_jpeg_loses_more_at_lower_quality():
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

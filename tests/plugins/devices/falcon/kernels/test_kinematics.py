"""A Falcon's tip would be in the wrong place or its force point the wrong way: the documented points."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_devices.falcon.kernels import kinematics

START = (0.0, 0.0, 0.11)


@st.composite
def tips(draw: st.DrawFn, radius_m: float = 0.05) -> tuple[float, float, float]:
    """Points of a ball about the centre, a quarter wider than the workspace."""
    away = np.array(draw(st.tuples(*[st.floats(-radius_m, radius_m)] * 3)))
    away *= min(1.0, radius_m / max(float(np.linalg.norm(away)), 1e-9))
    return float(away[0]), float(away[1]), float(kinematics.CENTRE_M + away[2])


@pytest.mark.parametrize(
    ("tip", "angles_deg"),
    [
        ((0, 0, 0.08), (-11.8, -11.8, -11.8)),
        ((0, 0, 0.11), (16.188, 16.188, 16.188)),
        ((0, 0, 0.125), (27.71, 27.71, 27.71)),
        ((0, 0, 0.17), (66.76, 66.76, 66.76)),
        ((0.02, -0.03, 0.13), (54.981, 20.707, 32.814)),
        ((-0.04, 0.02, 0.15), (39.004, 75.536, 50.537)),
    ],
)
def test_inverse_of_documented_tips_gives_angles(
    tip: tuple[float, float, float], angles_deg: tuple[float, float, float]
):
    assert np.degrees(kinematics.inverse(*tip)) == pytest.approx(angles_deg, abs=6e-3)


@given(tips(), tips())
def test_forward_from_any_start_finds_the_tip(tip: tuple[float, float, float], start: tuple[float, float, float]):
    *tip_again, ok = kinematics.forward(*kinematics.inverse(*tip), *start)
    assert ok
    assert np.linalg.norm(np.subtract(tip_again, tip)) <= 1e-9


@given(tips())
def test_jacobian_matches_central_differences(tip: tuple[float, float, float]):
    angles, step = kinematics.inverse(*tip), 1e-5

    def moved(axis: int, steps: int) -> np.ndarray:
        return np.array(kinematics.inverse(*np.add(tip, steps * step * np.eye(3)[axis])))

    slopes = [(8 * (moved(k, 1) - moved(k, -1)) - (moved(k, 2) - moved(k, -2))) / (12 * step) for k in range(3)]
    rows = np.array(kinematics.jacobian(*angles, *tip))
    assert np.abs(rows - np.transpose(slopes)).max() <= 1e-6 * np.abs(rows).max()


@given(tips(), st.tuples(*[st.floats(-10, 10)] * 3))
def test_torques_do_the_work_of_the_force(tip: tuple[float, float, float], force: tuple[float, float, float]):
    """Virtual work: F . dx = tau . dtheta for each small motion, so F = rows^T tau."""
    rows = kinematics.jacobian(*kinematics.inverse(*tip), *tip)
    assert np.transpose(rows) @ kinematics.torques(rows, force) == pytest.approx(force, abs=1e-12)


@pytest.mark.parametrize(
    ("force", "z", "counts"),
    [
        ((0, 0, -12.5), 0.125, (3155, 3155, 3155)),
        ((10, 0, 0), 0.125, (-1789, 6060, -4271)),
        ((10, 0, 0), 0.11, (-1549, 5272, -3724)),
    ],
)
def test_torques_match_documented_counts(force: tuple[float, float, float], z: float, counts: tuple[int, int, int]):
    rows = kinematics.jacobian(*kinematics.inverse(0.0, 0.0, z), 0.0, 0.0, z)
    newtons = (float(force[0]), float(force[1]), float(force[2]))
    assert np.round(-1e4 * np.array(kinematics.torques(rows, newtons))) == pytest.approx(counts, abs=1)


@pytest.mark.parametrize(
    "angles",
    [(2.0, -1.0, 2.0), (3.0, 3.0, 3.0), (0.5 + 2 * math.pi, 0.5, 0.5), (math.nan, 0.5, 0.5), (math.inf, 0.5, 0.5)],
)
def test_forward_of_impossible_angles_returns_the_last_tip(angles: tuple[float, float, float]):
    assert kinematics.forward(*angles, *START) == (*START, False)


@given(st.tuples(*[st.floats()] * 6))
def test_forward_of_any_numbers_ends_and_is_finite_if_found(six: tuple[float, ...]):
    *tip_again, ok = kinematics.forward(*six)
    assert not ok or np.isfinite(tip_again).all()


@pytest.mark.parametrize("far", [(0.0, 0.0, 0.3), (0.3, 0.0, 0.1), (0.0, 0.0, 0.0)])
def test_inverse_out_of_reach_is_nan(far: tuple[float, float, float]):
    assert not np.isfinite(kinematics.inverse(*far)).all()

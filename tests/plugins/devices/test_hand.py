"""The simulated hand would gain energy or press too hard: its motion, free and on ground."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from level_ground import GROUND, GROUND_M, feel
from tangible_core.data import Force
from tangible_devices.hand import MovingHand, VirtualHand, free_motion
from tangible_devices.mock import Mock
from tangible_render.penalty_gradient import PenaltyGradient


class TestHand:
    @given(st.floats(1e-3, 100), st.floats(0, 1e4), st.floats(0.1, 1e6), st.floats(1e-5, 1))
    def test_hand_motion_is_exact_and_never_gains_energy(self, mass: float, damping: float, k: float, period: float):
        """The motion over T is the one over T/2 twice, and sqrt(k) x, sqrt(m) v never grow."""
        hand = VirtualHand(mass_kg=mass, damping_n_s_per_m=damping, stiffness_n_per_m=k)
        whole, half = np.array(free_motion(hand, period)), np.array(free_motion(hand, period / 2))
        energy = np.diag([math.sqrt(k), math.sqrt(mass)])
        scaled = energy @ whole @ np.linalg.inv(energy)
        twice = energy @ half @ half @ np.linalg.inv(energy)
        assert np.allclose(scaled, twice, atol=1e-7)
        assert np.linalg.norm(scaled, 2) <= 1 + 1e-7

    def test_hand_without_damping_swings(self):
        hand = VirtualHand(mass_kg=0.25, damping_n_s_per_m=0, stiffness_n_per_m=100)
        (xx, xv), (vx, vv) = free_motion(hand, 0.03)
        angle = 20 * 0.03
        assert (xx, xv) == pytest.approx((math.cos(angle), math.sin(angle) / 20), rel=1e-12)
        assert (vx, vv) == pytest.approx((-20 * math.sin(angle), math.cos(angle)), rel=1e-12)

    def test_hand_rests_where_spring_balances_force(self):
        hand = MovingHand(VirtualHand(press_n=100), (0.0, 0.0, 0.03), 0.001)
        for _ in range(5000):
            hand.step((0.01, -0.01, -0.005), Force(0.3, -0.6, 0.9))
        assert hand.position_m == pytest.approx((0.011, -0.012, -0.002), abs=1e-12)
        assert hand.velocity_m_per_s == pytest.approx((0, 0, 0), abs=1e-12)

    def test_hand_on_ground_presses_by_its_spring(self):
        mock = Mock(path="circle", z_m=GROUND_M - 0.003, hand=VirtualHand(stiffness_n_per_m=200.0))
        with mock.open() as link:
            state, force = feel(link, PenaltyGradient(stiffness_n_per_m=800).touch(GROUND), 3000)[-1]
        assert force.z == pytest.approx(200 * (state.position_m[2] - mock.z_m), rel=1e-9)
        assert force.z == pytest.approx(0.003 * 200 * 800 / 1000, rel=1e-9)  # two springs in a row

    def test_hand_presses_with_limited_strength(self):
        with Mock(path="circle", z_m=-1.0, hand=VirtualHand(press_n=1.25)).open() as link:
            ticks = feel(link, PenaltyGradient(stiffness_n_per_m=800).touch(GROUND), 3000)
        state, force = ticks[-1]
        assert force.z == pytest.approx(1.25, rel=1e-9)
        assert state.position_m[2] == pytest.approx(GROUND_M - 1.25 / 800, rel=1e-9)

    @pytest.mark.parametrize("stiffness", [200.0, 800.0, 3000.0])
    def test_hand_on_wall_at_one_kilohertz_is_stable(self, stiffness: float):
        """The hand's 6 N s/m are over K T / 2 = 1.5 N s/m, so a sampled wall of 3 N/mm is passive."""
        with Mock(path="circle").open() as link:
            ticks = feel(link, PenaltyGradient(stiffness_n_per_m=stiffness).touch(GROUND), 4000)
        place, force = np.array([state.position_m for state, _ in ticks]), np.array([force for _, force in ticks])
        assert np.abs(np.diff(place[-1000:, 2])).max() < 1e-12
        assert force[:, 2].max() < 8
        landed = int(np.flatnonzero(force[:, 2])[0])
        kinetic = 0.05 * np.square(ticks[landed][0].velocity_m_per_s).sum()
        given_back = np.sum(force[:-1] * np.diff(place, axis=0))
        assert given_back < 0.25 * kinetic

"""A simulated device or hand would follow another path than its options say, gain energy or press too hard."""

import math
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.data import Force, HapticState, HapticSurface
from tangible_core.errors import DeviceError, OptionError
from tangible_core.plugins.interfaces import Link, Touch
from tangible_devices.mock import Mock
from tangible_devices.simulated import MovingHand, VirtualHand, free_motion
from tangible_render.penalty_gradient import PenaltyGradient

GROUND_M = 1 / 128  # exact in float32
GROUND = HapticSurface.from_heights(np.full((8, 8), GROUND_M))


def read(link: Link, count: int) -> list[HapticState]:
    return [link.read() for _ in range(count)]


def positions(mock: Mock, count: int) -> np.ndarray:
    with mock.open() as link:
        return np.array([state.position_m for state in read(link, count)])


def feel(link: Link, touch: Touch, count: int) -> list[tuple[HapticState, Force]]:
    felt = []
    for _ in range(count):
        state = link.read()
        link.write(touch.force(state))
        felt.append((state, link.applied))
    return felt


def write_csv(folder: Path, text: str | bytes) -> Path:
    path = folder / "hand.csv"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


class TestPaths:
    def test_raster_follows_lines_and_circle_an_ellipse_of_their_sizes(self):
        """Two lines of 60 mm, 40 mm apart, and the way back: 200 mm at 0.1 m/s are 2000 ticks."""
        places = positions(Mock(hand=None, lines=2, size_m=(0.06, 0.04), z_m=-0.001, speed_m_per_s=0.1), 4001)
        corners = {0: (-0.03, 0.02), 600: (0.03, 0.02), 1000: (0.03, -0.02), 1600: (-0.03, -0.02), 300: (0, 0.02)}
        for tick, (x, y) in corners.items():
            assert places[tick] == pytest.approx((x, y, -0.001), abs=1e-15)
        assert np.array_equal(places[:2000], places[2000:4000])
        assert np.allclose(np.linalg.norm(np.diff(places, axis=0), axis=1), 1e-4, rtol=1e-9)
        places = positions(Mock(hand=None, path="circle", size_m=(0.06, 0.02)), 2000)
        assert np.abs(np.hypot(places[:, 0] / 0.03, places[:, 1] / 0.01) - 1).max() < 1e-5
        assert tuple(places[0]) == (0.03, 0.0, -0.005)
        assert places[100, 1] > 0  # counter-clockwise
        places = positions(Mock(hand=None, path="press", z_m=-0.01, lift_m=0.03, speed_m_per_s=0.08), 2001)
        assert not places[:, :2].any()
        assert places[[0, 500, 1000, 1500], 2] == pytest.approx([0.03, -0.01, 0.03, -0.01], abs=1e-15)
        assert places[250, 2] == pytest.approx(0.01, abs=1e-15)
        with Mock(period_s=0.002).open() as link:
            assert [state.time_s for state in read(link, 200)] == [tick * 0.002 for tick in range(200)]

    def test_spiral_fills_its_size_and_tremor_is_bounded(self):
        mock = Mock(hand=None, path="spiral", size_m=(0.04, 0.04), lines=4, speed_m_per_s=0.1)
        places = positions(mock, 10000)
        radius = np.hypot(places[:, 0], places[:, 1])
        lap = int(np.flatnonzero(radius[1000:] < 1e-9)[0]) + 1000
        assert radius[0] == 0
        assert radius.max() == pytest.approx(0.02, rel=1e-5)
        assert np.allclose(places[: lap // 2], places[lap - 1 : lap - 1 - lap // 2 : -1], atol=2e-4)
        assert np.array_equal(places[: lap + 1][:500], places[lap : lap + 500])
        right = places[: lap // 2][np.flatnonzero(np.diff(np.sign(places[: lap // 2, 1])) > 0)]
        assert np.allclose(np.diff(right[:, 0]), 0.02 / 4, atol=2e-4)
        still, one, same, other = (
            positions(Mock(hand=None, tremor_m=tremor, seed=seed), 2000)
            for tremor, seed in ((0, 1), (1e-4, 1), (1e-4, 1), (1e-4, 2))
        )
        assert np.array_equal(one, same)
        assert not np.array_equal(one, other)
        assert 3e-5 < np.abs(one - still).max() <= 1e-4
        spectrum = np.abs(np.fft.rfft((one - still)[:, 0]))
        assert 8 <= np.argmax(spectrum) / 2 <= 12  # 2 s: half a hertz a bin


class TestCsv:
    def test_csv_is_played_exactly_and_then_held(self, tmp_path: Path):
        text = "x_m,time_s,note,z_m,y_m\n0,5,a,0.01,0\n0.004,5.004,b,0.01,0\n0.004,5.006,c,0.01,0.004\n"
        places = positions(Mock(hand=None, path="csv", csv_file=write_csv(tmp_path, text)), 10)
        x = [0, 0.001, 0.002, 0.003, 0.004, 0.004, 0.004, 0.004, 0.004, 0.004]
        y = [0, 0, 0, 0, 0, 0.002, 0.004, 0.004, 0.004, 0.004]
        assert np.allclose(places, np.column_stack([x, y, np.full(10, 0.01)]), atol=1e-12)
        path = write_csv(tmp_path, b"\xef\xbb\xbftime_s,x_m,y_m,z_m\r\n0,1e-3,2e-3,3e-3\r\n")
        assert np.array_equal(positions(Mock(hand=None, path="csv", csv_file=path), 3), [[0.001, 0.002, 0.003]] * 3)

    @pytest.mark.parametrize(
        ("text", "place"),
        [
            ("", ":1:"),
            ("time_s,x_m,y_m\n0,0,0\n", ":1: "),
            ("time_s,x_m,y_m,z_m\n", ": has no rows"),
            ("time_s,x_m,y_m,z_m\n0,0,0,0\n1,0,abc,0\n", ":3: y_m"),
            ("time_s,x_m,y_m,z_m\n0,0,0,nan\n", ":2: z_m"),
            ("time_s,x_m,y_m,z_m\n0,0,0\n", ":2: z_m"),
            ("time_s,x_m,y_m,z_m\n0,0,0,0\n2,0,0,0\n2,0,0,0\n", ":4:"),
            (b"\xff\xfe\x00\x01", ""),
            (b'time_s,x_m,y_m,z_m\n"' + b"0" * 200_000, ""),
        ],
    )
    def test_csv_with_fault_is_refused_at_its_place(self, tmp_path: Path, text: str, place: str):
        path = write_csv(tmp_path, text)
        with pytest.raises(DeviceError) as caught:
            Mock(path="csv", csv_file=path).open()
        assert str(caught.value).startswith(f"{path}{place}")

    def test_csv_missing_is_refused(self, tmp_path: Path):
        for path in (tmp_path / "none.csv", tmp_path):
            with pytest.raises(DeviceError, match="cannot be read"):
                Mock(path="csv", csv_file=path).open()

    @pytest.mark.timeout(20)
    def test_csv_from_pipe_or_device_is_refused_at_once(self, tmp_path: Path):
        os.mkfifo(tmp_path / "pipe.csv")
        for path in (tmp_path / "pipe.csv", Path("/dev/zero")):
            with pytest.raises(DeviceError, match="not a file"):
                Mock(path="csv", csv_file=path).open()


class TestLink:
    def test_link_force_at_limit_is_kept_and_above_is_scaled(self):
        with Mock().open() as link:
            for wanted, held in ((Force(0.0, 4.8, -6.4), (0, 4.8, -6.4)), (Force(0.0, 8.0001, 0.0), (0, 8, 0))):
                link.write(wanted)
                assert link.applied == pytest.approx(held, rel=1e-12)


def test_spec_is_that_of_a_falcon():
    spec = Mock().spec()
    assert (spec.max_force_n, spec.max_stiffness_n_per_m, spec.damping_n_s_per_m) == (8.0, 3000.0, 20.0)
    assert spec.simulated


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ({"path": "zigzag"}, "path"),
        ({"path": "csv"}, "csv_file go together"),
        ({"lift_m": -0.01}, "must be above z_m"),
        ({"size_m": (0, 0.04)}, "size_m"),
        ({"speed_m_per_s": 0}, "speed_m_per_s"),
        ({"z_m": math.nan}, "z_m"),
        ({"lines": 1}, "lines"),
        ({"hand": {"mass_kg": 0}}, "mass_kg"),
        ({"seed": -1}, "seed"),
        ({"period_s": 0}, "period_s"),
    ],
)
def test_options_that_contradict_are_refused(options: dict, complaint: str):
    with pytest.raises(OptionError, match=complaint):
        Mock(**options)


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

    def test_hand_swings_or_rests_where_its_spring_balances_force(self):
        hand = VirtualHand(mass_kg=0.25, damping_n_s_per_m=0, stiffness_n_per_m=100)
        (xx, xv), (vx, vv) = free_motion(hand, 0.03)
        angle = 20 * 0.03
        assert (xx, xv) == pytest.approx((math.cos(angle), math.sin(angle) / 20), rel=1e-12)
        assert (vx, vv) == pytest.approx((-20 * math.sin(angle), math.cos(angle)), rel=1e-12)
        hand = MovingHand(VirtualHand(press_n=100), (0.0, 0.0, 0.03), 0.001)
        for _ in range(5000):
            hand.step((0.01, -0.01, -0.005), Force(0.3, -0.6, 0.9))
        assert hand.position_m == pytest.approx((0.011, -0.012, -0.002), abs=1e-12)
        assert hand.velocity_m_per_s == pytest.approx((0, 0, 0), abs=1e-12)

    def test_hand_on_ground_presses_by_its_spring_with_limited_strength(self):
        mock = Mock(path="circle", z_m=GROUND_M - 0.003, hand=VirtualHand(stiffness_n_per_m=200.0))
        with mock.open() as link:
            state, force = feel(link, PenaltyGradient(stiffness_n_per_m=800).touch(GROUND), 3000)[-1]
        assert force.z == pytest.approx(200 * (state.position_m[2] - mock.z_m), rel=1e-9)
        assert force.z == pytest.approx(0.003 * 200 * 800 / 1000, rel=1e-9)  # two springs in a row
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

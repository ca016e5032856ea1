"""A Falcon would be read wrongly or pushed the wrong way: trusted answers, velocity, the force that is sent."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from falcon_streams import buffers
from tangible_devices.falcon.calibration import LEVER_M, Calibration
from tangible_devices.falcon.kernels import kinematics, packet, tick
from tangible_devices.falcon.kernels.framing import DOUBTFUL, FRESH, NEW
from tangible_devices.falcon.kernels.tick import rates


class Falcon:
    """The kernels on separate buffers, fed with whole answers."""

    def __init__(self, calibration: Calibration | None = None) -> None:
        chosen = calibration or Calibration()
        self.buffers = buffers()._replace(arms=chosen.arms(), frame=chosen.frame())
        self.counts, self.held = self.buffers.counts, self.buffers.held
        self.state = np.full(7, np.nan)

    def tell(self, counts: np.ndarray, after_s: float = 0.001, info: int = packet.HOMED) -> int:
        packet.encode(*map(int, counts), 0, self.buffers.answer)
        self.buffers.answer[packet.INFO] = packet.ZERO + info
        self.held[tick.NOW] += after_s
        self.counts[FRESH] = NEW
        return tick.read(*self.buffers, self.state)

    def settle(self, counts: np.ndarray, seconds: float = 1.0) -> None:
        for _ in range(round(1000 * seconds)):
            self.tell(counts)

    def push(self, x: float, y: float, z: float) -> tuple[list[int], np.ndarray]:
        tick.write(*self.buffers, x, y, z)
        return list(packet.decode(self.buffers.packet)), self.held[tick.APPLIED : tick.APPLIED + 3]


def counts_at(x: float, y: float, z: float) -> np.ndarray:
    """Encoders of a tip in the workspace frame."""
    angles = np.array(kinematics.inverse(x, z, kinematics.CENTRE_M - y))
    return np.round((angles - math.radians(35)) / kinematics.RAD_PER_COUNT).astype(int)


@pytest.mark.parametrize("axes", [("y", "-z", "x"), ("-z", "x", "-y"), ("-y", "-x", "z"), ("x", "y", "z")])
def test_axes_turn_position_velocity_and_force_alike(axes: tuple[str, str, str]):
    """Two Falcons get the same answers, and forces that are one in the frame of the device."""
    plain, turned = Falcon(), Falcon(Calibration(axes=axes))
    turn = turned.buffers.frame[:, :3] @ plain.buffers.frame[:, :3].T
    for tick_number in range(60):
        counts = counts_at(0.0002 * tick_number, 0.01 - 0.0001 * tick_number, 0.02 - 0.0003 * tick_number)
        for falcon in (plain, turned):
            falcon.tell(counts)
    device_m = plain.buffers.frame[:, :3].T @ (plain.state[:3] - plain.buffers.frame[:, 3])
    assert turned.state[:3] == pytest.approx(turned.buffers.frame @ [*device_m, 1])
    assert plain.state[3:6] == pytest.approx([0.2, -0.1, -0.3], rel=0.2)
    assert turned.state[3:6] == pytest.approx(turn @ plain.state[3:6])
    for falcon in (plain, turned):
        falcon.settle(counts_at(0.0, 0.0, 0.0))
    force_n = np.array([0.5, -1.0, 1.5])
    packets = [falcon.push(*force)[0] for falcon, force in ((plain, force_n), (turned, turn @ force_n))]
    assert packets[0] == packets[1]
    assert len(set(packets[0][:3])) == 3


def test_read_first_position_waits_for_a_second():
    falcon, counts = Falcon(), counts_at(0, 0, 0)
    assert [falcon.tell(counts) for _ in range(3)] == [0, 1, 1]


def test_homing_lost_removes_force_and_fades_in_again():
    falcon, counts = Falcon(), counts_at(0, 0, 0)
    falcon.settle(counts)
    whole, _ = falcon.push(0, 0, 5)
    falcon.tell(counts, info=0x30)
    assert falcon.push(0, 0, 5)[0][:3] == [0, 0, 0]
    sizes = []
    for _ in range(600):
        falcon.tell(counts + 300)
        sizes.append(falcon.push(0, 0, 5)[1][2])
    assert sizes[0] == 0 and sizes[-1] == 5
    assert np.diff(sizes).max() <= 5 * 0.001 / tick.RAMP_S + 1e-9
    assert np.diff(sizes).min() >= 0
    assert max(map(abs, whole[:3])) > 0


@pytest.mark.parametrize(("seconds", "share"), [(0.1, 0.2), (0.25, 0.5), (0.49, 0.98), (0.5, 1.0), (1.0, 1.0)])
def test_force_fades_in_over_half_a_second(seconds: float, share: float):
    falcon, counts = Falcon(), counts_at(0, 0, 0)
    falcon.settle(counts, 0.002)
    falcon.tell(counts, after_s=seconds)
    applied = falcon.push(0, 0, 4)[1]
    assert applied == pytest.approx((0, 0, 4 * share), abs=1e-9)


def in_packet(falcon: Falcon) -> list[int]:
    """The next packet, if no other force is written."""
    return list(packet.decode(falcon.buffers.packet)[:3])


def test_packet_ready_after_fault_holds_no_force():
    """A loop that gets no position may send it once more."""
    here, there = counts_at(0, 0, 0), counts_at(0.02, 0, 0)
    for unknown in ("homing", "angles", "leaps"):
        falcon = Falcon()
        falcon.settle(here)
        falcon.push(0, 0, 5)
        assert any(in_packet(falcon))
        if unknown == "homing":
            falcon.tell(here, info=0x30)
        elif unknown == "angles":
            falcon.tell(np.array([1600, -2300, 1600]))
            falcon.tell(np.array([1600, -2300, 1600]))
        else:
            falcon.tell(there)
            assert any(in_packet(falcon)), "one leap is passed over"
            falcon.tell(counts_at(-0.02, 0, 0))
        assert not any(in_packet(falcon)), unknown
        assert tuple(falcon.held[tick.APPLIED : tick.APPLIED + 3]) == (0, 0, 0)


def test_buttons_are_read_and_leaps_wait_for_the_next_answer():
    falcon, counts = Falcon(), counts_at(0, 0, 0)
    falcon.settle(counts, 0.01)
    falcon.tell(counts, info=packet.HOMED | 0b0110)
    assert falcon.state[6] == 0b0110
    falcon, here, there = Falcon(), counts_at(0, 0, 0), counts_at(0.02, 0, 0)
    falcon.settle(here)
    assert [falcon.tell(each) for each in (there, here, there, there, there)] == [0, 1, 0, 1, 1]
    assert falcon.push(0, 0, 5)[1][2] < 0.1, "after a true leap the force fades in"


ARM = pytest.mark.parametrize("arm", [0, 1, 2])
SIGN = pytest.mark.parametrize("sign", [1, -1])


@ARM
@SIGN
@pytest.mark.parametrize(("after_s", "most"), [(0.001, 18), (0.0005, 10), (0.01, 24), (0.1, 24)])
def test_leap_limit_grows_with_time(arm: int, sign: int, after_s: float, most: int):
    """Of arms at rest: 8 counts, and 1e7 a second squared, up to 24."""
    for away, taken in ((most, 1), (most + 1, 0)):
        falcon, here = Falcon(), counts_at(0, 0, 0)
        falcon.settle(here, 0.05)
        there = here.copy()
        there[arm] += sign * away
        assert falcon.tell(there, after_s=after_s) == taken


@ARM
@SIGN
@pytest.mark.parametrize(("after_s", "most"), [(0.001, 50), (0.0001, 50), (0.002, 100), (0.01, 128), (1.0, 128)])
def test_leap_confirmation_limit_grows_with_time(arm: int, sign: int, after_s: float, most: int):
    for away, taken in ((most, 1), (most + 1, 0)):
        falcon, here = Falcon(), counts_at(0, 0, 0)
        falcon.settle(here, 0.05)
        leapt = counts_at(0.02, 0.01, 0.01)
        assert falcon.tell(leapt) == 0
        leapt[arm] += sign * away
        assert falcon.tell(leapt, after_s=after_s) == taken


def test_doubtful_answers_and_impossible_angles_give_no_force():
    falcon, here = Falcon(), counts_at(0, 0, 0)
    falcon.settle(here)

    def doubtful() -> int:
        packet.encode(*map(int, here), 0, falcon.buffers.answer)
        falcon.buffers.answer[packet.INFO] = packet.ZERO + packet.HOMED
        falcon.held[tick.NOW] += 0.001
        falcon.counts[FRESH] = DOUBTFUL
        return tick.read(*falcon.buffers, falcon.state)

    assert [doubtful(), doubtful(), falcon.tell(here)] == [0, 1, 1]
    assert falcon.push(0, 0, 5)[1][2] == 5, "where it goes on, no force is lost"
    falcon, counts = Falcon(), counts_at(0, 0, 0)
    falcon.settle(counts)
    impossible = np.array([1600, -2300, 1600])
    assert [falcon.tell(impossible) for _ in range(3)] == [0, 0, 0]
    assert falcon.push(0, 0, 5)[0][:3] == [0, 0, 0]
    assert falcon.counts[tick.REFUSED] >= 3


@pytest.mark.parametrize("arm", [1, 2, 3])
def test_rate_is_that_of_the_longest_straight_window(arm: int):
    """Counts of an arm, a millisecond each: at rest and then three a tick; and slow, so that they are rounded."""

    def rate(counts: list[int]) -> float:
        history = np.zeros((16, 4))
        history[: len(counts), 0] = np.arange(len(counts)) * 0.001
        history[: len(counts), arm] = counts
        estimates = rates(history, len(counts) - 1, len(counts))
        assert not np.delete(estimates, arm - 1).any()
        return estimates[arm - 1]

    assert rate([0, 0, 0, 0, 3, 6, 9, 12]) == pytest.approx(3000)
    assert rate([0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]) == pytest.approx(500, rel=0.1)
    assert rate([1, 0, 1, 0, 1, 0, 1]) == pytest.approx(0)
    assert rate([5]) == 0


@given(st.tuples(*[st.floats(-0.025, 0.025)] * 3), st.tuples(*[st.floats(allow_nan=True, allow_infinity=True)] * 3))
def test_force_never_reverses(place: tuple[float, float, float], force: tuple[float, float, float]):
    """For any force, the torques on the wire are those of a force along it, to half a count."""
    falcon = Falcon()
    falcon.settle(counts_at(*place), 0.6)
    *counts, _info = falcon.push(*force)[0]
    if not np.isfinite(force).all():
        assert counts == [0, 0, 0]
        return
    ideal = np.array(force) / max(*map(abs, force), 1e-300)
    rows = falcon.held[tick.SLOPES : tick.SLOPES + 9].reshape(3, 3)
    x, y, z = falcon.buffers.frame[:, :3].T @ ideal
    torques = -1e4 * np.array(kinematics.torques(tuple(map(tuple, rows.tolist())), (x, y, z)))
    size = np.dot(counts, torques) / np.dot(torques, torques) if ideal.any() else 0.0
    assert size >= 0
    assert np.abs(np.array(counts) - size * torques).max() <= 1.0
    assert max(map(abs, counts)) <= packet.MAX_COUNTS


def test_spec_force_is_possible_in_every_direction():
    rows = kinematics.jacobian(*kinematics.inverse(0.0, 0.0, kinematics.CENTRE_M), 0.0, 0.0, kinematics.CENTRE_M)
    assert np.linalg.norm(np.linalg.inv(rows), axis=0).max() == pytest.approx(LEVER_M, rel=1e-3)
    assert Calibration().spec().max_force_n == pytest.approx(6.09)
    for calibration, most_n in (
        (Calibration(counts_per_newton_metre=5000), 8.0),
        (Calibration(motor_gain=(0.5, 1.0, 2.0)), 3.04),
        (Calibration(motor_gain=(0.5, 0.5, 0.5)), 8.0),
    ):
        assert calibration.spec().max_force_n == pytest.approx(most_n)


def test_calibration_has_zero_and_gain_of_each_arm():
    offsets, gains = (34.0, 35.0, 36.5), (0.5, 1.0, 2.0)
    falcon = Falcon(Calibration(encoder_offset_deg=offsets, motor_gain=gains))
    place = (0.01, -0.02, 0.015)
    angles = np.array(kinematics.inverse(place[0], place[2], kinematics.CENTRE_M - place[1]))
    falcon.settle(np.round((angles - np.radians(offsets)) / kinematics.RAD_PER_COUNT).astype(int))
    assert falcon.state[:3] == pytest.approx(place, abs=6e-5)
    *counts, _info = falcon.push(1.0, 1.0, 1.0)[0]
    rows = kinematics.jacobian(*angles, place[0], place[2], kinematics.CENTRE_M - place[1])
    torques = np.array(kinematics.torques(rows, (1.0, 1.0, -1.0)))
    assert counts == pytest.approx(-1e4 * np.multiply(gains, torques), abs=3)
    with pytest.raises(ValueError, match="name an axis twice"):
        Calibration(axes=("x", "-x", "y"))

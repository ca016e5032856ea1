"""A Falcon's driver on a simulated one: no force may stay, and what is felt is what was sent."""

from array import array
from itertools import pairwise

import numpy as np
import pytest

from falcon_bus import held_bus, open_on
from tangible_core import HapticSurface, load_method
from tangible_core.data import NO_FORCE, Force
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.session import run_simulated
from tangible_devices.falcon.falcon_simulated import FalconSimulated
from tangible_devices.falcon.kernels.packet import GREEN, HOMING, RED
from tangible_devices.falcon.link import FalconLink
from tangible_devices.falcon.simulator.body import CENTRE_M, HOMED, REACH_M, Body
from tangible_devices.falcon.simulator.bus import Bus
from tangible_devices.falcon.usb.firmware import NULL

PUSH = Force(0.5, -0.25, 2.0)


def record_writes(bus: Bus, monkeypatch: pytest.MonkeyPatch) -> list[bytes]:
    """Record every write from now on."""
    sent: list[bytes] = []
    write = bus.bulk_write

    def keep(handle: object, ep: int, intf: int, data: array, timeout: int) -> int:
        sent.append(data.tobytes())
        return write(handle, ep, intf, data, timeout)  # pyright: ignore[reportArgumentType]

    monkeypatch.setattr(bus, "bulk_write", keep)
    return sent


class TestHoming:
    def test_homing_shows_red_light_and_times_out_without_a_hand(self, monkeypatch: pytest.MonkeyPatch):
        bus, clock = held_bus()
        with pytest.raises(DeviceError, match="0 of 3 arms are homed"):
            open_on(bus, clock, home_within_s=0.2)
        assert bus.units[0].claimed_by is None
        bus, clock = held_bus()
        sent = record_writes(bus, monkeypatch)
        open_on(bus, clock)
        packets = [each for each in sent if len(each) == 16 and each != NULL]
        assert {packet[1:13] for packet in packets} == {b"A" * 12}
        infos = [packet[13] - 0x41 for packet in packets]
        assert sorted(infos, reverse=True) == infos
        assert set(infos) == {HOMING | RED, HOMING | GREEN}


class TestForce:
    def test_force_reaches_the_motors(self):
        bus, clock = held_bus()
        with open_on(bus, clock) as link:
            link.read()
            link.write(PUSH)
            assert link.applied == pytest.approx(PUSH)
            body = bus.units[0].chip.processor.body
            from tangible_devices.falcon.kernels import kinematics

            x, y, z = body.tip[:3].tolist()
            rows = kinematics.jacobian(*kinematics.inverse(x, y, z), x, y, z)
            fx, fy, fz = kinematics.force(rows, tuple(-torque_count / 1e4 for torque_count in body.torque_counts))
            assert (fx, -fz, fy) == pytest.approx(PUSH, abs=0.05)

    def test_force_ends_with_null_packets(self, monkeypatch: pytest.MonkeyPatch):
        bus, clock = held_bus()
        with open_on(bus, clock) as link:
            link.write(PUSH)
            sent = record_writes(bus, monkeypatch)
        zero, *goodbyes = sent
        assert zero[1:13] == b"A" * 12
        assert goodbyes == [NULL] * 3
        assert bus.units[0].chip.processor.body.torque_counts == (0, 0, 0)

    @pytest.mark.parametrize("lost", [1, 2, 3])
    def test_force_ends_though_null_packets_are_lost(self, lost: int):
        """The first packets of the end, the zero force itself among them, never reach the motors."""
        bus, clock = held_bus()
        with open_on(bus, clock) as link:
            link.write(PUSH)
            write, writes = bus.bulk_write, iter(range(10))

            def lossy(handle: object, ep: int, intf: int, data: array, timeout: int) -> int:
                if next(writes) < lost:
                    return len(data)
                return write(handle, ep, intf, data, timeout)  # pyright: ignore[reportArgumentType]

            bus.bulk_write = lossy  # pyright: ignore[reportAttributeAccessIssue]
        assert bus.units[0].chip.processor.body.torque_counts == (0, 0, 0)

    def test_force_above_limit_is_scaled_down(self):
        bus, clock = held_bus()
        with open_on(bus, clock) as link:
            link.read()
            link.write(Force(0.0, 0.0, 100.0))
            assert np.linalg.norm(link.applied) == pytest.approx(6.09, abs=0.01)

    @pytest.mark.parametrize("ended", ["closed", "failed"])
    def test_closed_link_has_and_gives_no_force(self, ended: str):
        bus, clock = held_bus()
        link = open_on(bus, clock)
        link.write(PUSH)
        if ended == "closed":
            link.close()
        else:
            bus.units[0].chip._spoil = lambda sent, data: b""
            with pytest.raises(DeviceError, match="no longer answers"):
                for _ in range(1000):
                    link.exchange()
        assert tuple(link.applied) == NO_FORCE
        with pytest.raises(DeviceError, match="closed"):
            link.exchange()
        _, write, fixed = link.kernels()
        write(*fixed, *PUSH)
        assert tuple(link.applied) == NO_FORCE
        assert fixed[1][1:13].tobytes() == b"A" * 12


class TestRate:
    @pytest.mark.parametrize(
        ("in_flight", "event_character", "hertz"), [(1, False, 500), (2, False, 1000), (1, True, 1000)]
    )
    def test_rate_follows_packets_in_flight(self, in_flight: int, event_character: bool, hertz: float):
        bus, clock = held_bus()
        with open_on(bus, clock, in_flight=in_flight, event_character=event_character) as link:
            times = []
            for _ in range(300):
                link.write(NO_FORCE)
                times.append(link.read().time_s)
            assert 1 / np.median(np.diff(times)) == pytest.approx(hertz, rel=0.01)
            assert np.diff(times).min() > 0
            assert link.health().rate_hz == pytest.approx(hertz, rel=0.02)

    def test_silence_is_an_error_unless_answers_come_between(self):
        bus, clock = held_bus()
        with open_on(bus, clock) as link:
            chip = bus.units[0].chip
            spoil = chip._spoil
            for _ in range(3):
                lost = link.health().lost
                chip._spoil = lambda sent, data: b""
                while link.health().lost < lost + 4:
                    link.exchange()
                chip._spoil = spoil
                for _ in range(5):
                    link.exchange()
            assert link.read().time_s > 0
        bus, clock = held_bus()
        with pytest.raises(DeviceError, match="no longer answers"), open_on(bus, clock) as link:
            link.write(PUSH)
            bus.units[0].chip._spoil = lambda sent, data: b""
            silent_s = clock()
            for _ in range(100):
                link.exchange()
        assert 0.05 < clock() - silent_s < 0.3
        assert bus.units[0].chip.processor.body.torque_counts == (0, 0, 0)

    def test_read_without_position_fails_soon(self):
        bus, clock = held_bus()
        link = open_on(bus, clock)
        link.write(PUSH)
        body = bus.units[0].chip.processor.body
        body._hand.wants = lambda tip, homing, homed: tip[:3]  # pyright: ignore
        body._home_bits = 0
        lost_s = clock()
        with pytest.raises(DeviceError, match="lost its homing"):
            for _ in range(5):
                link.read()
        assert clock() - lost_s < 0.2
        assert body.torque_counts == (0, 0, 0)


class TestSeveral:
    def test_open_selects_by_serial_and_index_and_refuses_others(self):
        bus, clock = held_bus(("A1", "B2"))
        first = open_on(bus, clock)
        second = open_on(bus, clock, index=1)
        first.write(PUSH)
        assert bus.units[0].chip.processor.body.torque_counts != (0, 0, 0)
        assert bus.units[1].chip.processor.body.torque_counts == (0, 0, 0)
        second.close()
        with open_on(bus, clock, serial="B2"):
            assert bus.units[1].claimed_by is not None
        first.close()
        bus, clock = held_bus(("A1", "B2"))
        for options in ({"serial": "C3"}, {"index": 2}):
            with pytest.raises(DeviceError):
                open_on(bus, clock, **options)

    def test_open_twice_or_without_a_device_is_refused(self):
        bus, clock = held_bus()
        with open_on(bus, clock) as link:
            link.write(PUSH)
            with pytest.raises(DeviceError, match="another program is using it"):
                open_on(bus, clock)
            link.read()
            assert link.applied == pytest.approx(PUSH)
        bus, clock = held_bus(())
        with pytest.raises(DeviceAbsent, match="none is connected"):
            open_on(bus, clock)


def test_kernels_work_on_the_link_s_buffers():
    link = open_on(*held_bus())
    read, write, fixed = link.kernels()
    state = np.zeros(7)
    assert link.exchanges
    link.exchange()
    assert read(*fixed, state)
    assert not read(*fixed, state), "a position is read once"
    write(*fixed, *PUSH)
    link.exchange()
    assert link.applied == pytest.approx(PUSH)
    assert isinstance(link, FalconLink)


FLAT = HapticSurface.from_heights(np.full((8, 8), 0.002))


def test_simulated_falcon_feels_a_surface_and_injects_faults():
    recording = run_simulated(load_method("render", "penalty")().touch(FLAT), FalconSimulated(path="press"), 2.0)
    assert not recording.stopped
    assert 1.0 < recording.force_n[:, 2].max() < 6.0
    assert recording.position_m[:, 2].min() > -0.004, "the surface holds the hand up, whose path goes to -0.005"
    device = FalconSimulated.model_validate({"faults": [{"at": "read", "error": "unplugged", "after": 3000}]})
    recording = run_simulated(load_method("render", "penalty")().touch(FLAT), device, 10.0)
    assert "was unplugged" in recording.stopped
    with pytest.raises(DeviceError, match="TAG"):
        FalconSimulated.model_validate({"faults": [{"at": "claim", "error": "access-denied"}]}).open()


def test_simulated_falcon_in_real_time_follows_the_clock():
    with FalconSimulated(real_time=True).open() as link:
        states = [link.read() for _ in range(20)]
    assert all(after.time_s > before.time_s for before, after in pairwise(states))


class Holding:
    """A hand that holds the grip out or in."""

    buttons, out = 0, False

    def wants(self, tip: np.ndarray, seeking: bool, homed: bool) -> np.ndarray:
        return np.array([0.0, 0.0, CENTRE_M + (REACH_M if self.out else -REACH_M)])


def test_arms_are_homed_by_going_out_and_in_where_the_host_asks_for_it():
    hand = Holding()
    body = Body(hand, np.array([0.2, 1.0, 0.1, 1000.0, 20.0]))
    steps = [(0, True, 0), (0, False, 0), (1, False, 0), (1, True, 0), (1, False, sum(HOMED)), (0, False, 0)]
    for number, (info, hand.out, homed) in enumerate([*steps, *steps[3:5]]):
        body.obey((0, 0, 0), info, number)
        body.move_until(number + 1)
        assert body.report()[1] == homed, number
    body.let_go()
    assert body.report()[1] == 0

"""What the doctor finds of a Falcon, and what a calibration measures and changes."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from falcon_bus import held_bus, open_on
from tangible_core.data import NO_FORCE, Finding, Force, HapticState, Unit
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.mapping.device_calibrations import save_calibration
from tangible_core.plugins.interfaces import Link
from tangible_devices.falcon import kinematics, measuring
from tangible_devices.falcon.calibration import Calibration
from tangible_devices.falcon.falcon import Falcon
from tangible_devices.falcon.service import calibrated, findings, units
from tangible_devices.falcon.simulator.faults import Fault
from tangible_devices.falcon.simulator.firmware_image import synthetic_image


def examined(*faults: Fault, loaded: bool = True, **options: object) -> list[Finding]:
    bus, clock = held_bus()
    if loaded:
        open_on(bus, clock).close()
    bus.faults.extend(faults)
    falcon = Falcon(**options)
    found = list(findings(falcon.settings(), falcon.firmware, bus, clock))
    assert all(unit.claimed_by is None and unit.kernel_driver for unit in bus.units)
    return found


def failed(found: list[Finding]) -> list[Finding]:
    return [each for each in found if each.verdict == "failed"]


class TestDoctor:
    def test_all_is_well(self):
        found = examined()
        assert {each.verdict for each in found} == {"fine"}
        assert [each.check.rpartition(": ")[2] for each in found] == [
            *("libusb", "firmware file", "permission", "driver", "in use", "firmware", "rate"),
        ]
        assert "SIM0001" in found[2].says
        assert float(found[-1].says.split()[0]) == pytest.approx(1000, rel=0.1)

    def test_no_permission_gives_the_rule_to_copy(self):
        [found] = failed(examined(Fault(at="open", error="access-denied", after=1, times=99)))
        assert 'ATTR{idVendor}=="0403"' in found.cure
        assert "sudo udevadm control --reload-rules" in found.cure
        assert "\n" not in found.says

    def test_another_program_has_it(self):
        [found] = failed(examined(Fault(at="claim", error="busy", after=1, times=99)))
        assert "another program is using it" in found.cure

    def test_no_firmware_and_no_file(self):
        [found] = failed(examined(loaded=False))
        assert "no file is given" in found.says
        assert "nvent_firmware.bin" in found.cure

    def test_no_firmware_yet(self, tmp_path: Path):
        image = tmp_path / "image.bin"
        image.write_bytes(synthetic_image())
        found = examined(loaded=False, firmware=image)
        assert not failed(found)
        assert found[1].says.endswith("bytes, whole")
        assert "is sent when it is opened" in found[-1].says

    def test_a_file_that_is_no_firmware(self, tmp_path: Path):
        image = tmp_path / "image.bin"
        image.write_bytes(synthetic_image()[:-2])
        [found] = failed(examined(firmware=image))
        assert found.check == "firmware file"

    def test_a_slow_line_is_the_latency_timer(self, monkeypatch: pytest.MonkeyPatch):
        """A chip that leaves its timer at 16 ms."""
        from tangible_devices.falcon import port

        run_time = port.run_time

        def forgets(opened: port.Port, event_character: bool) -> None:
            run_time(opened, event_character)
            opened.request(port.LATENCY, 16)

        monkeypatch.setattr("tangible_devices.falcon.service.run_time", forgets)
        [found] = failed(examined())
        assert found.check.endswith("rate")
        assert float(found.says.split()[0]) < 200
        assert "latency timer" in found.cure

    def test_nothing_is_plugged_in(self):
        bus, clock = held_bus(())
        assert [each.verdict for each in findings(Falcon().settings(), None, bus, clock)] == [
            "fine",
            "fine",
            "not asked",
        ]

    def test_a_bus_that_fails(self):
        bus, clock = held_bus(faults=(Fault(at="look", error="access-denied"),))
        [found] = findings(Falcon().settings(), None, bus, clock)
        assert found.verdict == "failed"


class TestConnected:
    def test_each_is_told_by_its_serial_number(self):
        bus, _ = held_bus(("A1", "B2"))
        assert [unit.serial for unit in units(bus)] == ["A1", "B2"]
        assert units(bus)[0] == Unit("Novint Falcon", "A1", "USB bus 1, address 5")

    def test_one_that_may_not_be_opened_is_there_all_the_same(self):
        bus, _ = held_bus(("A1", "B2"), (Fault(at="open", error="access-denied"),))
        first, second = units(bus)
        assert "no permission" in first.problem and "doctor" in first.problem
        assert second.serial == "B2"


class Grip(Link):
    """A grip that is where the last question put it, in the device's own axes; laden, a mass on the spring."""

    def __init__(self, places: list[tuple[float, float, float]]) -> None:
        super().__init__("the grip", 8.0)
        self.places = iter(places)
        self.place = (0.0, 0.0, 0.0)
        self.weight_n = 0.0
        self.strength = 1.0
        self.held = NO_FORCE
        self.forces: list[float] = []
        self.rate = 0.0

    def ask(self, answers: dict[str, str] | None = None) -> Callable[[str], str]:
        def ask(text: str) -> str:
            if "Hang the weight" in text:
                self.weight_n = 2.0
            self.place = next(self.places, self.place)
            return next((answer for words, answer in (answers or {}).items() if words in text), "")

        return ask

    def _read(self) -> HapticState:
        up = self.strength * self.held.z - self.weight_n - 0.5  # and half a newton of its own
        self.rate = 0.9 * (self.rate + 0.001 * up / 0.2)
        x, y, z = self.place
        self.place = (x, y, z + 0.001 * self.rate) if self.held != NO_FORCE else self.place
        return HapticState(self.place, (0.0, 0.0, self.rate))

    def _send(self, force: Force) -> None:
        self.held = force
        self.forces.append(force.z)

    @property
    def applied(self) -> Force:
        return self.held

    def _release(self) -> None:
        pass


class TestMeasuring:
    def test_the_axes_are_those_of_the_moves(self):
        """Right is the device's x, away its -z, up its y: the published guess."""
        grip = Grip([(0, 0, 0), (0.03, 0.002, 0), (0.03, 0.002, -0.03), (0.03, 0.03, -0.03)])
        assert measuring.measure_axes(grip, grip.ask()) == Calibration().axes

    def test_another_device_s_axes(self):
        grip = Grip([(0, 0, 0), (0, -0.03, 0), (-0.02, -0.03, 0), (-0.02, -0.03, 0.04)])
        assert measuring.measure_axes(grip, grip.ask()) == ("-y", "-x", "z")

    @pytest.mark.parametrize(
        ("moves", "words"),
        [
            ([(0, 0, 0), (0.003, 0, 0)], "did not move to the right by 10 mm"),
            ([(0, 0, 0), (0.03, 0, 0), (0, 0, 0), (0, 0, 0.03)], "went along one axis"),
        ],
    )
    def test_moves_that_tell_nothing(self, moves: list[tuple[float, float, float]], words: str):
        grip = Grip(moves)
        with pytest.raises(DeviceError, match=words):
            measuring.measure_axes(grip, grip.ask())

    def test_arms_that_differ_at_the_symmetric_point_are_made_alike(self):
        """A device whose second arm stands 1.5 degrees farther than its offset says."""
        true = kinematics.inverse(0.0, 0.0, 0.08)
        read = [arm - math.radians(error) for arm, error in zip(true, (0.0, 1.5, 0.0), strict=True)]
        x, y, z, *_ = kinematics.forward(*read, 0.0, 0.0, 0.08)
        grip = Grip([(x, y, z - kinematics.CENTRE_M)])
        top, right, left = measuring.measure_offsets(grip, grip.ask(), (35.0, 35.0, 35.0))
        assert (right - top, right - left) == pytest.approx((1.5, 1.5), abs=1e-6)
        assert (top + right + left) / 3 == pytest.approx(35.0)

    @pytest.mark.parametrize("true", [0.5, 1.0, 1.25])
    def test_a_weight_tells_the_strength_of_the_motors(self, true: float):
        """Motors that give `true` times what is asked carry 2 N with 2 N / true more; its own weight drops out."""
        grip = Grip([])
        grip.strength = true
        counts = measuring.measure_strength(grip, grip.ask({"grams": str(2000 / 9.80665)}), 10_000.0)
        assert counts == pytest.approx(10_000 / true, rel=0.02)
        assert grip.held == NO_FORCE
        assert max(grip.forces) < 10

    def test_without_a_weight_no_motor_moves(self):
        grip = Grip([])
        assert measuring.measure_strength(grip, grip.ask(), 9000.0) == 9000.0
        assert not grip.forces

    @pytest.mark.parametrize("grams", ["heavy", "5", "nan", "10000"])
    def test_weights_that_are_none(self, grams: str):
        grip = Grip([])
        with pytest.raises(DeviceError, match="is not a weight"):
            measuring.measure_strength(grip, grip.ask({"grams": grams}), 9000.0)

    def test_a_strength_beyond_belief(self):
        with pytest.raises(DeviceError, match="calibrate again"):
            measuring.strength(0.5, 0.5, 2.0)


class TestKept:
    def test_what_was_kept_for_a_serial_number_is_used(self):
        kept = Calibration(axes=("x", "y", "z"), counts_per_newton_metre=12_000.0)
        save_calibration("falcon", "SIM0001", kept)
        bus, clock = held_bus(("SIM0002", "SIM0001"))
        for index, calibration in enumerate((Calibration(), kept)):
            with open_on(bus, clock, index=index) as link:
                assert np.array_equal(link._buffers.frame, calibration.frame())
                assert np.array_equal(link._buffers.arms, calibration.arms())

    def test_the_specification_is_that_of_the_serial_number(self):
        save_calibration("falcon", "A1", Calibration(counts_per_newton_metre=20_000.0))
        assert Falcon(serial="A1").spec().max_force_n < Falcon(serial="B2").spec().max_force_n

    def test_the_option_comes_first(self):
        save_calibration("falcon", "A1", Calibration(counts_per_newton_metre=20_000.0))
        own = Calibration()
        assert Falcon(serial="A1", calibration=own).settings().calibrated("A1") == own

    def test_a_damaged_one_stops_the_opening_and_leaves_the_device_alone(self):
        save_calibration("falcon", "SIM0001", Calibration()).write_text("{")
        bus, clock = held_bus()
        with pytest.raises(DeviceError, match="run `tangible devices calibrate falcon` again"):
            open_on(bus, clock)
        assert bus.units[0].claimed_by is None

    def test_calibrating_needs_a_device(self):
        bus, clock = held_bus(())
        with pytest.raises(DeviceAbsent, match="plug in"):
            calibrated(Falcon().settings(), None, input, bus, clock)

    def test_a_hand_that_does_not_move_the_grip_calibrates_nothing(self, tmp_path: Path):
        image = tmp_path / "image.bin"
        image.write_bytes(synthetic_image())
        bus, clock = held_bus()
        with pytest.raises(DeviceError, match=r"did not move|went along one axis"):
            calibrated(Falcon().settings(), Falcon(firmware=image).image(), lambda _: "", bus, clock)
        assert bus.units[0].claimed_by is None

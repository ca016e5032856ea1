"""The doctor would send a user after the wrong fault of a Falcon, or a calibration would be measured wrongly."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from falcon_bus import held_bus, open_on
from tangible_core.data import NO_FORCE, Finding, Force, HapticState, Unit
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.plugins.interfaces import Link
from tangible_devices.device_calibrations import save_calibration
from tangible_devices.falcon import service
from tangible_devices.falcon.calibration import Calibration
from tangible_devices.falcon.falcon import Falcon
from tangible_devices.falcon.kernels import kinematics
from tangible_devices.falcon.service import calibrate, findings, units
from tangible_devices.falcon.simulator.faults import Fault


def examine(*faults: Fault, loaded: bool = True, **options: object) -> list[Finding]:
    bus, clock = held_bus()
    if loaded:
        open_on(bus, clock).close()
    bus.faults.extend(faults)
    falcon = Falcon(**options)
    listed = list(findings(falcon.settings(), falcon.firmware, bus, clock))
    assert all(unit.claimed_by is None and unit.kernel_driver for unit in bus.units)
    return listed


def failures(listed: list[Finding]) -> list[Finding]:
    return [each for each in listed if each.verdict == "failed"]


class TestDoctor:
    def test_doctor_of_working_falcon_finds_all_fine(self):
        listed = examine()
        assert {each.verdict for each in listed} == {"fine"}
        assert [each.check.rpartition(": ")[2] for each in listed] == [
            *("libusb", "firmware file", "permission", "driver", "in use", "firmware", "rate")
        ]
        assert "SIM0001" in listed[2].says
        assert float(listed[-1].says.split()[0]) == pytest.approx(1000, rel=0.1)
        [finding] = failures(examine(Fault(at="open", error="access-denied", after=1, times=99)))
        assert 'ATTR{idVendor}=="0403"' in finding.cure
        assert "sudo udevadm control --reload-rules" in finding.cure
        assert "\n" not in finding.says
        [finding] = failures(examine(loaded=False))
        assert "no file is given" in finding.says
        assert "nvent_firmware.bin" in finding.cure

    def test_doctor_of_slow_line_names_latency_timer(self, monkeypatch: pytest.MonkeyPatch):
        """A chip that leaves its timer at 16 ms."""
        from tangible_devices.falcon.usb import port

        run_time = port.run_time

        def forgets(opened: port.Port, event_character: bool) -> None:
            run_time(opened, event_character)
            opened.request(port.LATENCY, 16)

        monkeypatch.setattr("tangible_devices.falcon.service.run_time", forgets)
        [finding] = failures(examine())
        assert finding.check.endswith("rate")
        assert float(finding.says.split()[0]) < 200
        assert "latency timer" in finding.cure

    def test_doctor_without_device_has_not_asked(self):
        bus, clock = held_bus(())
        assert [finding.verdict for finding in findings(Falcon().settings(), None, bus, clock)] == [
            "fine",
            "not asked",
            "not asked",
        ]


class TestConnected:
    def test_units_have_their_serial_numbers(self):
        bus, _ = held_bus(("A1", "B2"))
        assert [unit.serial for unit in units(bus)] == ["A1", "B2"]
        assert units(bus)[0] == Unit("Novint Falcon", "A1", "USB bus 1, address 5")


class Grip(Link):
    """A grip that each question moves to the next place, in the device's axes; with a load, a mass on the spring."""

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
    def test_measured_axes_are_those_of_the_moves(self):
        """Right is the first device's x, away its -z, up its y: the published guess."""
        for moves, axes in (
            ([(0, 0, 0), (0.03, 0.002, 0), (0.03, 0.002, -0.03), (0.03, 0.03, -0.03)], Calibration().axes),
            ([(0, 0, 0), (0, -0.03, 0), (-0.02, -0.03, 0), (-0.02, -0.03, 0.04)], ("-y", "-x", "z")),
        ):
            grip = Grip(moves)
            assert service.measure_axes(grip, grip.ask()) == axes
        for moves, words in (
            ([(0, 0, 0), (0.003, 0, 0)], "did not move"),
            ([(0, 0, 0), (0.03, 0, 0), (0, 0, 0), (0, 0, 0.03)], "went along one axis"),
        ):
            grip = Grip(moves)
            with pytest.raises(DeviceError, match=words):
                service.measure_axes(grip, grip.ask())

    def test_measured_offsets_make_arms_equal_on_the_axis(self):
        """A device whose second arm stands 1.5 degrees farther than its offset says."""
        true = kinematics.inverse(0.0, 0.0, 0.08)
        read = [arm - math.radians(error) for arm, error in zip(true, (0.0, 1.5, 0.0), strict=True)]
        x, y, z, *_ = kinematics.forward(*read, 0.0, 0.0, 0.08)
        grip = Grip([(x, y, z - kinematics.CENTRE_M)])
        top, right, left = service.measure_offsets(grip, grip.ask(), (35.0, 35.0, 35.0))
        assert (right - top, right - left) == pytest.approx((1.5, 1.5), abs=1e-6)
        assert (top + right + left) / 3 == pytest.approx(35.0)

    @pytest.mark.parametrize("true", [0.5, 1.0, 1.25])
    def test_measured_strength_follows_from_a_weight(self, true: float):
        """Motors that give `true` times the commanded force carry 2 N with 2 N / true more; their own load cancels."""
        grip = Grip([])
        grip.strength = true
        counts = service.measure_strength(grip, grip.ask({"grams": str(2000 / 9.80665)}), 10_000.0)
        assert counts == pytest.approx(10_000 / true, rel=0.02)
        assert grip.held == NO_FORCE
        assert max(grip.forces) < 10

    def test_measured_strength_without_weight_is_unchanged(self):
        grip = Grip([])
        assert service.measure_strength(grip, grip.ask(), 9000.0) == 9000.0
        assert not grip.forces

    @pytest.mark.parametrize("grams", ["heavy", "5", "nan", "10000"])
    def test_measured_strength_of_invalid_weight_is_refused(self, grams: str):
        grip = Grip([])
        with pytest.raises(DeviceError, match="is not a weight"):
            service.measure_strength(grip, grip.ask({"grams": grams}), 9000.0)


class TestKept:
    def test_saved_calibration_is_used_for_its_serial_number(self):
        saved = Calibration(axes=("x", "y", "z"), counts_per_newton_metre=12_000.0)
        save_calibration("falcon", "SIM0001", saved)
        bus, clock = held_bus(("SIM0002", "SIM0001"))
        for index, calibration in enumerate((Calibration(), saved)):
            with open_on(bus, clock, index=index) as link:
                assert np.array_equal(link._buffers.frame, calibration.frame())
                assert np.array_equal(link._buffers.arms, calibration.arms())
        save_calibration("falcon", "A1", Calibration(counts_per_newton_metre=20_000.0))
        assert Falcon(serial="A1").spec().max_force_n < Falcon(serial="B2").spec().max_force_n

    def test_calibration_that_is_damaged_or_of_no_device_is_refused(self):
        save_calibration("falcon", "SIM0001", Calibration()).write_text("{")
        bus, clock = held_bus()
        with pytest.raises(DeviceError, match="calibrate falcon"):
            open_on(bus, clock)
        assert bus.units[0].claimed_by is None
        bus, clock = held_bus(())
        with pytest.raises(DeviceAbsent, match="plug in"):
            calibrate(Falcon().settings(), None, input, bus, clock)

"""`tangible devices` would call a broken device fine, lose a calibration or end with a wrong exit code."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
import typer

from command_line import tangible
from tangible_core.errors import ConfigError
from tangible_core.plugins.registry import Registry
from tangible_devices.commands import devices as command
from tangible_devices.device_calibrations import calibration_path
from tangible_devices.installed import installed_devices, stress_device
from tangible_devices.mock import Mock

ALONE = SimpleNamespace(invoked_subcommand=None)
"""A context without a subcommand."""
ARM = '''
from typing import Literal

from pydantic import BaseModel

from tangible_core.data import DeviceSpec, Finding, Unit
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.plugins.interfaces import Adjustable, HapticDevice, Serviceable


class Offsets(BaseModel):
    offset_deg: float = 35.0


class Arm(HapticDevice, Serviceable, Adjustable):
    """An arm for tests."""

    state: Literal["right", "wrong", "gone", "broken"] = "right"
    """The state of the arm."""

    def spec(self):
        return DeviceSpec(8.0, 3000.0, 20.0, (0.1, 0.1, 0.1), 1e-5)

    def open(self):
        raise DeviceAbsent("no arm; plug it in")

    def connected(self):
        if self.state == "broken":
            raise DeviceError("the bus [usb] fails; plug it in again")
        return () if self.state == "gone" else (Unit("Arm", "A1", "bus 1"), Unit("Arm", "A2", "bus 2", "is [busy]"))

    def examine(self):
        if self.state == "gone":
            yield Finding("unit", "not asked", "none is plugged in")
            return
        yield Finding("library", "fine", "is there")
        if self.state == "wrong":
            yield Finding("permission", "failed", "there is none", 'SUBSYSTEM=="usb", MODE="0660" [copy this]')

    def home(self, say):
        say("pull the grip out")

    def calibrate(self, ask):
        return "A1", Offsets(offset_deg=float(ask("the angle?")))
'''


@pytest.fixture
def registry(install, monkeypatch: pytest.MonkeyPatch) -> Registry:
    install("arms", {"tangible.device": {"arm": "arm_module:Arm", "lost": "no_module:Lost"}}, arm_module=ARM)
    registry = Registry()
    monkeypatch.setattr("tangible_core.plugins.registry.default_registry", lambda: registry)
    return registry


def answer(monkeypatch: pytest.MonkeyPatch, *texts: str) -> None:
    answers = iter(texts)

    def read(prompt: str) -> str:
        try:
            return next(answers)
        except StopIteration:
            raise EOFError from None

    monkeypatch.setattr("builtins.input", read)


class TestList:
    def test_list_as_json_has_all_installed_devices(self, registry: Registry, capsys: pytest.CaptureFixture[str]):
        command.devices(ALONE, as_json=True)
        arm, lost = json.loads(capsys.readouterr().out)
        assert (arm["name"], arm["origin"], arm["simulated"], arm["problem"]) == ("arm", "arms 1.0", False, "")
        assert arm["units"][0] == {"name": "Arm", "serial": "A1", "place": "bus 1", "problem": ""}
        assert lost["units"] == [] and "cannot be loaded" in lost["problem"]

    def test_list_for_a_program_opens_no_device(self, registry: Registry):
        arm, lost = installed_devices(registry)
        assert (arm.name, arm.usable, [unit.problem for unit in arm.units]) == ("arm", True, ["", "is [busy]"])
        assert (lost.usable, lost.simulated, lost.units) == (False, None, ())
        assert not replace(arm, units=arm.units[1:]).usable
        assert replace(arm, units=(), simulated=True).usable


class TestDoctor:
    def test_doctor_as_json_has_check_and_verdict(self, registry: Registry, capsys: pytest.CaptureFixture[str]):
        with pytest.raises(typer.Exit):
            command.doctor("arm", ["state=wrong"], as_json=True)
        [_, permission] = json.loads(capsys.readouterr().out)["arm"]
        assert (permission["check"], permission["verdict"]) == ("permission", "failed")

    def test_doctor_without_a_name_examines_all_devices(self, registry: Registry, capsys: pytest.CaptureFixture[str]):
        with pytest.raises(typer.Exit):
            command.doctor(as_json=True)
        results = json.loads(capsys.readouterr().out)
        assert (list(results), results["lost"][0]["verdict"]) == (["arm", "lost"], "failed")


class TestSettingUp:
    def test_calibrate_saves_by_serial_number(
        self, registry: Registry, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
    ):
        answer(monkeypatch, " 34.5 ")
        command.calibrate("arm", [])
        path = calibration_path("arm", "A1")
        assert json.loads(path.read_text()) == {"offset_deg": 34.5}
        assert capsys.readouterr().out.splitlines()[-1] == f"saved in {path}"

    def test_calibrate_without_an_answer_saves_nothing(self, registry: Registry, monkeypatch: pytest.MonkeyPatch):
        answer(monkeypatch)
        with pytest.raises(ConfigError, match="nothing was saved"):
            command.calibrate("arm", [])
        assert not calibration_path("arm", "A1").exists()


class TestStress:
    def test_stress_returns_rate_and_percentiles(self):
        figures = stress_device(Mock(), 0.05)
        assert figures["cycles"] > 100
        assert figures["rate_hz"] * 0.05 == pytest.approx(figures["cycles"], rel=0.5)
        assert 0 < figures["p50_us"] <= figures["p99_us"] <= figures["p99_9_us"] <= figures["max_us"]


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["devices"], 0, "mock"),
        (["devices", "--json"], 0, '"simulated": true'),
        (["devices", "doctor", "mock"], 0, "needs nothing"),
        (["devices", "doctor", "haply", "--set", "uri=ws://127.0.0.1:9"], 1, "not asked"),
        (["devices", "doctor", "moc"], 2, "did you mean 'mock'?"),
        (["devices", "stress", "mock", "--seconds", "0.05", "--json"], 0, '"p99_9_us"'),
        (["devices", "stress", "mock", "--set", "pth=circle"], 2, "--set pth=circle: unknown option"),
        (["devices", "stress", "haply", "--set", "uri=ws://127.0.0.1:9"], 2, "start Haply Hub"),
        (["devices", "home", "mock"], 2, "nothing to home"),
        (["devices", "--json", "doctor"], 2, "write --json after 'doctor'"),
    ],
)
def test_devices_command_has_the_expected_exit_code(words: list[str], code: int, message: str):
    ran = tangible(*words, cwd=Path())
    assert message in ran.stdout + ran.stderr
    assert ran.returncode == code

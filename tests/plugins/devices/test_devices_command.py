"""`tangible devices` would call a broken device fine, or use or lose another one's calibration."""

import json
import os
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
import typer
from pydantic import BaseModel

from command_line import tangible
from tangible_core.errors import ConfigError, DeviceError, OutputError
from tangible_core.plugins.registry import Registry
from tangible_devices.commands import devices as command
from tangible_devices.device_calibrations import calibration_path, load_calibration, save_calibration
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
    monkeypatch.setattr("tangible_devices.commands.devices.default_registry", lambda: registry)
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
    def test_list_opens_no_device_and_has_all_installed(self, registry: Registry, capsys: pytest.CaptureFixture[str]):
        command.devices(ALONE, as_json=True)
        arm, lost = json.loads(capsys.readouterr().out)
        assert (arm["name"], arm["origin"], arm["simulated"], arm["problem"]) == ("arm", "arms 1.0", False, "")
        assert arm["units"][0] == {"name": "Arm", "serial": "A1", "place": "bus 1", "problem": ""}
        assert lost["units"] == [] and "cannot be loaded" in lost["problem"]
        arm, lost = installed_devices(registry)
        assert (arm.name, arm.usable, [unit.problem for unit in arm.units]) == ("arm", True, ["", "is [busy]"])
        assert (lost.usable, lost.simulated, lost.units) == (False, None, ())
        assert not replace(arm, units=arm.units[1:]).usable
        assert replace(arm, units=(), simulated=True).usable


class TestDoctor:
    def test_doctor_as_json_has_check_and_verdict_of_all(self, registry: Registry, capsys: pytest.CaptureFixture[str]):
        with pytest.raises(typer.Exit):
            command.doctor("arm", ["state=wrong"], as_json=True)
        [_, permission] = json.loads(capsys.readouterr().out)["arm"]
        assert (permission["check"], permission["verdict"]) == ("permission", "failed")
        with pytest.raises(typer.Exit):
            command.doctor(as_json=True)
        results = json.loads(capsys.readouterr().out)
        assert (list(results), results["lost"][0]["verdict"]) == (["arm", "lost"], "failed")


class TestSettingUp:
    def test_calibrate_saves_by_serial_number_what_is_answered(
        self, registry: Registry, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
    ):
        path = calibration_path("arm", "A1")
        answer(monkeypatch)
        with pytest.raises(ConfigError, match="nothing was saved"):
            command.calibrate("arm", [])
        assert not path.exists()
        answer(monkeypatch, " 34.5 ")
        command.calibrate("arm", [])
        assert json.loads(path.read_text()) == {"offset_deg": 34.5}
        assert capsys.readouterr().out.splitlines()[-1] == f"saved in {path}"


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


class Measured(BaseModel):
    offset_deg: tuple[float, float, float] = (35.0, 35.0, 35.0)
    gain: float = 1.0


def test_saved_calibration_is_loaded_again(config_dir: Path):
    values = Measured(offset_deg=(34.5, 35.0, 35.25), gain=0.1)
    path = save_calibration("arm", "F123", values)
    assert path == config_dir / "devices" / "arm-F123.json"
    assert load_calibration("arm", "F123", Measured) == values
    assert load_calibration("arm", "F124", Measured) is None
    assert load_calibration("leg", "F123", Measured) is None
    assert [each.name for each in path.parent.iterdir()] == ["arm-F123.json"]


@pytest.mark.parametrize("serial", ["", "a/b", "../../x", "ä ö", "C:\\x", "."])
def test_every_serial_number_has_its_own_file(config_dir: Path, serial: str):
    assert calibration_path("arm", serial).parent == config_dir / "devices"
    assert len({calibration_path("arm", each) for each in (serial, "F123", serial + "_")}) == 3
    save_calibration("arm", serial, Measured())
    assert load_calibration("arm", serial, Measured) == Measured()


@pytest.mark.parametrize(
    ("text", "place"), [('{"gain": "x"}', "gain"), ('{"offset_deg": [1, 2]}', r"offset_deg\.2"), ("", "the file")]
)
def test_damaged_calibration_is_named_and_not_ignored(text: str, place: str):
    path = save_calibration("arm", "F123", Measured())
    path.write_text(text)
    with pytest.raises(DeviceError, match=rf"arm-F123.json: {place}: "):
        load_calibration("arm", "F123", Measured)


@pytest.mark.timeout(20)
def test_calibration_at_a_pipe_or_device_is_refused_at_once():
    path = calibration_path("arm", "F123")
    path.parent.mkdir(parents=True)
    os.mkfifo(path)
    calibration_path("arm", "F124").symlink_to("/dev/zero")
    for serial in ("F123", "F124"):
        with pytest.raises(DeviceError, match="cannot be read"):
            load_calibration("arm", serial, Measured)


def test_calibration_that_cannot_be_written_raises(config_dir: Path):
    (config_dir / "devices").write_text("a file where the folder should be")
    with pytest.raises(OutputError):
        save_calibration("arm", "F123", Measured())

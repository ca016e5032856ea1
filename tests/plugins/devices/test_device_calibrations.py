"""A device would be used with another one's calibration, or a damaged one would be passed over."""

import os
from pathlib import Path

import pytest
from pydantic import BaseModel

from tangible_core.errors import DeviceError, OutputError
from tangible_devices.device_calibrations import calibration_path, load_calibration, save_calibration


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

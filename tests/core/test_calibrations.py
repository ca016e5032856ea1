"""What is kept of one unit: where, whole, and never half understood."""

from pathlib import Path

import pytest
from pydantic import BaseModel

from tangible_core.calibrations import calibration_path, load_calibration, save_calibration
from tangible_core.errors import DeviceError, OutputError


class Measured(BaseModel):
    offset_deg: tuple[float, float, float] = (35.0, 35.0, 35.0)
    gain: float = 1.0


def test_what_is_saved_is_read_again(config_dir: Path):
    values = Measured(offset_deg=(34.5, 35.0, 35.25), gain=0.1)
    path = save_calibration("arm", "F123", values)
    assert path == config_dir / "devices" / "arm-F123.json"
    assert load_calibration("arm", "F123", Measured) == values
    assert load_calibration("arm", "F124", Measured) is None
    assert load_calibration("leg", "F123", Measured) is None
    assert [each.name for each in path.parent.iterdir()] == ["arm-F123.json"]


@pytest.mark.parametrize("serial", ["", "a/b", "../../x", "ä ö", "C:\\x", "."])
def test_every_serial_is_a_file_of_its_own_in_the_folder(config_dir: Path, serial: str):
    assert calibration_path("arm", serial).parent == config_dir / "devices"
    assert len({calibration_path("arm", each) for each in (serial, "F123", serial + "_")}) == 3
    save_calibration("arm", serial, Measured())
    assert load_calibration("arm", serial, Measured) == Measured()


@pytest.mark.parametrize(
    ("text", "place"),
    [('{"gain": "x"}', "gain"), ('{"offset_deg": [1, 2]}', r"offset_deg\.2"), ("{", "the file"), ("", "the file")],
)
def test_a_damaged_one_is_named_and_not_passed_over(text: str, place: str):
    path = save_calibration("arm", "F123", Measured())
    path.write_text(text)
    with pytest.raises(DeviceError, match=rf"arm-F123.json: {place}: .*run `tangible devices calibrate arm` again"):
        load_calibration("arm", "F123", Measured)


def test_one_that_cannot_be_read(config_dir: Path):
    calibration_path("arm", "F123").mkdir(parents=True)
    with pytest.raises(DeviceError, match="cannot be read"):
        load_calibration("arm", "F123", Measured)


def test_a_place_that_cannot_be_written(config_dir: Path):
    (config_dir / "devices").write_text("a file where the folder should be")
    with pytest.raises(OutputError):
        save_calibration("arm", "F123", Measured())

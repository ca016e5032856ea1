"""Calibrations of single devices, stored in the user's configuration folder by serial number."""

import os
from pathlib import Path
from typing import TypeVar
from urllib.parse import quote

from pydantic import BaseModel, ValidationError

from tangible_core.errors import DeviceError
from tangible_core.files import MAX_TEXT_BYTES, as_path, read_bytes, write_text

M = TypeVar("M", bound=BaseModel)


def calibration_path(device: str, serial: str) -> Path:
    """Return the path of a unit's calibration; units of a kind without serial numbers share one."""
    if variable := os.environ.get("TANGIBLE_CONFIG_DIR"):
        folder = as_path(variable, "TANGIBLE_CONFIG_DIR")
    else:
        from platformdirs import user_config_path

        folder = user_config_path("tangible-images")
    return folder / "devices" / f"{device}-{quote(serial, safe='') or 'any'}.json"


def any_calibration(device: str) -> bool:
    """Tell whether any calibration was saved for this kind of device; if not, its serial number is not needed."""
    return any(calibration_path(device, "").parent.glob(f"{device}-*.json"))


def save_calibration(device: str, serial: str, values: BaseModel) -> Path:
    """Save a unit's calibration in place of the previous one; return its path. Raises: OutputError."""
    path = calibration_path(device, serial)
    write_text(path, values.model_dump_json(indent=2) + "\n")
    return path


def load_calibration(device: str, serial: str, model: type[M]) -> M | None:
    """Load a unit's calibration, None if none was saved; a wrong one is never ignored. Raises: DeviceError."""
    path = calibration_path(device, serial)
    try:
        return model.model_validate_json(read_bytes(path, MAX_TEXT_BYTES))
    except FileNotFoundError:
        return None
    except OSError as error:
        raise DeviceError(f"{path}: cannot be read: {error.strerror}; make it readable, or remove it") from error
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "the file"
        raise DeviceError(
            f"{path}: {place}: {first['msg']}; run `tangible devices calibrate {device}` again, or remove the file"
        ) from error

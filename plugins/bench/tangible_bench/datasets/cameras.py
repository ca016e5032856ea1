"""Cameras and disparity ranges, from the text files next to the pictures of a set."""

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

from tangible_core.data import Calibration
from tangible_core.errors import GeometryError, PictureError, shown
from tangible_core.files import MAX_TEXT_BYTES, read_bytes


class Cameras(NamedTuple):
    """The calibration of a pair and its disparity range, as far as they are known."""

    calibration: Calibration | None = None
    most_px: float | None = None  # the largest disparity that methods are given, in pixels of the pictures


ReadCameras = Callable[[], Cameras]


def if_there(read: Callable[..., Cameras], path: Path, *more: object) -> Cameras:
    """Read a file, or return unknown cameras if it is missing: a set is of use without its cameras."""
    return read(path, *more) if path.exists() else Cameras()


def middlebury_cameras(path: Path) -> Cameras:
    """Read `calib.txt` (cam0, doffs in px, baseline in mm). Raises: PictureError, as the other readers here."""
    values = _values(path, r"^\s*(\w+)\s*=\s*(.*?)\s*$")
    focal_px = _numbers(path, values, "cam0")[0]
    baseline_m, offset_px = (_numbers(path, values, name)[0] for name in ("baseline", "doffs"))
    most_px = _numbers(path, values, "ndisp")[0] if "ndisp" in values else None
    return Cameras(_calibration(path, focal_px, baseline_m / 1000, offset_px), most_px)


def kitti_cameras(path: Path, left: str, right: str) -> Cameras:
    """Read the projections of two cameras, `P2: 12 numbers`: f 0 cx -f X; the baseline is the difference of X, m."""
    values = _values(path, r"^\s*(\w+)\s*:\s*(.*?)\s*$")
    (one, other) = (_numbers(path, values, name, 12) for name in (left, right))
    baseline_m = (one[3] - other[3]) / one[0] if one[0] else 0.0
    return Cameras(_calibration(path, one[0], baseline_m, other[2] - one[2]))


OLD_FOCAL_PX, OLD_BASELINE_M = 3740.0, 0.16
"""Focal length and baseline of view1 and view5 in Middlebury 2005 and 2006 at full size, from their pages."""


def old_middlebury_cameras(path: Path, full_px: float) -> Cameras:
    """Read `dmin.txt`: the offset that is added to disparities at full size before they become depth."""
    number = re.search(r"[-+.\d]+", _text(path))
    offset_px = _number(path, number[0] if number else "", "dmin")
    return Cameras(_calibration(path, OLD_FOCAL_PX / full_px, OLD_BASELINE_M, offset_px / full_px))


def _values(path: Path, line: str) -> Mapping[str, str]:
    return dict(re.findall(line, _text(path), re.MULTILINE))


def _text(path: Path) -> str:
    try:
        return read_bytes(path, MAX_TEXT_BYTES).decode()
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or "it is not a text file"
        raise PictureError(f"{path}: cannot be read as a calibration: {why}; unpack it again") from error


def _numbers(path: Path, values: Mapping[str, str], name: str, least: int = 1) -> list[float]:
    words = re.split(r"[\s;,]+", values.get(name, "").strip("[] "))
    if len(words) < least:
        raise _bad_calibration(path, f"{name} has {len(words)} numbers, not {least}")
    return [_number(path, word, name) for word in words]


def _number(path: Path, word: str, name: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise _bad_calibration(path, f"{name} is {shown(word) or 'missing'}") from None


def _calibration(path: Path, focal_px: float, baseline_m: float, offset_px: float) -> Calibration:
    try:
        return Calibration(focal_px, baseline_m, offset_px)
    except GeometryError as error:
        raise _bad_calibration(path, str(error)) from error


def _bad_calibration(path: Path, why: str) -> PictureError:
    return PictureError(f"{path}: is not a calibration of a pair: {why}; unpack it again")

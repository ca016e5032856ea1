"""Result files in the formats of benchmark servers: a folder for each method, to be packed and uploaded."""

import re
from collections.abc import Callable, Mapping
from io import BytesIO
from pathlib import Path

import numpy as np
from jaxtyping import Float32

from tangible_core.errors import ConfigError
from tangible_core.files import atomic_write, write_text

from .standard_pair import StandardPair

Disparity = Float32[np.ndarray, "h w"]


def write_submission(
    folder: Path, name: str, method: str, pair: StandardPair, disparity_px: Disparity, seconds: float
) -> tuple[Path, ...]:
    """Write the files of a pair, and return them; disparity is NaN where unknown. Raises: ConfigError, OutputError."""
    if name not in WRITERS:
        raise ConfigError(f"{name} takes no submissions; sets that do are {', '.join(WRITERS)}")
    label = _plain_name(method)
    return WRITERS[name](folder / label, label, pair, disparity_px, seconds)


def write_pfm(path: Path, values: Disparity) -> None:
    """Write a portable float map: from the bottom up, little-endian, infinite where unknown. Raises: OutputError."""
    with_infinity = np.where(np.isfinite(values), values, np.float32(np.inf))
    with atomic_write(path) as file:
        file.write(
            f"Pf\n{values.shape[1]} {values.shape[0]}\n-1.0\n".encode() + with_infinity[::-1].astype("<f4").tobytes()
        )


def write_png16(path: Path, values: Disparity) -> None:
    """Write KITTI's format: 256 a pixel in 16 bits, 0 if unknown; known values are clipped to 1 to 65535."""
    from PIL import Image

    valid_mask = np.isfinite(values)
    levels = np.clip(np.rint(256 * np.where(valid_mask, values, 0)), 1, 65535) * valid_mask
    png = BytesIO()
    Image.fromarray(levels.astype(np.uint16)).save(png, format="PNG")
    with atomic_write(path) as file:
        file.write(png.getvalue())


def _middlebury(
    folder: Path, label: str, pair: StandardPair, disparity_px: Disparity, seconds: float
) -> tuple[Path, ...]:
    """Write the files of Middlebury's SDK: trainingQ/NAME/disp0METHOD.pfm and timeMETHOD.txt, in seconds."""
    home = folder / f"{'test' if pair.test else 'training'}{pair.resolution or 'F'}" / pair.name
    disparity, time = home / f"disp0{label}.pfm", home / f"time{label}.txt"
    write_pfm(disparity, disparity_px)
    write_text(time, f"{seconds:.6g}\n")
    return disparity, time


def _kitti_2012(
    folder: Path, label: str, pair: StandardPair, disparity_px: Disparity, seconds: float
) -> tuple[Path, ...]:
    write_png16(folder / f"{pair.name}.png", disparity_px)
    return (folder / f"{pair.name}.png",)


def _eth3d(folder: Path, label: str, pair: StandardPair, disparity_px: Disparity, seconds: float) -> tuple[Path, ...]:
    disparity, time = (folder / "low_res_two_view" / f"{pair.name}.{end}" for end in ("pfm", "txt"))
    write_pfm(disparity, disparity_px)
    write_text(time, f"runtime {seconds:.6g}\n")
    return disparity, time


def _plain_name(method: str) -> str:
    """Return a name of letters, digits, - and _, which servers accept.

    >>> _plain_name("zncc window_px=5")
    'zncc-window_px-5'
    """
    return re.sub(r"[^A-Za-z0-9_-]+", "-", method).strip("-") or "method"


Writer = Callable[[Path, str, StandardPair, Disparity, float], tuple[Path, ...]]
WRITERS: Mapping[str, Writer] = {
    **dict.fromkeys(("middlebury-eval3", "middlebury-2014", "middlebury-2021"), _middlebury),
    "kitti-2012": _kitti_2012,
    "kitti-2015": lambda folder, *more: _kitti_2012(folder / "disp_0", *more),
    "eth3d": _eth3d,
}

"""Results as the servers of benchmarks take them: a folder a method, to be packed and sent in."""

import re
from collections.abc import Callable, Mapping
from io import BytesIO
from pathlib import Path

import numpy as np
from jaxtyping import Float32

from tangible_core.errors import ConfigError
from tangible_core.files.writing import atomic_write, write_text

from .standard_pair import StandardPair

Disparity = Float32[np.ndarray, "h w"]


def write_submission(
    folder: Path, name: str, method: str, pair: StandardPair, disparity_px: Disparity, seconds: float
) -> tuple[Path, ...]:
    """A method's disparity of a pair of a set, each file whole or not at all; the files.

    disparity_px: at the size of the pair, NaN where unknown. seconds: what it took.
    Raises: ConfigError for a set that takes no submissions, OutputError if the folder cannot be written.
    """
    if name not in WRITERS:
        raise ConfigError(f"{name} takes no submissions; those that do are {', '.join(WRITERS)}")
    label = _plain(method)
    return WRITERS[name](folder / label, label, pair, disparity_px, seconds)


def write_pfm(path: Path, values: Disparity) -> None:
    """A portable float map: rows from the bottom up, little-endian; what is not finite is infinite.

    Raises: OutputError.
    """
    known = np.where(np.isfinite(values), values, np.float32(np.inf))
    with atomic_write(path) as file:
        file.write(f"Pf\n{values.shape[1]} {values.shape[0]}\n-1.0\n".encode() + known[::-1].astype("<f4").tobytes())


def write_png16(path: Path, values: Disparity) -> None:
    """KITTI's: 256 a pixel in 16 bits, 0 unknown; what is known is at least 1, and at most what 16 bits hold."""
    from PIL import Image

    known = np.isfinite(values)
    stored = np.clip(np.rint(256 * np.where(known, values, 0)), 1, 65535) * known
    held = BytesIO()
    Image.fromarray(stored.astype(np.uint16)).save(held, format="PNG")
    with atomic_write(path) as file:
        file.write(held.getvalue())


def _middlebury(
    folder: Path, label: str, pair: StandardPair, disparity_px: Disparity, seconds: float
) -> tuple[Path, ...]:
    """As its SDK has it: trainingQ/NAME/disp0METHOD.pfm and timeMETHOD.txt, in seconds."""
    home = folder / f"{'test' if pair.test else 'training'}{pair.resolution or 'F'}" / pair.name
    found, time = home / f"disp0{label}.pfm", home / f"time{label}.txt"
    write_pfm(found, disparity_px)
    write_text(time, f"{seconds:.6g}\n")
    return found, time


def _kitti_2012(
    folder: Path, label: str, pair: StandardPair, disparity_px: Disparity, seconds: float
) -> tuple[Path, ...]:
    write_png16(folder / f"{pair.name}.png", disparity_px)
    return (folder / f"{pair.name}.png",)


def _kitti_2015(
    folder: Path, label: str, pair: StandardPair, disparity_px: Disparity, seconds: float
) -> tuple[Path, ...]:
    return _kitti_2012(folder / "disp_0", label, pair, disparity_px, seconds)


def _eth3d(folder: Path, label: str, pair: StandardPair, disparity_px: Disparity, seconds: float) -> tuple[Path, ...]:
    found, time = (folder / "low_res_two_view" / f"{pair.name}.{end}" for end in ("pfm", "txt"))
    write_pfm(found, disparity_px)
    write_text(time, f"runtime {seconds:.6g}\n")
    return found, time


def _plain(method: str) -> str:
    """A name that servers take: letters, digits, - and _.

    >>> _plain("zncc window_px=5")
    'zncc-window_px-5'
    """
    return re.sub(r"[^A-Za-z0-9_-]+", "-", method).strip("-") or "method"


Writer = Callable[[Path, str, StandardPair, Disparity, float], tuple[Path, ...]]
WRITERS: Mapping[str, Writer] = {
    **dict.fromkeys(("middlebury-eval3", "middlebury-2014", "middlebury-2021"), _middlebury),
    "kitti-2012": _kitti_2012,
    "kitti-2015": _kitti_2015,
    "eth3d": _eth3d,
}

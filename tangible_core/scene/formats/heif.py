"""Pictures in HEIC, and the depth that phones store in them, by the extra `heic` (pillow-heif, over libheif)."""
# pyright: reportMissingTypeStubs=false, reportUnknownMemberType=false, reportUnknownVariableType=false
# (the extra may be missing, and has no types for its depth images)

from typing import Any, cast

import numpy as np

from ...files.reading import check_size
from .tiff import UnreadableError

HEIC = (b"heic", b"heix", b"hevc", b"heim", b"heis", b"mif1", b"msf1")
"""Brands of ISO's media files that are HEIC pictures, at the ninth byte of a file."""
_DEPTH = 2  # representation of distances; the others are of nearness


def is_heif(data: bytes) -> bool:
    """Return True for the first bytes of a HEIC picture."""
    return data[4:8] == b"ftyp" and data[8:12] in HEIC


def read_heif(data: bytes) -> np.ndarray:
    """Read the picture, upright. Raises: UnreadableError without the extra; TooLargeError; ValueError if damaged."""
    picture = _open(data)
    check_size((picture.size[1], picture.size[0], 4), 2)
    return np.asarray(picture)


def heif_depth(data: bytes) -> tuple[np.ndarray, bool] | None:
    """Read the first upright depth map, and whether near is light; None without one. Raises: as `read_heif`."""
    for depth in _open(data).info.get("depth_images") or ():
        check_size((depth.size[1], depth.size[0]), 2)
        kind = (depth.info.get("metadata") or {}).get("representation_type", 1)
        return np.asarray(depth.to_pillow().convert("L")), kind != _DEPTH
    return None


def _open(data: bytes) -> Any:
    try:
        import pillow_heif
    except ImportError as error:
        raise UnreadableError(
            "is a HEIC picture; `pip install 'tangible-images[heic]'` reads these, or save it as JPEG"
        ) from error
    return cast(Any, pillow_heif).open_heif(data, convert_hdr_to_8bit=True)

"""Pairs: two views in two files or in one. What one view states about the numbers or the camera holds for both."""

from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from ...data.pictures import MOST, full_scale, size_in_words
from ...errors import PictureError
from .decoding import ORIENTATION, content_bytes, decode, decode_values, look_at, upright
from .kinds import JPEG
from .multi_picture import Notify, ignore, view_numbers
from .pictures import NonFinite, to_picture

if TYPE_CHECKING:
    from PIL.Image import Image

Layout = Literal["side-by-side", "cross-eyed", "top-bottom", "bottom-top"]

_INSEPARABLE = {1: "both views in alternate rows (interleaved)", 4: "both views in one picture's colours (an anaglyph)"}


class Pair(NamedTuple):
    """The two views of a pair."""

    left: np.ndarray
    right: np.ndarray


class Stored(NamedTuple):
    """The upright pixels of a file, in its own type of numbers, and the orientation by EXIF, None if it states none."""

    values: np.ndarray
    orientation: int | None
    name: str


def read_stored(path: Path, notify: Notify = ignore) -> Stored:
    """Read a picture file as it is. Raises: PictureError as `read_picture`."""
    data = content_bytes(path)
    return Stored(decode_values(path, data, notify), _stated_orientation(path, data), str(path))


def to_views(left: Stored, right: Stored, non_finite: NonFinite = "error", notify: Notify = ignore) -> Pair:
    """Return stored pictures as a pair of one orientation, white and type of numbers. Raises: PictureError."""
    left, right = turn_alike(left, right, notify), turn_alike(right, left, notify)
    values = zip(same_type(left, right), (left.name, right.name), strict=True)
    return Pair(*same_white(*(to_picture(picture, name, non_finite) for picture, name in values)))


def turn_alike(picture: Stored, other: Stored, notify: Notify = ignore) -> Stored:
    """Turn a picture that states no orientation as the other states it, if they are of one size then."""
    turned = upright(picture.values, other.orientation or 1)
    differ = picture.values.shape[:2] != other.values.shape[:2]
    if turned is picture.values or turned.shape[:2] != other.values.shape[:2]:
        return picture
    if picture.orientation is not None and not (picture.orientation == 1 and differ):
        return picture
    notify(f"{Path(picture.name).name} is turned by the orientation that {Path(other.name).name} states")
    return picture._replace(values=np.ascontiguousarray(turned))


def same_type(*pictures: Stored) -> list[np.ndarray]:
    """Return whole numbers of more than 16 bits as 8 or 16 bits, all alike."""
    values = [picture.values for picture in pictures]
    if all(view.dtype.kind in "iu" and view.dtype.itemsize > 2 and view.size for view in values):
        high = max(int(view.max()) for view in values)
        if high <= MOST and min(int(view.min()) for view in values) >= 0:
            return [view.astype(np.min_scalar_type(high)) for view in values]
    return values


def same_white(*pictures: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return float pictures with white at 1 if they differ in what they take for white; other ones as they are."""
    if any(picture.dtype.kind != "f" for picture in pictures):
        return pictures
    finite = [np.nan_to_num(picture, posinf=0, neginf=0) for picture in pictures]
    if len({full_scale(picture) for picture in finite}) == 1:
        return pictures
    return tuple(picture / full_scale(*finite) for picture in pictures)


def read_pair(
    path: Path, layout: Layout | None = None, non_finite: NonFinite = "error", notify: Notify = ignore
) -> Pair:
    """Read the left and right view of one file: the two pictures of an .mpo file, or the halves of one picture.

    layout: the order of the halves; None: the order that a .jps file states.
    Raises: PictureError as `read_picture`, or if there are no halves.
    """
    data = content_bytes(path)
    if layout is None and len(numbers := _view_numbers(path, data)) > 1:
        left, right = (
            Stored(decode(path, data, frame=number), _stated_orientation(path, data, number), str(path))
            for number in numbers[:2]
        )
        return to_views(left, right, non_finite, notify)
    layout = layout or _stated_layout(path, data, notify)
    whole = to_picture(decode_values(path, data, notify), str(path), non_finite)
    return halves(whole, layout, str(path))


def holds_two_views(path: Path) -> bool:
    """Return True for a Multi-Picture file of two views. Raises: PictureError as `read_picture`."""
    return len(_view_numbers(path, content_bytes(path))) > 1


def _view_numbers(path: Path, data: bytes) -> list[int]:
    if data[:3] != JPEG:
        return []
    return look_at(path, data, lambda image: view_numbers(image) if image.format == "MPO" else [])


def halves(picture: np.ndarray, layout: Layout | None, name: str) -> Pair:
    """Divide a picture into two views, without an odd middle row or column. Raises: PictureError without halves."""
    axis = 0 if layout in ("top-bottom", "bottom-top") else 1
    half = picture.shape[axis] // 2
    if half == 0:
        raise PictureError(f"{name}: {size_in_words(picture)} pixels have no two halves; give left and right")
    first, second = (picture[:half], picture[-half:]) if axis == 0 else (picture[:, :half], picture[:, -half:])
    left, right = (second, first) if layout in ("cross-eyed", "bottom-top") else (first, second)
    return Pair(np.ascontiguousarray(left), np.ascontiguousarray(right))


def _stated_layout(path: Path, data: bytes, notify: Notify) -> Layout:
    """Return the layout that a .jps file states, cross-eyed by default. Raises: PictureError without two views."""
    # The descriptor in its APP3 segment, as ExifTool has it: flags, layout and type, a byte each.
    at = data.find(b"_JPSJPS_", 0, 1 << 17)
    flags, layout, kind = data[at + 11 : at + 14] if 0 < at < len(data) - 13 else (0, 0, None)
    suffix = path.suffix.lower()
    if kind == 0 or (kind is None and suffix == ".mpo"):
        raise PictureError(
            f"{path}: holds one view, not a pair; write `photo:` for it, or add `layout:` if its halves are the views"
        )
    if kind != 1:
        return "cross-eyed" if suffix == ".jps" else "side-by-side"
    if layout in _INSEPARABLE:
        raise PictureError(
            f"{path}: holds {_INSEPARABLE[layout]}, which are not separated here; save the views side by side, or as "
            "two files"
        )
    if flags & 3:
        notify(f"{path.name} states that its views were squeezed to half their size, which they keep")
    if layout == 3:
        return "top-bottom" if flags & 4 else "bottom-top"
    return "side-by-side" if flags & 4 else "cross-eyed"


def _stated_orientation(path: Path, data: bytes, frame: int = 0) -> int | None:
    def look(image: "Image") -> int | None:
        image.seek(frame)
        return image.getexif().get(ORIENTATION)

    try:
        return look_at(path, data, look)
    except PictureError:
        return None

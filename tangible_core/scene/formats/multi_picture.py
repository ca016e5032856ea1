"""Files with several pictures in them: pages, frames of an animation, the two views of a stereo camera."""
# (Pillow has no types for what it keeps of several pictures)

import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    from PIL.Image import Image

# A callback that takes remarks on a file, such as that it holds further pictures.
Notify = Callable[[str], None]

MAX_PICTURES = 100  # largest number of pictures of a Multi-Picture file that are counted
_MP_ENTRIES = 0xB002  # tag of the Multi-Picture Format
_MP_HEAD = re.compile(rb"MPF\0(?:II\*\0|MM\0\*)")
_AUXILIARY = re.compile(rb"hdr-gain-map|:iso:ts:21496:|AuxiliaryImageType")  # in gain maps, and a phone's depth


def ignore(_: str) -> None:
    """Drop a remark."""


def count_pictures(image: "Image") -> int:
    """Count the pictures in an open file, without thumbnails and gain maps; stand at the first one."""
    try:
        if image.format == "MPO":
            return max(1, len(view_numbers(image)))
        return int(getattr(image, "n_frames", 1))
    except Exception:  # noqa: BLE001 - damage behind the first picture does not spoil the first one
        return 1
    finally:
        image.seek(0)


def multi_pictures(image: "Image", data: bytes) -> list[bytes]:
    """Return the bytes of all pictures of a Multi-Picture file (CIPA DC-007); none for another file."""
    if image.format != "MPO":
        return []
    head = _MP_HEAD.search(data)
    start = head.end() - 4 if head else 0
    entries = cast(Any, image).mpinfo[_MP_ENTRIES]
    starts = [start + entry["DataOffset"] if entry["DataOffset"] else 0 for entry in entries]
    return [data[at : at + entry["Size"]] for entry, at in zip(entries, starts, strict=True)]


def view_numbers(image: "Image") -> list[int]:
    """Return the numbers of a Multi-Picture file's pictures that show the scene from different places."""
    # Where it does not type two of them so, they are the pictures of the first one's size: editors write any type.
    entries = cast(Any, image).mpinfo[_MP_ENTRIES]
    kinds = [str(entry["Attribute"]["MPType"]) for entry in entries]
    views = [number for number, kind in enumerate(kinds) if "Disparity" in kind or "Multi-Angle" in kind]
    return views if len(views) > 1 else _of_first_size(image, len(entries))


def _of_first_size(image: "Image", count: int) -> list[int]:
    image.seek(0)
    first = image.size
    numbers = [0]
    for number in range(1, min(count, MAX_PICTURES)):
        image.seek(number)
        segments = cast(Any, image).applist
        if image.size == first and not any(_AUXILIARY.search(content) for _, content in segments):
            numbers.append(number)
    return numbers

"""The depth that a phone stored in a portrait: Google's GDepth and Dynamic Depth, and the JPEGs of iPhones.

HEIC has its depth by the extra `heic`. Not supported: Samsung's data behind the JPEG.
Sources: developers.google.com/depthmap-metadata; developer.android.com, Dynamic Depth 1.0; CIPA DC-007 (Multi-Picture
Format), whose second picture is described by Apple's `pixeldatainfo`; Adobe, XMP part 3 (extended XMP).
"""

import math
import re
import struct
from base64 import b64decode
from collections.abc import Mapping
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np
from jaxtyping import Float32

from ...data.pictures import size_in_words, to_grey
from ...errors import PictureError, shown
from ...runtime.opencv import cv2, plain_opencv
from .decoding import content_bytes, decode, look_at, orientation, upright
from .heif import heif_depth, is_heif
from .kinds import JPEG
from .multi_picture import Notify, ignore, multi_pictures

if TYPE_CHECKING:
    from PIL.Image import Image

_XMP, _EXTENDED = b"http://ns.adobe.com/xap/1.0/\0", b"http://ns.adobe.com/xmp/extension/\0"
_GUID = 32
_DATA = re.compile(rb'GDepth:Data\s{0,9}(?:=\s{0,9}(")|(>))')
_RANGE = re.compile(rb'GDepth:(Format|Near|Far)\s{0,9}(?:=\s{0,9}"|>)\s{0,9}([\w.+-]{1,30})')
_ITEM = re.compile(rb"<Container:Item\b[^>]{0,600}>")
# Bytes of metadata in which a list of container items is searched: this bounds the time on any file.
_ITEMS = 1 << 20
_SEMANTIC = re.compile(rb'Item:Semantic\s*=\s*"([^"]*)"')
_LENGTHS = re.compile(rb'Item:(?:Length|Padding)\s*=\s*"(\d{1,10})"')
_AUXILIARY = re.compile(rb'AuxiliaryImageType\s*(?:=\s*"|>)\s*(disparity|depth)\b')


class PhoneDepth(NamedTuple):
    """A depth map inside a photo."""

    picture: bytes  # a grey picture as a file of its own
    near_is_light: bool
    kind: str  # name of the format
    # The depths of black and white, where the picture is linear in depth; None where it is in one over the depth.
    linear: tuple[float, float] | None = None


def read_phone_depth(path: Path, shape: tuple[int, int], notify: Notify = ignore) -> Float32[np.ndarray, "h w"] | None:
    """Read the nearness, 0 far to 1 near, that a phone stored in its photo of (h, w); None if there is none."""
    data = content_bytes(path)
    try:
        depth = _heic_depth(data) if is_heif(data) else _jpeg_depth(path, data)
        return None if depth is None else _nearness(path, *depth, shape, notify)
    except (PictureError, ValueError, struct.error) as error:
        notify(f"the depth map in {path.name} is damaged and left out: {shown(str(error))}")
        return None


def _jpeg_depth(path: Path, data: bytes) -> tuple[Float32[np.ndarray, "h w"], PhoneDepth] | None:
    if not data.startswith(JPEG):
        return None
    turn, depth = look_at(path, data, lambda image: (orientation(image), phone_depth(image, data)))
    if depth is None:
        return None
    own_turn = look_at(path, depth.picture, orientation)
    return upright(to_grey(decode(path, depth.picture)), turn if own_turn == 1 else 1), depth


def _heic_depth(data: bytes) -> tuple[Float32[np.ndarray, "h w"], PhoneDepth] | None:
    depth = heif_depth(data)
    return None if depth is None else (to_grey(depth[0]), PhoneDepth(b"", depth[1], "HEIC"))


def _nearness(
    path: Path, turned: Float32[np.ndarray, "rows columns"], depth: PhoneDepth, shape: tuple[int, int], notify: Notify
) -> Float32[np.ndarray, "h w"]:
    grey = np.ascontiguousarray(turned)
    notify(
        f"{path.name} holds a depth map of {size_in_words(grey)} ({depth.kind}), which is used; "
        "`photo_depth: false` leaves it out"
    )
    with plain_opencv():
        near = np.asarray(cv2.resize(grey, shape[::-1], interpolation=cv2.INTER_LINEAR))
    if depth.linear is not None:
        low, high = depth.linear
        share = low / (low + near * np.float32(high - low))
        return (share - np.float32(low / high)) / np.float32(1 - low / high)
    return near if depth.near_is_light else 1 - near


def phone_depth(image: "Image", data: bytes) -> PhoneDepth | None:
    """Find the depth map in an open JPEG; None if there is none. Raises: ValueError or struct.error if damaged."""
    xmp = _xmp(image, len(data))
    if match := _DATA.search(xmp):
        end = xmp.find(b'"' if match[1] else b"<", match.end())
        data = b64decode(xmp[match.end() : max(end, match.end())])
        return PhoneDepth(data, False, "GDepth", _linear_range(dict(_RANGE.findall(xmp))))
    if item := _depth_item(xmp, data):
        return PhoneDepth(item, False, "Dynamic Depth")
    from PIL.JpegImagePlugin import JpegImageFile

    for part in multi_pictures(image, data)[1:]:
        with suppress(SyntaxError), JpegImageFile(BytesIO(part)) as inner:  # a part may be of another kind
            if match := _AUXILIARY.search(_xmp(inner, len(part))):
                return PhoneDepth(part, match[1] == b"disparity", "an iPhone's")
    return None


def _linear_range(stated: Mapping[bytes, bytes]) -> tuple[float, float] | None:
    """Return near and far of a picture in GDepth's RangeLinear; None for RangeInverse. Raises: ValueError."""
    low, high = (float(stated.get(name, b"0")) for name in (b"Near", b"Far"))
    return (low, high) if stated.get(b"Format") == b"RangeLinear" and 0 < low < high < math.inf else None


def _xmp(image: "Image", bytes_of_file: int) -> bytes:
    """Return a JPEG's metadata, followed by its extended XMP, which did not fit into one segment."""
    plain, extended = b"", bytearray()
    for segment in (content for name, content in cast(Any, image).applist if name == "APP1"):
        if segment.startswith(_XMP):
            plain += segment[len(_XMP) :]
        elif segment.startswith(_EXTENDED):
            size, at = struct.unpack_from(">II", segment, len(_EXTENDED) + _GUID)
            part = segment[len(_EXTENDED) + _GUID + 8 :]
            if size > bytes_of_file or at + len(part) > size:
                raise ValueError("the length of its extended XMP is wrong")
            extended.extend(bytes(max(0, at + len(part) - len(extended))))
            extended[at : at + len(part)] = part
    return plain + bytes(extended)


def _depth_item(xmp: bytes, data: bytes) -> bytes | None:
    """Return the item of a container that is its depth; items follow one another up to the end of the file."""
    end = len(data)
    for item in reversed(_ITEM.findall(xmp, 0, _ITEMS)):
        semantic = _SEMANTIC.search(item)
        start = end - sum(map(int, _LENGTHS.findall(item)))
        if semantic and semantic[1] in (b"Depth", b"DepthMap") and 0 < start < end:
            return data[start:end]
        end = start
    return None

"""Files with several pictures in them, as cameras and phones write them: pairs, and photos with a depth map."""

import io
import struct
from base64 import b64encode
from pathlib import Path

import numpy as np
from PIL import Image


def jpeg(picture: np.ndarray, xmp: bytes = b"", **options) -> bytes:
    file = io.BytesIO()
    Image.fromarray(picture).save(file, format="JPEG", quality=95, **options)
    data = file.getvalue()
    return data[:2] + segment(b"http://ns.adobe.com/xap/1.0/\0" + xmp) + data[2:] if xmp else data


def segment(content: bytes, marker: int = 0xE1) -> bytes:
    return struct.pack(">BBH", 0xFF, marker, len(content) + 2) + content


def write_mpo(path: Path, pictures: list[np.ndarray], kind: int) -> None:
    """Write pictures with Pillow, then change their type in the directory of the file."""
    first, *others = (Image.fromarray(picture) for picture in pictures)
    first.save(path, format="MPO", save_all=True, append_images=others, quality=95)
    data = bytearray(path.read_bytes())
    entries = data.index(b"MPF\0") + 54  # behind the head of the directory and its three tags
    for number in range(len(pictures)):
        first_kind = 0x030000 if kind == 0x010001 else kind
        struct.pack_into("<I", data, entries + 16 * number, kind if number else first_kind)
    path.write_bytes(bytes(data))


RAMP = np.tile(np.linspace(0, 255, 16).astype(np.uint8), (12, 1))
"""A depth map, 0 near."""
PHOTO = np.full((24, 32, 3), 90, np.uint8)


def gdepth(depth: bytes) -> bytes:
    """Return a JPEG whose depth is in extended XMP: two segments, in the wrong order."""
    text = b'<x GDepth:Format="RangeInverse" GDepth:Near="1" GDepth:Far="9" GDepth:Data="' + b64encode(depth) + b'"/>'
    half = len(text) // 2
    parts = [(half, text[half:]), (0, text[:half])]
    extended = [
        segment(b"http://ns.adobe.com/xmp/extension/\0" + b"A" * 32 + struct.pack(">II", len(text), at) + part)
        for at, part in parts
    ]
    data = jpeg(PHOTO, b'<x xmpNote:HasExtendedXMP="AA"/>')
    return data[:2] + b"".join(extended) + data[2:]


def dynamic(depth: bytes, pad: int = 0, last_pad: int = 0) -> bytes:
    """Return a JPEG with items behind it. pad, last_pad: bytes behind the depth, and behind what follows it."""
    other = b"a video"
    items = [("Primary", b"", 0), ("MotionPhoto", other, 3), ("Depth", depth, pad), ("Confidence", other, last_pad)]
    xmp = "".join(
        f'<Container:Item Item:Semantic="{name}" Item:Length="{len(part)}" Item:Padding="{pad}"/>'
        for name, part, pad in items
    )
    return jpeg(PHOTO, xmp.encode()) + b"".join(part + bytes(pad) for _, part, pad in items)


def iphone(depth: bytes) -> bytes:
    """Return a JPEG with a disparity map, in which near is light."""
    xmp = b"<apdi:AuxiliaryImageType>disparity</apdi:AuxiliaryImageType>"
    file = io.BytesIO()
    Image.fromarray(PHOTO).save(
        file, format="MPO", save_all=True, append_images=[Image.fromarray(255 - RAMP)], quality=95
    )
    data = file.getvalue()
    start = data.rindex(b"\xff\xd8\xff")
    extra = segment(b"http://ns.adobe.com/xap/1.0/\0" + xmp)
    grown = bytearray(data[: start + 2] + extra + data[start + 2 :])
    size = struct.pack("<I", len(data) - start)
    at = grown.index(size, grown.index(b"MPF\0"))
    grown[at : at + 4] = struct.pack("<I", len(data) - start + len(extra))
    return bytes(grown)

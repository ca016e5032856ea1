"""A solid as GLB with the picture on it, for viewing in a browser or next to a print."""

import json
import struct
from math import ceil
from typing import IO, TYPE_CHECKING, Any, ClassVar

import numpy as np
from jaxtyping import Float32, UInt8

from tangible_core.data import Work
from tangible_core.runtime import cv2

from .solid.exporter import SolidExporter

if TYPE_CHECKING:
    from .solid.closed import Solid
    from .solid.plate import Layout


class Glb(SolidExporter):
    """The solid of `stl` with the picture as its texture, as binary glTF: in metres, y up as glTF requires.

    The origin is the centre of the plate's lower side. Without a picture, as in a scene of heights, the solid has one
    colour.
    Source: glTF 2.0 Specification, The Khronos Group, sec. 3 and 4.
    """

    ending: ClassVar[str] = "glb"

    def write_solid(self, file: IO[bytes], solid: "Solid", layout: "Layout", work: Work) -> None:
        """Write the solid, with the picture if there is one."""
        file.write(as_glb(solid, layout, work.title, work.picture))


RIM_GREY = 225
MAX_PX = 4096  # graphics processors of phones take no larger textures
_ARRAY, _ELEMENTS = 34962, 34963
_FLOAT, _UINT = 5126, 5125
_CLAMP = 33071


def as_glb(solid: "Solid", layout: "Layout", title: str, picture: np.ndarray | None) -> bytes:
    """Return the bytes of the file."""
    x_mm, y_mm, z_mm = solid.vertices_mm.T
    width_mm, length_mm, _ = solid.vertices_mm.max(axis=0)
    upright = np.stack([x_mm - width_mm / 2, z_mm, length_mm / 2 - y_mm], axis=1)
    positions = (upright / 1000).astype("<f4")
    bounds = {"min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()}
    parts: list[tuple[bytes, dict[str, Any], dict[str, Any]]] = [
        (positions.tobytes(), {"target": _ARRAY}, {"componentType": _FLOAT, "type": "VEC3", **bounds}),
        (solid.triangles.astype("<u4").tobytes(), {"target": _ELEMENTS}, {"componentType": _UINT, "type": "SCALAR"}),
    ]
    look: dict[str, Any] = {"metallicFactor": 0, "roughnessFactor": 0.9}
    attributes, more = {"POSITION": 0}, dict[str, Any]()
    if picture is not None:
        texture, places = _texture(picture, layout, solid)
        _, jpeg = cv2.imencode(".jpg", texture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 90])
        parts += [
            (places.tobytes(), {"target": _ARRAY}, {"componentType": _FLOAT, "type": "VEC2"}),
            (jpeg.tobytes(), {}, {}),
        ]
        attributes["TEXCOORD_0"] = 2
        look["baseColorTexture"] = {"index": 0}
        more = {
            "images": [{"bufferView": 3, "mimeType": "image/jpeg"}],
            "samplers": [{"wrapS": _CLAMP, "wrapT": _CLAMP}],
            "textures": [{"source": 0, "sampler": 0}],
        }
    counts = {"VEC2": 2, "VEC3": 3, "SCALAR": 1}
    accessors = [
        {"bufferView": place, "count": len(data) // (4 * counts[kind["type"]]), **kind}
        for place, (data, _, kind) in enumerate(parts)
        if kind
    ]
    head = {
        "asset": {"version": "2.0", "generator": "tangible-images"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": title}],
        "meshes": [{"name": title, "primitives": [{"attributes": attributes, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": look}],
        "accessors": accessors,
        **more,
    }
    return _pack(head, [(data, view) for data, view, _ in parts])


def _pack(head: dict[str, Any], parts: list[tuple[bytes, dict[str, Any]]]) -> bytes:
    """Return a GLB of two chunks, JSON and binary, each padded to whole words of 4 bytes."""
    body, views = bytearray(), list[dict[str, Any]]()
    for data, view in parts:
        views.append({"buffer": 0, "byteOffset": len(body), "byteLength": len(data), **view})
        body += data + bytes(-len(data) % 4)
    text = json.dumps(head | {"bufferViews": views, "buffers": [{"byteLength": len(body)}]}).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(body), b"BIN\0") + body
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def _texture(
    picture: np.ndarray, layout: "Layout", solid: "Solid"
) -> tuple[UInt8[np.ndarray, "h w 3"], Float32[np.ndarray, "n 2"]]:
    """Return the picture in a grey rim, and the texture coordinates of each vertex, 0..1 from the upper left."""
    from tangible_core.data import to_rgb8

    colours = _shrink(to_rgb8(picture), layout)
    across, down = (px / side_m for px, side_m in zip(colours.shape[1::-1], layout.picture_m, strict=True))
    side, above, below = ceil(across * layout.rim_m), ceil(down * layout.rim_m), ceil(down * layout.below_m)
    texture = cv2.copyMakeBorder(colours, above, below, side, side, cv2.BORDER_CONSTANT, value=(RIM_GREY,) * 3)
    x_m, y_m, _ = solid.vertices_mm.T / 1000
    column = side + across * (x_m - layout.rim_m)
    row = above + down * (layout.size_m[1] - layout.rim_m - y_m)
    return texture, np.stack([column / texture.shape[1], row / texture.shape[0]], axis=1).astype("<f4")


def _shrink(colours: UInt8[np.ndarray, "h w 3"], layout: "Layout") -> UInt8[np.ndarray, "h2 w2 3"]:
    """Shrink the picture so that the texture of the whole plate has no side longer than `MAX_PX`."""
    sides = zip(colours.shape[1::-1], layout.picture_m, layout.size_m, strict=True)
    scale = min(1.0, *((MAX_PX - 4) * own_m / (px * whole_m) for px, own_m, whole_m in sides))
    rows, columns = (max(1, int(scale * px)) for px in colours.shape[:2])
    if (rows, columns) == colours.shape[:2]:
        return colours
    return cv2.resize(colours, (columns, rows), interpolation=cv2.INTER_AREA)

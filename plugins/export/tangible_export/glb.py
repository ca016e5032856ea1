"""A solid as GLB, with the picture on it: to be looked at, in a browser or beside a print."""

import json
import struct
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from jaxtyping import Float32, UInt8

from tangible_core.data import Work
from tangible_core.plugins.interfaces import Exporter, Medium

from .solid import exporter as said

if TYPE_CHECKING:
    from .solid.closed import Solid
    from .solid.plate import Layout


class Glb(Exporter):
    """The solid of `stl` with the picture as its texture, as binary glTF: metres, and y up as glTF has it.

    Its origin is the centre of the plate's lower side. Without a picture, as in a scene of heights, it is one colour.
    Source: glTF 2.0 Specification, The Khronos Group, sec. 3 and 4.
    """

    needs: ClassVar[tuple[str, ...]] = ("relief",)
    medium: ClassVar[Medium | None] = "print"

    longer_side_m: said.LongerSide = 0.16
    error_m: said.Error = 5e-5
    base_m: said.Base = 0.0015
    rim_m: said.Rim = 0.006
    corner_mark: said.CornerMark = True
    braille: said.Braille = True
    braille_language: said.BrailleLanguage = None

    def picture_width_m(self, aspect: float) -> float:
        """Of the picture, whose longer side is `longer_side_m`."""
        return said.width_of(self.longer_side_m, aspect)

    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        """One file, `stem.glb`.

        Raises: GeometryError for a relief of no height, BrailleError or OutputError for a title that cannot be written.
        """
        from .solid.making import made_solid

        path = stem.with_name(f"{stem.name}.glb")
        path.write_bytes(as_glb(*made_solid(self, work), work.title, work.picture))
        return (path,)


RIM_GREY = 225
MOST_PX = 4096
"""Of a side of the texture: graphics processors of phones take no more."""
_ARRAY, _ELEMENTS = 34962, 34963
_FLOAT, _UINT = 5126, 5125
_CLAMP = 33071


def as_glb(solid: "Solid", layout: "Layout", title: str, picture: np.ndarray | None) -> bytes:
    """The file."""
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
        parts += [
            (places.tobytes(), {"target": _ARRAY}, {"componentType": _FLOAT, "type": "VEC2"}),
            (_jpeg(texture), {}, {}),
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
    return _packed(head, [(data, view) for data, view, _ in parts])


def _packed(head: dict[str, Any], parts: list[tuple[bytes, dict[str, Any]]]) -> bytes:
    """The two chunks of a GLB, each of whole words."""
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
    """The picture with the rim in grey around it, and where each vertex lies on that, as shares from its upper left."""
    import cv2

    from tangible_core.data.pictures import to_rgb8

    colours = _within(to_rgb8(picture), layout)
    across, down = (px / side_m for px, side_m in zip(colours.shape[1::-1], layout.picture_m, strict=True))
    side, above, below = ceil(across * layout.rim_m), ceil(down * layout.rim_m), ceil(down * layout.below_m)
    texture = cv2.copyMakeBorder(colours, above, below, side, side, cv2.BORDER_CONSTANT, value=(RIM_GREY,) * 3)
    x_m, y_m, _ = solid.vertices_mm.T / 1000
    column = side + across * (x_m - layout.rim_m)
    row = above + down * (layout.size_m[1] - layout.rim_m - y_m)
    return texture, np.stack([column / texture.shape[1], row / texture.shape[0]], axis=1).astype("<f4")


def _within(colours: UInt8[np.ndarray, "h w 3"], layout: "Layout") -> UInt8[np.ndarray, "h2 w2 3"]:
    """So small that the texture of the whole plate has no side of more than `MOST_PX`."""
    import cv2

    sides = zip(colours.shape[1::-1], layout.picture_m, layout.size_m, strict=True)
    scale = min(1.0, *((MOST_PX - 4) * own_m / (px * whole_m) for px, own_m, whole_m in sides))
    rows, columns = (max(1, int(scale * px)) for px in colours.shape[:2])
    small = (rows, columns) != colours.shape[:2]
    return cv2.resize(colours, (columns, rows), interpolation=cv2.INTER_AREA) if small else colours


def _jpeg(texture: UInt8[np.ndarray, "h w 3"]) -> bytes:
    import cv2

    _, data = cv2.imencode(".jpg", texture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, 90])
    return data.tobytes()

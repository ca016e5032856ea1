"""A solid as STL, the format that every slicer reads."""

from typing import IO, TYPE_CHECKING, ClassVar

import numpy as np

from tangible_core.data import Work

from .solid.exporter import SolidExporter

if TYPE_CHECKING:
    from .solid.closed import Solid
    from .solid.plate import Layout


FACETS_AT_ONCE = 65_536  # a solid may have millions
HEAD = b"tangible-images; unit: millimetre"
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])


class Stl(SolidExporter):
    """A closed solid to print, in millimetres, as binary STL: the relief on a plate with its title in braille.

    For any printer and slicer, and for people without swell paper; `3mf` is smaller and knows its unit, `glb` has the
    picture as its colour. `tangible export photo.jpg --to stl` writes one.

    Binary STL has no unit; slicers read its numbers as millimetres, which they are.
    Source: StereoLithography Interface Specification, 3D Systems, 1988.
    """

    ending: ClassVar[str] = "stl"

    def write_solid(self, file: IO[bytes], solid: "Solid", layout: "Layout", work: Work) -> None:
        """Write the head, the number of facets and the facets, with their normals."""
        file.write(HEAD.ljust(79) + b"\0" + np.uint32(len(solid.triangles)).tobytes())
        for first in range(0, len(solid.triangles), FACETS_AT_ONCE):
            corners = solid.vertices_mm[solid.triangles[first : first + FACETS_AT_ONCE]]
            normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            facets = np.zeros(len(corners), _FACET)
            facets["normal"] = normals / np.linalg.norm(normals, axis=1, keepdims=True)
            facets["corners"] = corners
            file.write(facets.tobytes())

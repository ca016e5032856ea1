"""A solid as STL, the format that every slicer reads."""

from pathlib import Path
from typing import IO, TYPE_CHECKING, ClassVar

import numpy as np

from tangible_core.data import Work
from tangible_core.plugins.interfaces import Exporter, Medium

from .solid import exporter as said

if TYPE_CHECKING:
    from .solid.closed import Solid


class Stl(Exporter):
    """A closed solid to print, in millimetres, as binary STL: the relief on a plate with its title in braille.

    Binary STL has no unit; slicers take its numbers for millimetres, and so they are.
    Source: StereoLithography Interface Specification, 3D Systems, 1988.
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
        """One file, `stem.stl`.

        Raises: GeometryError for a relief of no height, BrailleError or OutputError for a title that cannot be written.
        """
        from .solid.making import made_solid

        solid, _ = made_solid(self, work)
        path = stem.with_name(f"{stem.name}.stl")
        with path.open("wb") as file:
            write_stl(file, solid)
        return (path,)


FACETS_AT_ONCE = 65_536
HEAD = b"tangible-images; unit: millimetre"
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])


def write_stl(file: IO[bytes], solid: "Solid") -> None:
    """Some facets at a time: there may be millions."""
    file.write(HEAD.ljust(79) + b"\0" + np.uint32(len(solid.triangles)).tobytes())
    for first in range(0, len(solid.triangles), FACETS_AT_ONCE):
        corners = solid.vertices_mm[solid.triangles[first : first + FACETS_AT_ONCE]]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        facets = np.zeros(len(corners), _FACET)
        facets["normal"] = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        facets["corners"] = corners
        file.write(facets.tobytes())

"""Readers of solids, independent of the code that writes them; and heights as seen from above."""

import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import lib3mf
import numpy as np

from tangible_core.data import Relief, Work
from tangible_core.plugins.interfaces import Exporter
from tangible_export import Glb, Stl, ThreeMF

if TYPE_CHECKING:
    import trimesh

FORMATS: dict[str, type[Exporter]] = {"stl": Stl, "3mf": ThreeMF, "glb": Glb}


class Mesh(NamedTuple):
    """A mesh in millimetres, x to the right, y to the back, z up; from the lower left corner of the plate on."""

    vertices: np.ndarray
    triangles: np.ndarray


def work(heights_m: Any, width_m: float = 0.02, title: str = "", **more: Any) -> Work:
    """Return a work with a relief of square cells."""
    heights = np.ascontiguousarray(heights_m, np.float32)
    relief = Relief(heights, (width_m, width_m * heights.shape[0] / heights.shape[1]))
    return Work(title, more.pop("language", "en"), {"relief": relief}, **more)


def bare(cls: type[Exporter], **options: Any) -> Exporter:
    """Return an exporter of the picture alone, without a rim."""
    return cls.model_validate({"rim_m": 0.0, "braille": False, "corner_mark": False, **options})


def write_and_read(exporter: Exporter, work: Work, folder: Path) -> Mesh:
    """Write the one file of a work, and read its solid."""
    (path,) = exporter.write(work, folder / "solid")
    return read(path)


def read(path: Path) -> Mesh:
    """Read a solid by the ending of its file: STL by its specification, 3MF by lib3mf, GLB by trimesh."""
    return _READERS[path.suffix](path)


def _stl(path: Path) -> Mesh:
    data = path.read_bytes()
    assert not data.startswith(b"solid"), "that is how an STL of text begins"
    count = int.from_bytes(data[80:84], "little")
    assert len(data) == 84 + 50 * count
    facets = np.frombuffer(data, np.dtype([("normal", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")]), offset=84)
    corners = facets["p"].reshape(-1, 3).astype(np.float64)
    sides = np.diff(facets["p"].astype(np.float64), axis=1)
    normals = np.cross(sides[:, 0], sides[:, 1])
    assert np.allclose(facets["normal"], normals / np.linalg.norm(normals, axis=1, keepdims=True), atol=2e-3)
    vertices, which = np.unique(corners, axis=0, return_inverse=True)
    return Mesh(vertices, which.reshape(-1, 3))


def _3mf(path: Path) -> Mesh:
    _, (body,) = read_3mf(path)
    vertices = [body.GetVertex(i).Coordinates[:] for i in range(body.GetVertexCount())]
    triangles = [body.GetTriangle(i).Indices[:] for i in range(body.GetTriangleCount())]
    return Mesh(np.array(vertices, np.float64), np.array(triangles, np.int64))


def read_3mf(path: Path) -> tuple[Any, list[Any]]:
    """Return the model and its meshes, read by lib3mf in strict mode without warnings."""
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(path))
    assert reader.GetWarningCount() == 0, [reader.GetWarning(i) for i in range(reader.GetWarningCount())]
    meshes, found = model.GetMeshObjects(), []
    while meshes.MoveNext():
        found.append(meshes.GetCurrentMeshObject())
    return model, found


def _glb(path: Path) -> Mesh:
    mesh = read_glb(path)
    x, up, towards = 1000 * np.asarray(mesh.vertices, np.float64).T
    vertices = np.stack([x, -towards, up], axis=1)
    return Mesh(vertices - np.array([*vertices.min(axis=0)[:2], 0]), np.asarray(mesh.faces))


def read_glb(path: Path) -> "trimesh.Trimesh":
    """Return the one mesh of a GLB unchanged."""
    import trimesh  # half a second, which not every worker needs

    scene = trimesh.load(io.BytesIO(path.read_bytes()), file_type="glb", process=False)
    (mesh,) = scene.geometry.values()
    return mesh


_READERS: Mapping[str, Callable[[Path], Mesh]] = {".stl": _stl, ".3mf": _3mf, ".glb": _glb}


def is_closed(mesh: Mesh) -> bool:
    """Tell whether each edge occurs once in each direction, and no triangle has two equal corners."""
    welded, which = np.unique(np.round(mesh.vertices, 4), axis=0, return_inverse=True)
    triangles = which.reshape(-1)[mesh.triangles]
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    there, back = (np.sort(edges[:, a] * len(welded) + edges[:, b]) for a, b in ((0, 1), (1, 0)))
    return bool((np.diff(there) > 0).all() and (there == back).all() and (edges[:, 0] != edges[:, 1]).all())


def volume(mesh: Mesh) -> float:
    """Return the volume by the divergence theorem: positive if triangles face outwards."""
    a, b, c = (mesh.vertices[mesh.triangles[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def from_above(mesh: Mesh, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the highest point over each place (y, x); both in ascending order; NaN where there is nothing."""
    heights = np.full((len(y), len(x)), np.nan)
    corners = mesh.vertices[mesh.triangles]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
    for p in corners[facing > 1e-12]:
        columns = slice(*np.searchsorted(x, (p[:, 0].min() - 1e-9, p[:, 0].max() + 1e-9)))
        rows = slice(*np.searchsorted(y, (p[:, 1].min() - 1e-9, p[:, 1].max() + 1e-9)))
        if columns.start < columns.stop and rows.start < rows.stop:
            shares = np.linalg.solve(np.vstack([p[:, :2].T, [1, 1, 1]]), _places(x[columns], y[rows]))
            inside = (shares > -1e-9).all(axis=0).reshape(rows.stop - rows.start, -1)
            z = (p[:, 2] @ shares).reshape(inside.shape)
            part = heights[rows, columns]
            part[inside] = np.fmax(part, z)[inside]
    return heights


def _places(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    across, along = np.meshgrid(x, y)
    return np.stack([across.ravel(), along.ravel(), np.ones(across.size)])


def nodes(work: Work, rim_mm: float = 0.0, below_mm: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return the places of the relief's cells on the plate, in millimetres: x from the left, y from the front."""
    rows, columns = work.relief.height_m.shape
    across, down = (1000 * pitch for pitch in work.relief.pitch_m)
    return rim_mm + (np.arange(columns) + 0.5) * across, below_mm + (np.arange(rows) + 0.5) * down


def rough(rows: int = 40, columns: int = 56) -> np.ndarray:
    """Return hills, a step and a cliff at the edge, in metres, without symmetry; the lowest point is 0."""
    y, x = np.mgrid[:rows, :columns] / columns
    heights = 0.003 + 0.002 * np.sin(9 * x + 4 * y * y) * np.cos(7 * y)
    heights[rows // 3 : rows // 2, columns // 2 :] += 0.002
    heights[:, : columns // 8] = 0
    return heights + np.random.default_rng(0).uniform(0, 1e-4, heights.shape) * (heights > 0)

"""Solids, read by independent programs: if a case fails, a print has holes, another shape, or cannot be sliced."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree
from zipfile import ZipFile

import numpy as np
import pytest

from needed import lacking
from solids import (
    FORMATS,
    Mesh,
    bare,
    from_above,
    is_closed,
    nodes,
    read,
    read_3mf,
    read_glb,
    rough,
    volume,
    work,
    write_and_read,
)
from tangible_core import Pipeline, Scene
from tangible_core.data import Relief, Work
from tangible_core.errors import GeometryError, OutputError
from tangible_core.plugins.interfaces import Exporter
from tangible_core.plugins.notes import collected
from tangible_export import Glb, Stl, ThreeMF
from tangible_export.solid import making
from tangible_export.solid.triangles import sample_nodes

EVERY = pytest.mark.parametrize("cls", FORMATS.values(), ids=FORMATS)
RIM_MM, BAND_MM = 6.0, 5 + 1.44 + 2 * 2.34
"""The rim by default, and what a line of braille adds before the picture."""


@pytest.fixture(params=["pydelatin", "grid"])
def mesher(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    if request.param == "grid":
        without_pydelatin(monkeypatch)
    return request.param


def without_pydelatin(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pydelatin", None)


def oblong(heights_m: np.ndarray) -> Work:
    """Return a work of cells that are 1 mm wide and 0.25 mm long."""
    made = work(heights_m)
    rows, columns = heights_m.shape
    return replace(made, products={"relief": replace(made.relief, extent_m=(columns / 1000, rows / 4000))})


@EVERY
@pytest.mark.parametrize("title", ["Coffee", ""])
def test_solid_is_closed_and_has_its_size(tmp_path: Path, cls: type[Exporter], title: str, mesher: str):
    sample = work(rough(), 0.05, title)
    mesh = write_and_read(cls(), sample, tmp_path)
    assert is_closed(mesh)
    heights = from_above(mesh, *nodes(sample, RIM_MM, RIM_MM + (BAND_MM if title else 0)))[::-1]
    assert heights == pytest.approx(1.5 + 1000 * sample.relief.height_m, abs=0.05), "row 0 at the back, as on a desk"
    length = 50 * 40 / 56 + 2 * RIM_MM + (BAND_MM if title else 0)
    assert mesh.vertices.min(axis=0).tolist() == pytest.approx([0, 0, 0], abs=1e-6)
    assert mesh.vertices[:, :2].max(axis=0).tolist() == pytest.approx([62, length], abs=1e-3)
    assert mesh.vertices[:, 2].max() == pytest.approx(1.5 + 1000 * sample.relief.height_m.max(), abs=0.05)
    below = 1.5 * 62 * length
    assert below < volume(mesh) < below + 50**2 * 7


@pytest.mark.parametrize("error_mm", [0.3, pytest.param(0.01, marks=pytest.mark.whole)])
def test_solid_nodes_are_within_the_error(tmp_path: Path, error_mm: float):
    sample = work(rough(), 0.05, "F")
    mesh = write_and_read(Stl(error_m=error_mm / 1000), sample, tmp_path)
    heights = from_above(mesh, *nodes(sample, RIM_MM, RIM_MM + BAND_MM))
    off = np.abs(heights[::-1] - 1.5 - 1000 * sample.relief.height_m)
    assert off.max() <= error_mm
    assert off.max() > error_mm / 2 or error_mm < 0.05, "fewer triangles would do"


@pytest.mark.whole
@pytest.mark.parametrize("is_oblong", [False, True])
def test_solid_of_steep_cliffs_keeps_the_error_despite_float32(tmp_path: Path, is_oblong: bool):
    """A coordinate that is rounded by so little as STL does it tells on a cliff of 8 mm; also of cells 60 mm long."""
    cliffs = 0.004 * np.random.default_rng(2).integers(0, 3, (6, 700))
    cliffs[:] = cliffs[0] if is_oblong else cliffs
    sample = work(cliffs + 1e-5 * np.random.default_rng(3).random((6, 700)), 0.12)
    if is_oblong:
        sample = replace(sample, products={"relief": replace(sample.relief, extent_m=(0.12, 0.36))})
    mesh = write_and_read(Stl(error_m=5e-6, rim_m=0.1, corner_mark=False, braille=False), sample, tmp_path)
    off = from_above(mesh, *nodes(sample, 100, 100))[::-1] - 1.5 - 1000 * sample.relief.height_m
    assert np.abs(off).max() <= 0.005


@EVERY
def test_solid_has_vertical_sides_and_a_flat_rim(tmp_path: Path, cls: type[Exporter]):
    mesh = write_and_read(cls(), work(np.full((8, 8), 0.003)), tmp_path)
    x = np.array([1, 3, 5.99, 6.01, 16, 25.99, 26.01, 31])
    heights = from_above(mesh, x, np.array([3.0, 16]))
    assert heights[0] == pytest.approx(1.5)
    assert heights[1] == pytest.approx([1.5] * 3 + [4.5] * 3 + [1.5] * 2)


@pytest.mark.parametrize("height_mm", [0, 0.05])
def test_solid_of_flat_relief_is_refused(tmp_path: Path, height_mm: float):
    with pytest.raises(GeometryError, match="the print would be flat"):
        Stl().write(work(np.full((9, 9), height_mm / 1000)), tmp_path / "flat")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("aspect", "width_m"), [(2.0, 0.12), (0.5, 0.06)])
def test_solid_picture_width_follows_longer_side(aspect: float, width_m: float):
    assert Stl.model_validate({"longer_side_m": "12 cm"}).picture_width_m(aspect) == pytest.approx(width_m)


@pytest.mark.parametrize("aspect", [2.0, 1.0, 0.4])
def test_solid_options_for_a_width_give_that_width_up_to_a_metre(aspect: float):
    options = Stl().options_for_width(0.123, aspect)
    assert 0.123 <= Stl.model_validate(options).picture_width_m(aspect) <= 0.131, "the next of two digits"
    longest = Stl().options_for_width(min(1.0, aspect), aspect)
    assert longest["longer_side_m"] == pytest.approx(1, rel=1e-3)
    assert not Stl().options_for_width(1.001 * min(1.0, aspect), aspect)


def test_print_keeps_cliffs_that_a_device_has_as_ramps(tmp_path: Path):
    import trimesh

    cliff = np.repeat(np.float32([[2, 9]]), 60, axis=1).repeat(90, axis=0)
    Pipeline(Scene.pair(cliff, cliff, disparity=cliff), cached=False).export(tmp_path, [Stl()])
    (file,) = tmp_path.glob("*.stl")
    faces = trimesh.load_mesh(file).face_normals
    inside = (np.abs(faces[:, 2]) > 1e-3) & (faces[:, 2] < 0.999) & (np.abs(faces[:, 1]) < 0.05)
    assert np.hypot(faces[inside, 0], faces[inside, 1]).max() > 0.9  # 64 degrees; a ramp has 48


class TestBraille:
    def test_braille_dots_are_islands_at_their_places(self, tmp_path: Path):
        """`a`, then `l`: dot 1, and dots 1 to 3 a cell further."""
        from scipy.ndimage import label

        mesh = write_and_read(Stl(), work(np.full((9, 9), 0.002), title="al"), tmp_path)
        x, y = np.arange(0, 32, 0.05), np.arange(0, RIM_MM + BAND_MM - 2.4, 0.05)
        heights = from_above(mesh, x, y) - 1.5
        assert heights.max() == pytest.approx(0.48, abs=6e-3)
        for level in (0.02, 0.2, 0.45):
            assert label(heights > level)[1] == 4
        assert (heights > 0.24).sum() / (heights > 0.001).sum() == pytest.approx(0.61, abs=0.04)  # of a ball's cap
        centres = [(6.72, 16.4), (12.92, 16.4), (12.92, 14.06), (12.92, 11.72)]
        for column, row in centres:
            assert heights[np.abs(y - (row - 5)).argmin(), np.abs(x - column).argmin()] > 0.47
        wide = np.ptp(x[(heights > 1e-6).any(axis=0) & (x < 10)])
        assert 1.3 < wide <= 1.44 + 0.05

    def test_braille_on_narrow_picture_is_refused_with_the_cure(self, tmp_path: Path):
        sample = work(np.full((9, 9), 0.002), 0.016, "I")
        long = work(np.full((9, 9), 0.002), 0.06, "word " * 40)
        for refused, reason in ((sample, "too narrow"), (long, "takes 20 lines of braille")):
            with pytest.raises(OutputError, match=reason):
                Stl().write(refused, tmp_path / "x")
        assert not list(tmp_path.iterdir())
        assert Stl().write(replace(sample, title=""), tmp_path / "x")


class TestRim:
    def test_corner_mark_is_a_triangle_at_the_upper_right(self, tmp_path: Path):
        mesh = write_and_read(Stl(rim_m=0.01), work(np.full((9, 9), 0.002)), tmp_path)
        x = y = np.arange(0.05, 40, 0.1)
        heights = from_above(mesh, x, y) - 1.5
        aside = heights.copy()
        aside[100:300, 100:300] = 0  # the picture
        rows, columns = np.nonzero(aside > 0.5)
        assert x[columns].min() == pytest.approx(35, abs=0.3) and x[columns].max() == pytest.approx(39, abs=0.2)
        assert y[rows].min() == pytest.approx(35, abs=0.3) and y[rows].max() == pytest.approx(39, abs=0.2)
        assert aside.max() == pytest.approx(1)
        corner = aside[rows.min() :, columns.min() :][:40, :40] > 0.5
        assert corner[-2, -2] and corner[-2, 2] and corner[2, -2] and not corner[2, 2]

    @pytest.mark.parametrize("rim_mm", [0.05, 1, 3.9, 30])
    def test_rim_of_any_width_gives_a_closed_solid(self, tmp_path: Path, rim_mm: float):
        sample = work(rough(), 0.05, "Coffee")
        with collected() as notes:
            mesh = write_and_read(Stl(rim_m=rim_mm / 1000), sample, tmp_path)
        assert is_closed(mesh)
        assert any("no room for the title and the corner mark" in note for note in notes) == (rim_mm < 4)
        wide = 50 + 2 * (rim_mm if rim_mm > 0.1 else 0)
        assert mesh.vertices[:, 0].max() == pytest.approx(wide, abs=1e-3)


class TestNotes:
    @staticmethod
    def of(exporter: Exporter, sample: Work, folder: Path) -> str:
        with collected() as notes:
            exporter.write(sample, folder / "noted")
        return "\n".join(notes)

    def test_note_names_thin_base_and_large_plate(self, tmp_path: Path):
        sample = work(np.full((9, 9), 0.002), 0.3)
        assert "a base of 0.7 mm bends" in self.of(Stl(base_m=0.0007), sample, tmp_path)
        assert "the plate is 312 mm long" in self.of(Stl(), sample, tmp_path)
        assert "a base" not in self.of(Stl(base_m=0.0008), work(np.full((9, 9), 0.002)), tmp_path)

    @pytest.mark.parametrize(("cells", "pitch_mm", "is_noted"), [(3, 0.1, True), (4, 0.1, False), (4, 0.13, False)])
    def test_note_names_shapes_thinner_than_a_nozzle(self, tmp_path: Path, cells: int, is_noted: bool, pitch_mm: float):
        heights = np.full((80, 80), 0.001)
        heights[20:60, 40 : 40 + cells] = 0.003
        notes = self.of(Stl(braille=False), work(heights, 80 * pitch_mm / 1000), tmp_path)
        assert ("thinner than a nozzle" in notes) == is_noted
        if is_noted:
            assert "up to 2 mm high" in notes and f"{40 * cells * pitch_mm**2:.1f} square mm" in notes

    @pytest.mark.parametrize(("across_mm", "down_mm", "is_noted"), [(1.1, 0, True), (0, 0.22, False), (0, 0.28, True)])
    def test_note_names_steep_slopes_of_oblong_cells(
        self, tmp_path: Path, across_mm: float, down_mm: float, is_noted: bool
    ):
        """Cells of 1 x 0.25 mm: rises from one to the next, which are those of 42 and 48 degrees on each axis."""
        rows, columns = np.indices((40, 12))
        notes = self.of(Stl(braille=False), oblong((across_mm * columns + down_mm * rows) / 1000), tmp_path)
        assert ("steeper than 45 degrees" in notes) == is_noted

    def test_solid_of_noise_has_limited_triangles(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
        monkeypatch.setattr(making, "MAX_TRIANGLES", 500)
        sample = work(rough(), 0.05)
        with collected() as notes:
            mesh = write_and_read(bare(Stl), sample, tmp_path)
        off = np.abs(from_above(mesh, *nodes(sample))[::-1] - 1.5 - 1000 * sample.relief.height_m).max()
        assert is_closed(mesh) and len(mesh.triangles) < 1000
        assert any(f"the solid is off by up to {off:.2g} mm, as it would take more than 500" in note for note in notes)

    @pytest.mark.parametrize("turned", [False, True])
    @pytest.mark.parametrize("rows", [2, 40])
    def test_nodes_of_fewer_columns_or_rows_are_means(self, rows: int, turned: bool):
        """One of four columns stands out, and all become level, on a strip of two rows too, which stay two."""
        heights = np.tile(np.float32([0.0, 0.0, 0.0, 0.004]), (rows, 100))
        relief = Relief(heights.T if turned else heights, (0.02, 0.08) if turned else (0.08, 0.02))
        found = sample_nodes(relief, rows * 25, "")
        assert found.extent_m == relief.extent_m
        nodes = {2: (2, 25), 40: (10, 100)}[rows]
        assert found.height_m.shape == (nodes[::-1] if turned else nodes)
        assert found.height_m == pytest.approx(0.001, abs=2e-4)


class TestThreeMF:
    def test_3mf_with_any_title_is_read_by_lib3mf_in_millimetres(self, tmp_path: Path):
        title = 'Kaffee & <Kuchen> "Ü" \x07\ud800\ufffe🍰'
        sample = work(rough(), 0.05, title, language='de"><x/>')
        (path,) = ThreeMF(braille=False).write(sample, tmp_path / "k")
        model, (body,) = read_3mf(path)
        assert (model.GetUnit().name, body.GetName()) == ("MilliMeter", 'Kaffee & <Kuchen> "Ü" 🍰')
        assert body.IsManifoldAndOriented()
        assert model.GetBuildItems().Count() == 1

    @pytest.mark.parametrize(("language", "tag"), [("de-AT", "de-AT"), ("en", "en"), ("de AT", None), ("", None)])
    def test_3mf_has_the_language_of_its_title_if_it_is_a_tag(self, tmp_path: Path, language: str, tag: str | None):
        (path,) = bare(ThreeMF).write(work(rough(), 0.05, "Hügel", language=language), tmp_path / "k")
        with ZipFile(path) as package:
            model = ElementTree.fromstring(package.read("3D/3dmodel.model"))
        assert model.get("{http://www.w3.org/XML/1998/namespace}lang") == tag
        assert [each.text for each in model.iterfind("{*}metadata")] == ["Hügel", "tangible-images"]


class TestGlb:
    COLOURS = np.array([[[250, 0, 0], [0, 250, 0]], [[0, 0, 250], [250, 250, 0]]], np.uint8)
    """Red, green; blue, yellow."""

    def test_glb_texture_lies_upright_on_the_relief(self, tmp_path: Path):
        picture = np.kron(self.COLOURS, np.ones((40, 60, 1), np.uint8))
        sample = work(rough(32, 48), 0.06, "F", picture=picture)
        (path,) = Glb().write(sample, tmp_path / "g")
        mesh = read_glb(path)
        texture = np.asarray(mesh.visual.material.baseColorTexture).astype(int)
        across, up = np.asarray(mesh.visual.uv).T
        column, row = across * (texture.shape[1] - 1e-3), (1 - up) * (texture.shape[0] - 1e-3)  # trimesh's v runs up
        solid = read(path)
        x, y = solid.vertices[:, :2].T
        across, down = (x - RIM_MM) / 60, 1 - (y - RIM_MM - BAND_MM) / 40
        for i, j in np.ndindex(2, 2):
            inside = (np.abs(across - (0.25 + 0.5 * j)) < 0.24) & (np.abs(down - (0.25 + 0.5 * i)) < 0.24)
            seen = texture[row[inside].astype(int), column[inside].astype(int)]
            assert len(seen) > 10 and np.abs(seen - self.COLOURS[i, j]).max() < 40  # a JPEG rings
        rim = (x > 0) & (y > 0) & (y < RIM_MM + BAND_MM - 2)  # its braille
        assert np.abs(texture[row[rim].astype(int), column[rim].astype(int)] - 225).max() < 6
        edge = np.isclose(x, RIM_MM, atol=1e-3)  # exactly where the picture begins
        assert np.ptp(column[edge]) < 1e-3 and column[edge][0] == pytest.approx(round(column[edge][0]), abs=2e-2)

    def test_glb_of_heights_has_no_texture(self, tmp_path: Path):
        (path,) = Glb(braille=False).write(work(rough(), 0.05, "Höhen \ud800"), tmp_path / "g")
        data = path.read_bytes()
        head = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
        assert "images" not in head and "textures" not in head and len(head["accessors"]) == 2
        assert head["nodes"][0]["name"] == head["meshes"][0]["name"] == "Höhen \ud800"
        assert int.from_bytes(data[8:12], "little") == len(data)
        assert read_glb(path).is_volume

    def test_glb_chunks_are_whole_words(self, tmp_path: Path):
        for title in ("a", "bc", "def", "ghij"):
            (path,) = Glb(braille=False).write(work(rough(8, 9), 0.05, title), tmp_path / "g")
            data = path.read_bytes()
            length = int.from_bytes(data[12:16], "little")
            assert (length % 4, data[24 + length : 28 + length]) == (0, b"BIN\0")


def judge(program: str) -> Callable[..., str]:
    """A program of Debian's that reads solids."""
    if shutil.which(program) is None:
        lacking(f"{program} is not installed: apt-get install {program}")

    def run(*words: object, cwd: Path) -> str:
        ran = subprocess.run([program, *map(str, words)], cwd=cwd, capture_output=True, text=True, timeout=120)
        assert ran.returncode == 0, ran.stdout + ran.stderr
        return ran.stdout

    return run


def test_stl_needs_no_repair_by_admesh(tmp_path: Path):
    admesh = judge("admesh")
    Stl().write(work(rough(), 0.05, "Coffee"), tmp_path / "a")
    output = admesh("a.stl", cwd=tmp_path)
    words = ("Degenerate", "Edges fixed", "Facets removed", "Facets added", "Facets reversed", "Backwards", "Normals f")
    repairs = [line.split(":")[:2] for line in output.splitlines() if line.startswith(words)]
    counts = {name.strip(): int(value) for name, value in repairs}
    assert len(counts) == 7 and not any(counts.values()), output


@pytest.mark.whole
@pytest.mark.parametrize("name", ["stl", "3mf"])
def test_solid_is_manifold_for_a_slicer(tmp_path: Path, name: str):
    slicer = judge("prusa-slicer")
    mesh: Mesh = write_and_read(FORMATS[name](), work(rough(), 0.05, "Coffee"), tmp_path)
    output = slicer("--info", f"solid.{name}", cwd=tmp_path)
    values = dict(line.split(" = ") for line in output.splitlines() if " = " in line)
    assert values["manifold"] == "yes" and int(values["number_of_parts"]) == 1
    sizes = [float(values[f"size_{axis}"]) for axis in "xyz"]
    assert sizes == pytest.approx(np.ptp(mesh.vertices, axis=0).tolist(), abs=1e-3)

"""STL, 3MF and GLB, read by what did not write them."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from needed import lacking
from solids import (
    FORMATS,
    LETTER_F,
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
    written,
)
from tangible_core import Pipeline, Scene
from tangible_core.data import Work
from tangible_core.errors import BrailleError, GeometryError, OutputError
from tangible_core.plugins.interfaces import Exporter
from tangible_core.plugins.notes import collected
from tangible_depth import Luminance
from tangible_export import Glb, Stl, ThreeMF
from tangible_export.solid import making

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


@EVERY
@pytest.mark.parametrize("title", ["Coffee", ""])
def test_the_solid_is_closed_and_of_its_size(tmp_path: Path, cls: type[Exporter], title: str, mesher: str):
    made = work(rough(), 0.05, title)
    mesh = written(cls(), made, tmp_path)
    assert is_closed(mesh)
    length = 50 * 40 / 56 + 2 * RIM_MM + (BAND_MM if title else 0)
    assert mesh.vertices.min(axis=0).tolist() == pytest.approx([0, 0, 0], abs=1e-6)
    assert mesh.vertices[:, :2].max(axis=0).tolist() == pytest.approx([62, length], abs=1e-3)
    assert mesh.vertices[:, 2].max() == pytest.approx(1.5 + 1000 * made.relief.height_m.max(), abs=0.05)
    below = 1.5 * 62 * length
    assert below < volume(mesh) < below + 50**2 * 7


@pytest.mark.parametrize("error_mm", [0.3, 0.05, 0.01])
def test_every_node_is_within_the_error(tmp_path: Path, error_mm: float):
    made = work(rough(), 0.05, "F")
    mesh = written(Stl(error_m=error_mm / 1000), made, tmp_path)
    heights = from_above(mesh, *nodes(made, RIM_MM, RIM_MM + BAND_MM))
    off = np.abs(heights[::-1] - 1.5 - 1000 * made.relief.height_m)
    assert off.max() <= error_mm
    assert off.max() > error_mm / 2 or error_mm < 0.05, "fewer triangles would do"


def test_cliffs_keep_the_error_where_floating_point_is_coarse(tmp_path: Path):
    """A coordinate that is rounded by so little as STL does it tells on a cliff of 8 mm."""
    cliffs = 0.004 * np.random.default_rng(2).integers(0, 3, (6, 700)) + 1e-5 * np.random.default_rng(3).random(
        (6, 700)
    )
    made = work(cliffs, 0.12)
    mesh = written(Stl(error_m=5e-6, rim_m=0.1, corner_mark=False, braille=False), made, tmp_path)
    off = from_above(mesh, *nodes(made, 100, 100))[::-1] - 1.5 - 1000 * made.relief.height_m
    assert np.abs(off).max() <= 0.005


def test_without_pydelatin_every_node_is_met(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    without_pydelatin(monkeypatch)
    made = work(rough(), 0.05)
    with collected() as notes:
        mesh = written(bare(ThreeMF), made, tmp_path)
    assert any("pydelatin is not installed" in each and "tangible-images[export]" in each for each in notes)
    heights = from_above(mesh, *nodes(made))
    assert np.abs(heights[::-1] - 1.5 - 1000 * made.relief.height_m).max() < 5e-4


@EVERY
def test_an_f_reads_as_an_f_from_above(tmp_path: Path, cls: type[Exporter]):
    made = work(0.002 * np.kron(LETTER_F, np.ones((5, 5))), title="F")
    mesh = written(cls(), made, tmp_path)
    heights = from_above(mesh, *nodes(made, RIM_MM, RIM_MM + BAND_MM))[::-1]  # row 0 at the back, as on a desk
    assert ((heights - 1.5 > 1)[2::5, 2::5] == LETTER_F).all()


@EVERY
def test_the_sides_of_the_picture_stand_upright_and_the_rim_is_flat(tmp_path: Path, cls: type[Exporter]):
    mesh = written(cls(), work(np.full((8, 8), 0.003)), tmp_path)
    x = np.array([1, 3, 5.99, 6.01, 16, 25.99, 26.01, 31])
    heights = from_above(mesh, x, np.array([3.0, 16]))
    assert heights[0] == pytest.approx(1.5)
    assert heights[1] == pytest.approx([1.5] * 3 + [4.5] * 3 + [1.5] * 2)


@pytest.mark.parametrize("shape", [(1, 1), (1, 2), (2, 1), (1, 300), (300, 1), (2, 2), (3, 3)])
def test_odd_sizes_are_solids_too(tmp_path: Path, shape: tuple[int, int], mesher: str):
    heights = np.random.default_rng(1).uniform(0.001, 0.004, shape)
    made = work(heights, 0.03 if shape[1] > 1 else 0.01)
    mesh = written(bare(Stl), made, tmp_path)
    assert is_closed(mesh) and volume(mesh) > 0
    assert mesh.vertices.max(axis=0)[:2] == pytest.approx([1000 * side for side in made.relief.extent_m], abs=1e-3)
    off = from_above(mesh, *nodes(made))[::-1] - 1.5 - 1000 * made.relief.height_m
    assert np.abs(off).max() <= 0.05


def test_cells_need_not_be_square(tmp_path: Path):
    tall = work(rough(30, 20), 0.02)
    relief = replace(tall.relief, extent_m=(0.02, 0.09))
    mesh = written(bare(Stl), replace(tall, products={"relief": relief}), tmp_path)
    assert is_closed(mesh)
    assert mesh.vertices.max(axis=0)[:2] == pytest.approx([20, 90], abs=1e-3)


@EVERY
@pytest.mark.parametrize("height_mm", [0, 0.05])
def test_a_relief_of_no_height_is_one_clear_line(tmp_path: Path, cls: type[Exporter], height_mm: float):
    with pytest.raises(GeometryError, match=r"the relief is [\d.]+ mm high.*nothing would be felt") as told:
        cls().write(work(np.full((9, 9), height_mm / 1000)), tmp_path / "flat")
    assert "\n" not in str(told.value) and not list(tmp_path.iterdir())


@EVERY
def test_the_same_again_is_the_same_bytes(tmp_path: Path, cls: type[Exporter]):
    made = work(rough(), 0.05, "Coffee", picture=np.zeros((40, 56, 3), np.uint8))
    (one,), (two,) = cls().write(made, tmp_path / "one"), cls().write(made, tmp_path / "a.b")
    assert one.read_bytes() == two.read_bytes()
    assert two.name == f"a.b{one.suffix}"


@EVERY
@pytest.mark.parametrize(("aspect", "width_m"), [(2.0, 0.12), (0.5, 0.06)])
def test_the_longer_side_is_as_long_as_it_is_said(cls: type[Exporter], aspect: float, width_m: float):
    assert cls.model_validate({"longer_side_m": "12 cm"}).picture_width_m(aspect) == pytest.approx(width_m)


def test_a_pipeline_makes_the_relief_as_wide_as_the_print(tmp_path: Path):
    photo = (255 * np.random.default_rng(0).random((30, 60))).astype(np.uint8)
    done = Pipeline(Scene.of(photo=photo), depth=Luminance()).export(tmp_path, [Stl(longer_side_m=0.1, braille=False)])
    ((path,),) = done.files.values()
    assert read(path).vertices.max(axis=0)[:2] == pytest.approx([112, 62], abs=1e-3)


class TestBraille:
    def test_each_dot_is_an_island_of_its_size_at_its_place(self, tmp_path: Path):
        """`a`, then `l`: dot 1, and dots 1 to 3 a cell further."""
        from scipy.ndimage import label

        mesh = written(Stl(), work(np.full((9, 9), 0.002), title="al"), tmp_path)
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

    def test_a_long_title_takes_lines_that_reach_no_further_than_the_picture(self, tmp_path: Path):
        short, long = (work(np.full((9, 9), 0.002), 0.06, title) for title in ("coffee", "coffee milk " * 2))
        with collected() as notes:
            meshes = [written(Stl(), each, tmp_path) for each in (short, long)]
        assert any("4 lines" in each for each in notes)
        lengths = [mesh.vertices[:, 1].max() for mesh in meshes]
        assert lengths[1] - lengths[0] == pytest.approx(30)
        assert all(is_closed(mesh) for mesh in meshes)
        x, y = np.arange(0, 72, 0.2), np.arange(0, lengths[1] - 60 - RIM_MM - 2.6, 0.2)
        raised = from_above(meshes[1], x, y) > 1.6
        assert raised[:, (x > RIM_MM) & (x < 66)].sum() == raised.sum() > 100

    @pytest.mark.parametrize(
        ("title", "error", "told"),
        [
            ("word " * 40, OutputError, "takes 20 lines of braille of 60 mm; a plate has 6"),
            ("猫", BrailleError, "猫"),
            ("a\x07", BrailleError, r"\\x07"),
        ],
    )
    def test_a_title_that_cannot_be_written_is_one_line(self, tmp_path: Path, title: str, error: Any, told: str):
        made = work(np.full((9, 9), 0.002), 0.06, title)
        with pytest.raises(error, match=told) as raised:
            ThreeMF().write(made, tmp_path / "x")
        assert "\n" not in str(raised.value) and not list(tmp_path.iterdir())
        assert ThreeMF(braille=False).write(made, tmp_path / "x")

    def test_a_picture_that_is_too_narrow_for_it_says_what_helps(self, tmp_path: Path):
        made = work(np.full((9, 9), 0.002), 0.016, "I")
        with pytest.raises(OutputError, match=r"16 mm wide, too narrow .* longer_side_m larger, or say braille: false"):
            Stl().write(made, tmp_path / "x")
        assert Stl().write(replace(made, title=""), tmp_path / "x")

    def test_its_language_may_be_another_than_the_title_s(self, tmp_path: Path):
        made = work(np.full((9, 9), 0.002), 0.06, "Öl", language="de-AT")
        files = [
            cls.write(made, tmp_path / name)[0].read_bytes()
            for name, cls in (("a", Stl()), ("b", Stl(braille_language="en")), ("c", Stl(braille_language="de")))
        ]
        assert files[0] == files[2] != files[1]


class TestRim:
    def test_the_corner_mark_is_a_triangle_at_the_upper_right(self, tmp_path: Path):
        mesh = written(Stl(rim_m=0.01), work(np.full((9, 9), 0.002)), tmp_path)
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

    @pytest.mark.parametrize("rim_mm", [0, 0.05, 1, 3.9, 30])
    def test_a_rim_of_any_width_closes(self, tmp_path: Path, rim_mm: float):
        made = work(rough(), 0.05, "Coffee")
        with collected() as notes:
            mesh = written(Stl(rim_m=rim_mm / 1000), made, tmp_path)
        assert is_closed(mesh)
        assert any("no room for the title and the corner mark" in each for each in notes) == (rim_mm < 4)
        wide = 50 + 2 * (rim_mm if rim_mm > 0.1 else 0)
        assert mesh.vertices[:, 0].max() == pytest.approx(wide, abs=1e-3)

    def test_none_of_it_is_asked_for_and_nothing_is_said(self, tmp_path: Path):
        with collected() as notes:
            written(bare(Stl), work(np.full((9, 9), 0.002), title="Coffee"), tmp_path)
        assert len(notes) == 1 and notes[0].startswith("the plate is 20.0 x 20.0 x 3.5 mm, of")


class TestNotes:
    @staticmethod
    def of(exporter: Exporter, made: Work, folder: Path) -> str:
        with collected() as notes:
            exporter.write(made, folder / "noted")
        return "\n".join(notes)

    def test_a_thin_base_and_a_large_plate(self, tmp_path: Path):
        made = work(np.full((9, 9), 0.002), 0.3)
        assert "a base of 0.7 mm bends" in self.of(Stl(base_m=0.0007), made, tmp_path)
        assert "the plate is 312 mm long" in self.of(Stl(), made, tmp_path)
        assert "a base" not in self.of(Stl(base_m=0.0008), work(np.full((9, 9), 0.002)), tmp_path)

    @pytest.mark.parametrize(("cells", "said"), [(1, True), (3, True), (4, False), (6, False)])
    @pytest.mark.parametrize("pitch_mm", [0.1, 0.13])
    def test_what_is_thinner_than_a_nozzle(self, tmp_path: Path, cells: int, said: bool, pitch_mm: float):
        heights = np.full((80, 80), 0.001)
        heights[20:60, 40 : 40 + cells] = 0.003
        told = self.of(Stl(braille=False), work(heights, 80 * pitch_mm / 1000), tmp_path)
        assert ("thinner than a nozzle" in told) == said
        if said:
            assert "up to 2 mm high" in told and f"{40 * cells * pitch_mm**2:.1f} square mm" in told

    def test_a_slope_is_not_thin(self, tmp_path: Path):
        """Kernels of an even side have no middle: a slope is off by a node, if they are laid askew."""
        up = np.linspace(0, 0.01, 60)
        roof = np.tile(np.concatenate([up, up[::-1]]), (120, 1))
        for each in (roof, roof.T):
            assert "thinner" not in self.of(Stl(), work(each, 120 * 0.0003), tmp_path)

    @pytest.mark.parametrize(("steepness", "said"), [(0.9, False), (1.1, True)])
    def test_what_is_steeper_than_45_degrees(self, tmp_path: Path, steepness: float, said: bool):
        heights = np.zeros((40, 40))
        heights[:, 20:30] = np.arange(10) * steepness * 0.0005
        heights[:, 30:] = heights[:, 29:30]
        told = self.of(Stl(), work(heights, 0.02), tmp_path)
        assert ("% of the picture is steeper than 45 degrees: print the plate lying flat" in told) == said
        assert not said or "24 %" in told or "23 %" in told

    def test_noise_does_not_make_a_gigantic_file(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
        monkeypatch.setattr(making, "MOST_TRIANGLES", 500)
        made = work(rough(), 0.05)
        with collected() as notes:
            mesh = written(bare(Stl), made, tmp_path)
        off = np.abs(from_above(mesh, *nodes(made))[::-1] - 1.5 - 1000 * made.relief.height_m).max()
        assert is_closed(mesh) and len(mesh.triangles) < 1000
        assert any(f"the solid is off by up to {off:.2g} mm, as it would take more than 500" in each for each in notes)

    def test_more_nodes_than_there_is_room_for_are_averaged(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
        monkeypatch.setattr(making, "MOST_IN_GRID", 500)
        without_pydelatin(monkeypatch)
        made = work(rough(), 0.05)
        with collected() as notes:
            mesh = written(bare(Stl), made, tmp_path)
        assert any("heights are averaged over squares of 2 mm" in each and "pip install" in each for each in notes)
        assert is_closed(mesh) and len(mesh.triangles) < 1500
        assert mesh.vertices.max(axis=0)[:2] == pytest.approx([50, 50 * 40 / 56], abs=1e-3)


class TestThreeMF:
    def test_lib3mf_finds_millimetres_and_a_title_whatever_it_holds(self, tmp_path: Path):
        title = 'Kaffee & <Kuchen> "Ü" \x07\ud800\ufffe🍰'
        made = work(rough(), 0.05, title, language='de"><x/>')
        (path,) = ThreeMF(braille=False).write(made, tmp_path / "k")
        model, (body,) = read_3mf(path)
        assert model.GetUnit().name == "MilliMeter"
        assert body.GetName() == 'Kaffee & <Kuchen> "Ü" 🍰'
        assert body.IsManifoldAndOriented()
        assert model.GetBuildItems().Count() == 1

    def test_it_is_far_smaller_than_an_stl(self, tmp_path: Path):
        made = work(rough(80, 100), 0.1)
        sizes = [cls().write(made, tmp_path / "s")[0].stat().st_size for cls in (ThreeMF, Stl)]
        assert sizes[0] < sizes[1] / 2


class TestGlb:
    COLOURS = np.array([[[250, 0, 0], [0, 250, 0]], [[0, 0, 250], [250, 250, 0]]], np.uint8)
    """Red, green; blue, yellow."""

    def test_the_picture_lies_on_the_relief_the_right_way_up(self, tmp_path: Path):
        picture = np.kron(self.COLOURS, np.ones((40, 60, 1), np.uint8))
        made = work(rough(32, 48), 0.06, "F", picture=picture)
        (path,) = Glb().write(made, tmp_path / "g")
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

    @pytest.mark.parametrize("shape", [(7, 9), (7, 9, 3), (7, 9, 4), (1, 1), (5000, 20, 3)])
    def test_any_picture_is_a_texture(self, tmp_path: Path, shape: tuple[int, ...]):
        made = work(rough(8, 9), 0.06, picture=np.full(shape, 200, np.uint8))
        mesh = read_glb(Glb().write(made, tmp_path / "g")[0])
        assert max(np.asarray(mesh.visual.material.baseColorTexture).shape) <= 4096

    def test_a_scene_of_heights_has_no_texture(self, tmp_path: Path):
        (path,) = Glb(braille=False).write(work(rough(), 0.05, "Höhen \ud800"), tmp_path / "g")
        data = path.read_bytes()
        head = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
        assert "images" not in head and "textures" not in head and len(head["accessors"]) == 2
        assert int.from_bytes(data[8:12], "little") == len(data)
        assert read_glb(path).is_volume

    def test_it_lies_in_metres_about_its_middle(self, tmp_path: Path):
        (path,) = Glb().write(work(rough(), 0.05), tmp_path / "g")
        low, high = read_glb(path).bounds
        assert low[[0, 2]] == pytest.approx(-high[[0, 2]], abs=1e-7) and low[1] == 0
        assert high[0] == pytest.approx(0.031, abs=1e-6)


@EVERY
def test_trimesh_finds_a_volume(tmp_path: Path, cls: type[Exporter]):
    mesh = trimesh.Trimesh(*written(cls(), work(rough(), 0.05, "Coffee"), tmp_path))
    assert mesh.is_watertight and mesh.is_winding_consistent and mesh.is_volume and mesh.euler_number == 2


def judge(program: str) -> Callable[..., str]:
    """A program of Debian's that reads solids."""
    if shutil.which(program) is None:
        lacking(f"{program} is not installed: apt-get install {program}")

    def run(*words: object, cwd: Path) -> str:
        ran = subprocess.run([program, *map(str, words)], cwd=cwd, capture_output=True, text=True, timeout=120)
        assert ran.returncode == 0, ran.stdout + ran.stderr
        return ran.stdout

    return run


def test_admesh_repairs_nothing(tmp_path: Path):
    admesh = judge("admesh")
    Stl().write(work(rough(), 0.05, "Coffee"), tmp_path / "a")
    told = admesh("a.stl", cwd=tmp_path)
    counts = {name.strip(): int(value) for name, value in (line.split(":")[:2] for line in repairs(told))}
    assert len(counts) == 7 and not any(counts.values()), told


def repairs(told: str) -> list[str]:
    words = ("Degenerate", "Edges fixed", "Facets removed", "Facets added", "Facets reversed", "Backwards", "Normals f")
    return [line for line in told.splitlines() if line.startswith(words)]


@pytest.mark.parametrize("name", ["stl", "3mf"])
def test_a_slicer_finds_it_manifold_and_of_its_size(tmp_path: Path, name: str):
    slicer = judge("prusa-slicer")
    mesh: Mesh = written(FORMATS[name](), work(rough(), 0.05, "Coffee"), tmp_path)
    told = slicer("--info", f"solid.{name}", cwd=tmp_path)
    said = dict(line.split(" = ") for line in told.splitlines() if " = " in line)
    assert said["manifold"] == "yes" and int(said["number_of_parts"]) == 1
    sizes = [float(said[f"size_{axis}"]) for axis in "xyz"]
    assert sizes == pytest.approx(np.ptp(mesh.vertices, axis=0).tolist(), abs=1e-3)

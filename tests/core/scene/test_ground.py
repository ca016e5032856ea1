"""If one of these fails, a map of heights is felt out of its proportions or its scale."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile

from tangible_core import Pipeline, Scene, Workspace
from tangible_core.errors import ConfigError, GeometryError
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.plugins.registry import default_registry
from tangible_core.scene.formats.ground import read_ground

ROWS, COLUMNS = 32, 48
HEIGHTS = np.linspace(100, 200, ROWS * COLUMNS).reshape(ROWS, COLUMNS).astype(np.float32)
PIXEL_SCALE, TIE_POINT, MATRIX, KEYS = 33550, 33922, 34264, 34735
GEOGRAPHIC = [1024, 0, 1, 2]
FEET, METRES, VERTICAL_FEET = [3076, 0, 1, 9002], [3076, 0, 1, 9001], [4099, 0, 1, 9002]


def geotiff(path: Path, across: float, down: float, *keys: list[int], top: float | None = None, **options: Any) -> Path:
    tags: list[tuple[Any, ...]] = [(PIXEL_SCALE, "d", 3, (across, down, 0.0), True)]
    if top is not None:
        tags.append((TIE_POINT, "d", 6, (0.0, 0.0, 0.0, 10.0, top, 0.0), True))
    if keys:
        directory = [1, 1, 0, len(keys), *(number for key in keys for number in key)]
        tags.append((KEYS, "H", len(directory), directory, True))
    tifffile.imwrite(path, HEIGHTS, extratags=tags, **options)
    return path


def relief_of(scene: Scene, **workspace: Any):
    return Pipeline(scene, workspace=Workspace(**workspace), cached=False).relief


class TestCells:
    def test_cells_of_5_by_10_metres_are_felt_in_their_proportions(self, tmp_path: Path):
        scene = Scene.heights(geotiff(tmp_path / "dem.tif", 5, 10))
        relief = relief_of(scene, width_m=0.08, relief_m=0.01)
        assert relief.extent_m == pytest.approx((0.08, 0.32 / 3))  # 240 x 320 m
        assert relief.height_m.shape == HEIGHTS.shape and relief.height_m.max() == np.float32(0.01)

    @pytest.mark.parametrize("byteorder", ["<", ">"])
    @pytest.mark.parametrize("latitude", [0, 60, -60, 80])
    def test_degrees_are_narrower_by_the_cosine_of_the_latitude(self, tmp_path: Path, latitude: float, byteorder: str):
        second = 1 / 3600
        top = latitude + second * ROWS / 2
        path = geotiff(tmp_path / "srtm.tif", second, second, GEOGRAPHIC, top=top, byteorder=byteorder)
        ground = read_ground(path)
        assert ground.cell_m[1] == pytest.approx(30.9, abs=0.05)  # a 60th of a nautical mile, 1852 m
        assert ground.cell_m[0] / ground.cell_m[1] == pytest.approx(math.cos(math.radians(latitude)))
        width_m, length_m = relief_of(Scene.heights(path), width_m=0.08).extent_m
        assert width_m / length_m == pytest.approx(COLUMNS / ROWS * math.cos(math.radians(latitude)))

    def test_cells_are_metres_of_the_ground_in_web_maps_feet_and_matrices(self, tmp_path: Path):
        """At 60 degrees north, northing 8399737.9 m, a web map is drawn twice as large as the ground is."""
        path = geotiff(tmp_path / "tile.tif", 100, 100, [1024, 0, 1, 1], [3072, 0, 1, 3857], top=8399737.9 + 1600)
        assert read_ground(path).cell_m == pytest.approx((50, 50), rel=1e-4)
        ground = read_ground(geotiff(tmp_path / "dem.tif", 100, 100, FEET, VERTICAL_FEET))
        assert ground.cell_m == pytest.approx((30.48, 30.48)) and ground.unit_m == 0.3048
        ground = read_ground(geotiff(tmp_path / "dem.tif", 100, 100, METRES))
        assert ground.cell_m == (100, 100) and ground.unit_m == 1
        matrix = (0.0, 10, 0, 1000, -5, 0, 0, 2000, 0, 0, 0, 0, 0, 0, 0, 1)
        tifffile.imwrite(tmp_path / "dem.tif", HEIGHTS, extratags=[(MATRIX, "d", 16, matrix, True)])
        assert read_ground(tmp_path / "dem.tif").cell_m == pytest.approx((5, 10))

    @pytest.mark.parametrize("scale", [(0, 10), (-5, 10), (math.nan, 1), (math.inf, 1)])
    def test_cells_of_no_size_are_unknown(self, tmp_path: Path, scale: tuple[float, float]):
        path = geotiff(tmp_path / "dem.tif", *scale)
        assert read_ground(path) is None or min(read_ground(path).cell_m) > 0
        assert relief_of(Scene.heights(path), width_m=0.08).extent_m[0] == 0.08

    @pytest.mark.parametrize(
        ("head", "cell_m"),
        [
            ("cellsize 25", (25, 25)),
            ("dx 5\ndy 10", (5, 10)),
            ("CELLSIZE 0.000277777", (15.45, 30.89)),
            ("cellsize 0", None),
        ],
    )
    def test_esri_grid_states_its_cells(self, tmp_path: Path, head: str, cell_m: tuple[float, float] | None):
        text = f"ncols 3\nnrows 2\nxllcorner 10.0\nyllcorner 60.0\n{head}\nNODATA_value -9999\n1 2 3\n4 5 6\n"
        (tmp_path / "dem.asc").write_text(text)
        ground = read_ground(tmp_path / "dem.asc")
        assert (ground and ground.cell_m) == (cell_m and pytest.approx(cell_m, abs=0.01))
        assert ground is None or ground.shape == (2, 3)

    @pytest.mark.parametrize(("name", "latitude"), [("N60E010", 60.5), ("s34w071", -33.5), ("noplace", None)])
    def test_srtm_states_its_place_by_its_name(self, tmp_path: Path, name: str, latitude: float | None):
        (tmp_path / f"{name}.hgt").write_bytes(np.zeros((121, 121), ">i2").tobytes())
        ground = read_ground(tmp_path / f"{name}.hgt")
        assert (ground is None) == (latitude is None)
        if ground is not None and latitude is not None:
            assert ground.cell_m[1] == pytest.approx(926.6, abs=1)  # half a nautical mile
            assert ground.cell_m[0] / ground.cell_m[1] == pytest.approx(math.cos(math.radians(latitude)))
            assert ground.shape == (121, 121)

    @pytest.mark.parametrize("place", ["ulxmap 10\nulymap 60.02\n", "xllcorner 10\nyllcorner 59.98\n"])
    def test_header_beside_a_binary_grid_states_its_cells(self, tmp_path: Path, place: str):
        (tmp_path / "dem.flt").write_bytes(np.zeros((4, 3), "<f4").tobytes())
        (tmp_path / "dem.hdr").write_text(f"nrows 4\nncols 3\nbyteorder I\nxdim 0.005\nydim 0.01\n{place}")
        cell_m = read_ground(tmp_path / "dem.flt").cell_m
        assert cell_m[0] / cell_m[1] == pytest.approx(0.25, abs=1e-3)  # half, and cos(60 degrees)
        assert Scene.heights(tmp_path / "dem.flt").measured[1] == pytest.approx(4 * 1112, rel=0.001)

    def test_other_files_and_none_have_no_ground(self, tmp_path: Path):
        tifffile.imwrite(tmp_path / "plain.tif", HEIGHTS)
        (tmp_path / "cut.tif").write_bytes((tmp_path / "plain.tif").read_bytes()[:100])
        (tmp_path / "empty.tif").write_bytes(b"")
        np.save(tmp_path / "map.npy", HEIGHTS)
        assert [read_ground(tmp_path / n) for n in ("plain.tif", "cut.tif", "empty.tif", "map.npy", "no")] == 5 * [None]
        assert relief_of(Scene.heights(HEIGHTS), width_m=0.06).extent_m == pytest.approx((0.06, 0.04))

    @pytest.mark.parametrize("rotate", [0, 90, 180, 270])
    @pytest.mark.parametrize("crop", [None, (8, 2, 12, 20)])
    def test_part_of_a_turned_map_keeps_its_proportions(self, tmp_path: Path, rotate, crop):
        scene = Scene.heights(geotiff(tmp_path / "dem.tif", 5, 10), rotate=rotate, crop=crop)
        width_m, length_m = (240, 320) if crop is None else (60, 200)
        sides = (width_m, length_m) if rotate in (0, 180) else (length_m, width_m)
        assert scene.measured[:2] == pytest.approx(sides)
        extent_m = relief_of(scene, width_m=0.08).extent_m
        assert extent_m[0] / extent_m[1] == pytest.approx(sides[0] / sides[1])

    @pytest.mark.parametrize(("cell_m", "sides"), [(30, (1440, 960)), ([5, 10], (240, 320))])
    def test_cells_can_be_given_for_files_and_arrays(self, tmp_path: Path, cell_m: Any, sides: tuple[float, float]):
        np.save(tmp_path / "map.npy", HEIGHTS)
        for heights in (tmp_path / "map.npy", HEIGHTS, geotiff(tmp_path / "dem.tif", 2, 2)):
            assert Scene.heights(heights, cell_m=cell_m).measured[:2] == pytest.approx(sides)


class TestScale:
    def test_scale_gives_width_and_heights_of_the_ground(self, tmp_path: Path):
        """240 x 320 m with 100 m of height, at 1:2000: 120 x 160 mm, 50 mm high."""
        scene = Scene.heights(geotiff(tmp_path / "dem.tif", 5, 10))
        relief = relief_of(scene, scale="1:2000")
        assert relief.extent_m == pytest.approx((0.12, 0.16))
        np.testing.assert_allclose(relief.height_m, (HEIGHTS - 100) / 2000, atol=1e-8)
        scene = Scene.heights(geotiff(tmp_path / "dem.tif", 5, 10, METRES, VERTICAL_FEET))
        relief = relief_of(scene, scale="1:2000", exaggeration=2)
        assert relief.extent_m == pytest.approx((0.12, 0.16))
        np.testing.assert_allclose(relief.height_m, (HEIGHTS - 100) * 0.3048 * 2 / 2000, atol=1e-8)

    def test_tiles_of_one_range_fit_together(self):
        workspace = {"scale": "1:10000", "exaggeration": 3, "low_m": 90}
        whole = relief_of(Scene.heights(HEIGHTS, cell_m=10), **workspace)
        halves = [relief_of(Scene.heights(part, cell_m=10), **workspace) for part in (HEIGHTS[:16], HEIGHTS[16:])]
        np.testing.assert_allclose(np.concatenate([half.height_m for half in halves]), whole.height_m, atol=1e-8)
        assert whole.extent_m[0] == halves[0].extent_m[0] and whole.height_m.min() == pytest.approx(0.003)

    def test_range_without_a_scale_spans_the_relief_and_heights_beyond_are_told(self):
        relief = relief_of(Scene.heights(HEIGHTS), relief_m=0.01, low_m=0, high_m=400)
        np.testing.assert_allclose(relief.height_m, HEIGHTS / 400 * 0.01, atol=1e-8)
        pipeline = Pipeline(Scene.heights(HEIGHTS), workspace=Workspace(low_m=125, high_m=150), cached=False)
        assert np.mean(pipeline.relief.height_m == 0) == pytest.approx(0.25, abs=0.01)
        assert "75 % of the heights are beyond low_m or high_m" in next(
            one.why for one in pipeline.outcomes if one.product == "relief"
        )

    @pytest.mark.parametrize(
        ("scene", "workspace", "sentence"),
        [
            ("{height: map.npy}", "{scale: 1:2000}", "workspace.scale: the map does not state"),
            ("builtin/coins", "{scale: 1:2000}", "workspace.scale: is for a map of heights"),
            ("builtin/coins", "{low_m: 3}", "workspace.low_m: is for a map of heights"),
            ("{height: dem.tif}", "{scale: 2000}", "workspace.scale: Input should be a scale"),
            ("{height: dem.tif}", "{scale: 1:0}", "Input should be a scale"),
            ("{height: dem.tif}", "{scale: 1:10}", "24 m wide"),
            ("{height: dem.tif}", "{scale: 1:2000, width_m: 0.1}", "already gives the size"),
            ("{height: dem.tif, relief_m: 0.01}", "{scale: 1:2000}", "already gives the height"),
            ("{height: dem.tif}", "{exaggeration: 2}", "needs scale"),
            ("{height: dem.tif}", "{low_m: 5, high_m: 5}", "low_m is less than high_m"),
            ("{height: map.npy, invert: true}", "{low_m: 90}", "`invert`"),
            ("{photo: a.png, cell_m: 3}", "{}", "needs height"),
            ("{height: none.npy, cell_m: 3}", "{scale: 1:2000}", "no such file"),
        ],
    )
    def test_what_cannot_be_is_refused_in_a_sentence(self, tmp_path: Path, scene: str, workspace: str, sentence: str):
        geotiff(tmp_path / "dem.tif", 5, 10)
        np.save(tmp_path / "map.npy", HEIGHTS)
        text = f"scene: {scene}\nworkspace: {workspace}\n"
        with pytest.raises(ConfigError) as caught:
            parse_config(text, tmp_path / "p.yaml", default_registry())
        [said] = caught.value.args
        assert sentence in said

    def test_relief_of_more_than_a_metre_is_refused(self):
        with pytest.raises(GeometryError, match="10 m high"):
            _ = relief_of(Scene.heights(HEIGHTS * 100, cell_m=10), scale="1:1000")

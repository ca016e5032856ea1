"""Files of a surface for pages: otherwise the screen shows other heights, parts or colours than are felt."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tangible_core import load_method
from tangible_core.data import Material, Relief
from tangible_core.errors import GeometryError, OutputError
from tangible_core.metrics import absolute_error
from tangible_core.pipeline.engine.preview import is_at_hand
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.scene.scene import Scene
from tangible_render.haptic_textures import compile_textures
from tangible_render.haptic_textures.heights import texture_height
from tangible_ui.serving import routes
from tangible_ui.serving.routes import read_window
from tangible_ui.worker.jobs import surface as textures
from tangible_ui.worker.state import WorkerState
from tangible_ui.worker.view import files
from tangible_ui.worker.view.files import KEPT, show
from tangible_ui.worker.view.surface_view import Layer, SurfaceView, make_view

RANDOM = np.random.default_rng(3)
WOOD = Material("wood", 800.0, 1.0, 0.4, 0.3, roughness_m=3e-5, grain_m=6e-4, texture="stochastic", seed=4)
ICE = Material("ice", 900.0, 1.0, 0.05, 0.03, texture="smooth")


def seen(height_m: np.ndarray, **more) -> SurfaceView:
    rows, columns = height_m.shape
    relief = Relief(height_m.astype(np.float32), (0.08, 0.08 * rows / columns))
    plain = SurfaceView("made", "surface", relief, None, (), None, {})
    return replace(plain, **more)


def made(kind: str, name: str):
    return load_method(kind, name)()


def of_photo(picture: np.ndarray) -> Pipeline:
    methods = {kind: made(kind, name) for kind, name in (("depth", "luminance"), ("texture", "gradient"))}
    return Pipeline(Scene.photo(picture), **methods, cached=False)


def array(folder: Path, about: dict, name: str, kind: str, level: int = 0) -> np.ndarray:
    shape = about["levels"][level]["rows"], about["levels"][level]["columns"]
    return np.frombuffer((folder / about["digest"] / name).read_bytes(), kind).reshape(shape)


def blocks(values: np.ndarray, step: int) -> np.ndarray:
    rows, columns = (range(0, side, step) for side in values.shape)
    return np.array([[values[j : j + step, i : i + step].mean(dtype=np.float64) for i in columns] for j in rows])


class TestLevels:
    def test_levels_are_means_or_middles_of_blocks(self):
        values = RANDOM.random((37, 50)).astype(np.float32)
        for level, found in enumerate(files.means(values, 5)):
            np.testing.assert_allclose(found, blocks(values, 2**level), rtol=1e-6)
            assert found.dtype == np.float32
        for shape, count in (((1, 1), 1), ((480, 640), 1), ((4200, 4300), 4), ((1, 70_000), 6), ((600, 601), 2)):
            assert files.count_levels(shape) == count
        labels = RANDOM.integers(0, 9, (13, 21)).astype(np.int32)
        coarse = files.middles(labels, 3)[2]
        assert coarse.shape == (4, 6)
        assert coarse[1, 2] == labels[6, 10]
        assert coarse[3, 5] == labels[12, 20]


class TestShow:
    def test_finest_level_is_the_surface_and_a_coarser_one_its_mean(self, tmp_path: Path):
        height_m = 0.001 + 0.02 * RANDOM.random((700, 900)).astype(np.float32)
        labels = RANDOM.integers(0, 3, (700, 900)).astype(np.int32)
        about = show(seen(height_m, labels=labels, materials=(WOOD, ICE, WOOD)), tmp_path)
        assert [each["step"] for each in about["levels"]] == [1, 2]
        np.testing.assert_array_equal(array(tmp_path, about, "height-0.f32", "<f4"), height_m)
        np.testing.assert_allclose(array(tmp_path, about, "height-1.f32", "<f4", 1), blocks(height_m, 2), rtol=1e-6)
        np.testing.assert_array_equal(array(tmp_path, about, "labels-0.u", "<u2"), labels)
        assert about["labels"] == 3
        assert about["height_m"] == [float(height_m.min()), float(height_m.max())]
        assert [each["name"] for each in about["materials"]] == ["wood", "ice"]
        kinds = np.frombuffer((tmp_path / about["digest"] / "materials.u16").read_bytes(), "<u2")
        assert kinds.tolist() == [0, 1, 0]

    def test_same_view_is_written_once(self, tmp_path: Path):
        plain = seen(np.zeros((3, 4)))
        layer = Layer.of(np.ones((3, 4)), "px")
        changes: tuple[dict, ...] = (
            {"labels": np.zeros((3, 4), np.int32)}, {"picture": np.zeros((3, 4), np.uint8)},
            {"layers": {"a": layer}}, {"layers": {"b": layer}}, {"layers": {"b": layer._replace(high=9)}},
            {"shows": "relief"}, {"name": "b"}, {"names": ("roof",)}, {"names": ("wall",)}, {"materials": (WOOD,)},
            {"relief": Relief(plain.relief.height_m, (0.1, 0.2))},
        )  # fmt: skip
        assert len({each.digest for each in [plain, *(replace(plain, **change) for change in changes)]}) == 12
        first = show(plain, tmp_path)
        before = (tmp_path / plain.digest / "height-0.f32").stat().st_mtime_ns
        assert show(seen(np.zeros((3, 4))), tmp_path) == first
        assert (tmp_path / plain.digest / "height-0.f32").stat().st_mtime_ns == before

    def test_full_disk_leaves_nothing_and_is_reported(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
        def full(path: Path, data: object) -> int:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(Path, "write_bytes", full)
        with pytest.raises(OutputError, match="free some space"):
            show(seen(np.zeros((3, 4))), tmp_path)
        assert list(tmp_path.iterdir()) == []

    def test_views_are_as_wide_as_drawn_and_with_few_materials_of_many_labels(self, tmp_path: Path):
        labels = np.arange(65_000, dtype=np.int32).reshape(250, 260)
        about = show(seen(np.zeros((250, 260)), labels=labels, materials=(WOOD, ICE) * 32_500), tmp_path)
        assert about["labels"] == 65_000
        np.testing.assert_array_equal(array(tmp_path, about, "labels-0.u", "<u2"), labels)
        for up, kind, size in ((536, "<u2", 2), (537, "<u4", 4), (5000, "<u4", 4)):  # 65535 and 65536 are the largest
            more = show(seen(np.zeros((250, 260)), labels=labels + up), tmp_path)
            assert more["label_bytes"] == size
            np.testing.assert_array_equal(array(tmp_path, more, "labels-0.u", kind), labels + up)
        layer = Layer.of(np.arange(12.0).reshape(3, 4), "px", (1.0, 9.0))
        grey = np.repeat([[0.0, 0.5, 1.0]], 8, 0).repeat(8, 1)
        about = show(seen(np.zeros((3, 4)), layers={"disparity": layer}, picture=grey), tmp_path)
        assert about["layers"] == {"disparity": {"unit": "px", "low": 1.0, "high": 9.0, "rows": 3, "columns": 4}}
        values = np.frombuffer((tmp_path / about["digest"] / "disparity.f32").read_bytes(), "<f4")
        np.testing.assert_array_equal(values, np.arange(12))
        with Image.open(tmp_path / about["digest"] / "photo.jpg") as picture:
            pixels = np.asarray(picture.convert("L")).astype(int)
        assert pixels.shape == (8, 24)
        np.testing.assert_allclose(pixels[4, [3, 12, 20]], [0, 128, 255], atol=4)

    def test_picture_is_as_large_as_is_drawn_first_and_as_browsers_decode(self, tmp_path: Path):
        """The preview has a million pixels, and 0.4 % more or less by rounding."""
        for size, fine, preview in (
            ((1000, 1000), None, (1000, 1000)),
            ((4096, 200), None, (4096, 200)),
            ((4097, 8), (4097, 8), (4096, 8)),
            ((20_000, 10), (16_384, 8), (4096, 2)),
            ((1500, 1000), (1500, 1000), (1225, 816)),
        ):
            about = show(seen(np.zeros((2, 3)), picture=np.zeros(size[::-1], np.bool_)), tmp_path)
            assert about["fine_photo"] == fine
            for name, wanted in (("photo.jpg", preview), ("photo-fine.jpg", fine)):
                path = tmp_path / about["digest"] / name
                assert path.is_file() == (wanted is not None)
                if wanted:
                    with Image.open(path) as picture:
                        assert picture.size == wanted
        assert len(list(tmp_path.iterdir())) == KEPT, "older views are removed"


class TestLayer:
    def test_layer_spans_most_of_its_values_and_is_reduced(self):
        values = np.linspace(0, 100, 2001, dtype=np.float32).reshape(3, 667)
        values[0, 0] = np.nan
        layer = Layer.of(values, "px")
        assert (layer.low, layer.high) == pytest.approx((0.55, 99.5), abs=0.02)
        np.testing.assert_array_equal(layer.values, values)
        assert Layer.of(np.ones((2000, 2000)), "px").values.shape == (1000, 1000)
        nothing = Layer.of(np.full((2, 2), np.nan), "px")
        assert (nothing.low, nothing.high) == (0, 0)


@pytest.fixture(scope="module")
def pair() -> Scene:
    """A square before a ground, whose disparity is known."""
    picture = (255 * np.random.default_rng(5).random((48, 64))).astype(np.uint8)
    disparity = np.full((48, 64), 3.0, np.float32)
    disparity[16:32, 24:44] = 6.0
    truth = disparity + 0.5
    truth[0, :9] += 20.0  # wrong in three of a thousand places
    return Scene.pair(left=picture, right=np.roll(picture, -3, 1), disparity=disparity, truth=truth)


class TestSee:
    def test_layer_has_its_unit_and_span(self, pair: Scene):
        pipeline = Pipeline(pair, render=made("render", "proxy"), cached=False)
        found = make_view(pipeline, "surface")
        assert (found.shows, set(found.layers)) == ("surface", {"disparity", "confidence", "error"})
        np.testing.assert_array_equal(found.layers["disparity"].values, pair.disparity.disparity_px)
        error_px = absolute_error(pair.disparity.disparity_px, pair.truth)
        np.testing.assert_array_equal(found.layers["error"].values, error_px.astype(np.float32))
        spans = {name: (layer.unit, layer.low, layer.high) for name, layer in found.layers.items()}
        assert spans == {
            "disparity": ("px", 3.0, 6.0),
            "confidence": ("", 0.0, 1.0),
            "error": ("px", 0.0, pytest.approx(np.percentile(error_px, 98))),
        }
        np.testing.assert_array_equal(found.relief.height_m, pipeline.surface.height_m)

    def test_views_without_depth_or_with_other_sizes_have_no_layer(self, pair: Scene):
        pipeline = Pipeline(Scene.photo(np.eye(40)), depth="luminance", relief="edges", cached=False)
        assert pipeline.make("disparity") is not None
        assert make_view(pipeline, "surface").layers == {}
        for truth, span in ((np.full((48, 64), np.nan), (0.0, 0.0)), (np.ones((24, 32)), None), (None, None)):
            there = replace(pair, truth=None if truth is None else truth.astype(np.float32))
            found = make_view(Pipeline(there, cached=False), "disparity").layers.get("error")
            assert (None if found is None else (found.low, found.high)) == span

    def test_segments_are_viewed_flat_with_their_certainty(self):
        picture = np.zeros((40, 60), np.uint8)
        picture[:, 30:] = np.random.default_rng(1).integers(0, 255, (40, 30))
        pipeline = of_photo(picture)
        pipeline.make("segments")
        found = make_view(pipeline, "segments")
        assert (found.shows, found.relief.height_m.max()) == ("segments", 0)
        assert not is_at_hand(pipeline.engine, "relief")
        np.testing.assert_array_equal(found.labels, pipeline.segments.labels)
        picture = np.random.default_rng(1).integers(0, 255, (40, 60)).astype(np.uint8)
        pipeline = of_photo(picture)
        pipeline.make("segments")
        layer = make_view(pipeline, "segments").layers["certainty"]
        assert (layer.unit, layer.low, layer.high) == ("", 0.0, 1.0)
        np.testing.assert_array_equal(layer.values, pipeline.segments.confidence)
        given = Pipeline(Scene.photo(picture, segments=np.zeros((40, 60), np.int32)), cached=False)
        assert make_view(given, "segments").layers == {}

    def test_materials_of_a_view_are_limited_to_the_device(self):
        segments = np.repeat([[0, 1]], 8, 0).repeat(8, 1).astype(np.int32)
        scene = Scene.heights(np.zeros((8, 16)), segments=segments)
        by, law = {"by": {1: "brick", 2: "ice"}}, made("render", "proxy")
        bare = make_view(Pipeline(scene, materials=by, render=law, cached=False), "surface").materials
        device = made("device", "mock")
        held = make_view(Pipeline(scene, materials=by, render=law, device=device, cached=False), "surface").materials
        assert [each.name for each in held] == [each.name for each in bare]
        assert held[0].roughness_m < bare[0].roughness_m


class TestTexture:
    @pytest.fixture
    def digest(self, worker_state: WorkerState) -> str:
        labels = np.repeat([[0, 1]], 30, 0).repeat(20, 1).astype(np.int32)
        labels[20:] = 1  # the near rows
        return show(seen(np.zeros((30, 40)), labels=labels, materials=(WOOD, ICE)), worker_state.folder)["digest"]

    def test_texture_patch_is_what_a_law_renders_and_flat_beyond(self, worker_state: WorkerState, digest: str):
        found = textures.texture_patch(worker_state, digest, -0.004, 0.011, 0.01, 25)
        heights = np.fromfile(worker_state.folder / digest / found["file"], "<f4").reshape(25, 25)
        table = compile_textures((WOOD, ICE))
        for row, column in [(0, 0), (12, 3), (24, 9), (7, 20), (24, 24)]:
            x, y = -0.004 + ((column + 0.5) / 25 - 0.5) * 0.01, 0.011 - ((row + 0.5) / 25 - 0.5) * 0.01
            wanted = texture_height(table, int(x >= 0), x, y, 0.0, 0.0, 1e-3)[0]
            assert heights[row, column] == pytest.approx(wanted, abs=1e-10)
        assert np.abs(heights[:, :20]).max() > 1e-5
        assert not heights[:, 23:].any()
        found = textures.texture_patch(worker_state, digest, -0.04, 0.03, 0.01, 8)
        heights = np.fromfile(worker_state.folder / digest / found["file"], "<f4").reshape(8, 8)
        assert not heights[:4].any() and not heights[:, :4].any() and heights[4:, 4:].any()
        bare = show(seen(np.zeros((3, 4))), worker_state.folder)["digest"]
        found = textures.texture_patch(worker_state, bare, 0.0, 0.0, 0.01, 8)
        assert not np.fromfile(worker_state.folder / bare / found["file"], "<f4").any()

    def test_texture_patch_that_is_invalid_is_refused(self, worker_state: WorkerState, digest: str):
        told = {"digest": digest, "x_m": 0.0, "y_m": 0.0, "side_m": 0.01, "pixels": 4}
        for wrong in (
            {"digest": "../x"}, {"digest": "0" * 32}, {"side_m": 0.0}, {"side_m": 0.11}, {"pixels": 513}, {"pixels": 0},
            {"x_m": np.nan}, {"y_m": np.inf},
        ):  # fmt: skip
            with pytest.raises(GeometryError):
                textures.texture_patch(worker_state, **told | wrong)
        for square in ({"side_m": 0.1, "pixels": 512}, {"pixels": 1}):
            assert textures.texture_patch(worker_state, **told | square)["file"]


ASKED = {"row": 2, "rows": 3, "column": 5, "columns": 4, "of": 11, "bytes": 2}


class TestWindow:
    @pytest.fixture
    def path(self, tmp_path: Path) -> Path:
        path = tmp_path / "labels"
        path.write_bytes(np.arange(7 * 11, dtype="<u2").tobytes())
        return path

    def test_window_is_the_rectangle_within_the_file(self, path: Path, monkeypatch: pytest.MonkeyPatch):
        monkeypatch.setattr(routes, "MAX_ITEMS", 12)
        whole = np.arange(77).reshape(7, 11)
        for row, column in ((2, 5), (0, 0), (0, 7), (4, 0), (4, 7)):
            found = np.frombuffer(read_window(path, ASKED | {"row": row, "column": column}), "<u2").reshape(3, 4)
            np.testing.assert_array_equal(found, whole[row : row + 3, column : column + 4])
        with pytest.raises(ValueError, match="no such window"):
            read_window(path, ASKED | {"columns": 5})
        for wrong in ({"row": 5}, {"column": 8}, {"row": -1}, {"column": -1}, {"rows": 0}, {"bytes": 0}, {"of": 10**9}):
            with pytest.raises(ValueError, match="no such window"):
                read_window(path, ASKED | wrong)


def test_parts_that_were_simplified_away_are_not_shown():
    labels = np.zeros((60, 80), np.int32)
    labels[10:40, 10:40], labels[20:24, 60:64] = 1, 2
    scene = Scene.photo(labels.astype(np.uint8), segments=labels)
    said = {"parts": {1: "ground", 2: "box"}, "heights": "given", "cached": False}
    for more, there in (({}, [0, 1, 2]), ({"simplify": {}}, [0, 1])):
        pipeline = Pipeline(scene, **said, **more)
        pipeline.make("surface")
        found = make_view(pipeline, "relief")
        assert found.labels is not None and np.unique(found.labels).tolist() == there
        assert found.names == ("ground", "box", "")

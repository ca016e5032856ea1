"""Panels, numbered parts and sheets: if a case fails, a figure is wrong, or a part has the wrong number."""

from dataclasses import replace
from io import BytesIO

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.quiver import Quiver, QuiverKey
from PIL import Image

from tangible_core import Pipeline, Scene, show
from tangible_core.data import Calibration, DisparityMap, HapticSurface, PartMap, Relief, SegmentMap, Views
from tangible_core.materials.assignment import library
from tangible_core.parts import find_parts
from tangible_core.scene.workspace import Workspace
from tangible_core.session import Recording
from tangible_depth import Luminance
from tangible_legibility.cells import largest_disc
from tangible_report import Sheet
from tangible_report.commands import materials
from tangible_report.drawing.sheet import scene_aspect
from tangible_report.numbered_parts import LONGEST_PX, SHORTEST_PX, Before, Drawn, _coarse, numbered_parts
from tangible_report.panels import draw_disparity, draw_force_map, draw_force_time, draw_relief, pictures, relief
from tangible_report.panels.pictures import _camera
from tangible_texture import Gradient


@pytest.fixture
def axes() -> Axes:
    """4 inches wide and 3.4 inches high."""
    return Figure(figsize=(8, 4), dpi=100).add_axes((0, 0, 0.5, 0.85))


def level(height_m: float = 0.004, extent_m: tuple[float, float] = (0.08, 0.04)) -> Relief:
    return Relief(np.full((20, 40), height_m, np.float32), extent_m)


def recording(position_m: np.ndarray, force_n: np.ndarray) -> Recording:
    count = len(position_m)
    return Recording.of(
        time_s=np.arange(count) / 1000, position_m=position_m, velocity_m_per_s=np.zeros((count, 3)), force_n=force_n
    )


def line(count: int, z_m: float | np.ndarray = 0.003) -> np.ndarray:
    return np.stack([np.linspace(-0.01, 0.01, count), np.zeros(count), z_m * np.ones(count)], axis=1)


class TestTime:
    def test_tip_below_the_base_is_drawn_over_the_surface_in_millimetres(self, axes: Axes):
        draw_force_time(axes, recording(line(50, np.linspace(0.005, -0.002, 50)), np.zeros((50, 3))), level())
        lower = axes.child_axes[1]
        assert lower.get_ylim()[0] == pytest.approx(-2)
        (ground,) = (collection for collection in lower.collections if collection.get_label() == "surface")
        assert ground.get_paths()[0].vertices[:, 1].max() == pytest.approx(4)


class TestDisparity:
    def test_one_false_match_does_not_take_the_colours(self, axes: Axes):
        values = np.linspace(0, 10, 1000, dtype=np.float32).reshape(20, 50)
        values[3, 3] = 1000
        draw_disparity(axes, DisparityMap(values))
        assert axes.images[0].get_clim() == pytest.approx((0.05, 9.95), abs=0.02)


class TestForce:
    def test_arrow_of_one_great_force_is_cut_to_twice_the_scale_of_the_others(self, axes: Axes):
        force_n = np.zeros((100, 3))
        force_n[:, 1], force_n[50, 1] = 0.5, 5
        draw_force_map(axes, level(), recording(line(100), force_n))
        (arrows,) = (collection for collection in axes.collections if isinstance(collection, Quiver))
        assert sorted({*np.round(arrows.V, 9).tolist()}) == [0.5, 1]
        (key,) = (child for child in axes.get_children() if isinstance(child, QuiverKey))
        assert key.text.get_text() == "0.5 N, cut at 1 N"


class TestRelief:
    def test_block_is_stretched_to_a_sixth_of_its_longer_side(self):
        for high_m, extent_m, says in (
            (0.002, (0.12, 0.04), "Surface, heights x 10"),
            (0.002, (0.04, 0.12), "Surface, heights x 10"),
            (0.03, (0.12, 0.04), "Surface"),
            (0.0, (0.12, 0.04), "Surface, smooth"),
        ):
            assert relief.draw_surface(Figure().subplots(), level(high_m, extent_m)) == says

    def test_slope_is_lit_or_dark_by_the_side_that_it_faces(self, axes: Axes):
        x = np.linspace(0, 0.08, 81, dtype=np.float32)
        heights = np.interp(x, [0, 0.02, 0.03, 0.05, 0.06, 0.08], [0, 0, 0.005, 0.005, 0, 0])[None].repeat(40, axis=0)
        draw_relief(axes, Relief(heights.astype(np.float32), (0.08, 0.04)))
        lightness = axes.images[0].get_array().mean(axis=(0, 2))
        assert lightness[25] > lightness[40] + 0.05
        assert lightness[55] < lightness[40] - 0.2

    def test_arrows_point_down_the_slope(self, axes: Axes):
        heights = np.linspace(0, 0.02, 40, dtype=np.float32)[None].repeat(20, axis=0)
        draw_relief(axes, Relief(heights, (0.08, 0.04)))
        [arrows] = [collection for collection in axes.collections if hasattr(collection, "U")]
        assert (arrows.U < -0.2).all() and np.abs(arrows.V).max() < 1e-6


class TestSegments:
    def test_parts_of_the_legend_are_near_by_their_mean_height(self):
        labels = np.int32([[0, 0, 0, 0], [0, 0, 0, 1], [2, 2, 2, 2]])
        surface = HapticSurface.from_heights(np.array([0.002, 0.003, 0.001])[labels], 0.08, labels)
        assert pictures._near_to_far(PartMap(labels, (0, 1, 2)), surface) == [1, 0, 2]
        assert pictures._entries([*"aaabbbb"]) == ["1, 2, 3: a", "4, 5, 6, ...: b"]

    @pytest.mark.parametrize(("count", "last"), [(20, "t, 5 %"), (21, "and 2 more")])
    def test_legend_has_as_many_entries_as_lines_have_room(self, axes: Axes, count: int, last: str):
        """3.4 inches have 20 lines."""
        entries = [chr(97 + number) for number in range(count)]
        pictures._draw_legend(axes, entries, np.full(count, 0.05))
        legend = axes.get_legend()
        assert legend is not None
        texts = [text.get_text() for text in legend.get_texts()]
        assert (len(texts), texts[-1]) == (20, last)


class TestSheet:
    @pytest.mark.parametrize(("shape", "aspect"), [((30, 60), 2), ((600, 30), 0.25), ((30, 600), 6)])
    def test_scene_has_the_sides_of_its_picture_or_relief(self, shape: tuple[int, int], aspect: float):
        assert scene_aspect({"views": Views(np.zeros(shape, np.uint8))}) == aspect
        heights = np.zeros(shape, np.float32)
        assert scene_aspect({"relief": HapticSurface.from_heights(heights, 0.08).relief}) == aspect


class TestMaterials:
    def test_material_vibrates_by_its_grain(self):
        found = {name: materials._vibration_hz(library()[name]) for name in ("ice", "rubber", "sand")}
        assert found["ice"] is None
        assert found["sand"] == pytest.approx(0.12 / library()["sand"].grain_m)
        smooth = replace(library()["rubber"], roughness_m=0.0)
        assert materials._vibration_hz(smooth) == pytest.approx(0.12 / smooth.grain_m)
        assert materials._vibration_hz(replace(library()["sand"], roughness_m=0.0)) is None


@pytest.mark.parametrize(("baseline_m", "text"), [(0.193, "B 193 mm"), (0.999, "B 999 mm"), (60.0, "B 60 m")])
def test_baseline_is_in_the_unit_of_its_size(baseline_m: float, text: str):
    picture = np.zeros((4, 6), np.uint8)
    assert _camera(Views(picture, picture, Calibration(995.0, baseline_m))) == f", f 995 px, {text}"


def draw(picture: np.ndarray, labels: np.ndarray, names: tuple[str, ...] = ()) -> np.ndarray:
    parts = find_parts(SegmentMap(labels.astype(np.int32)))
    return np.asarray(Image.open(BytesIO(numbered_parts(picture, parts, names))))


def halves(rows: int, columns: int) -> tuple[np.ndarray, np.ndarray]:
    labels = (np.arange(columns) * 2 // columns) * np.ones((rows, 1), int)
    return np.full((rows, columns, 3), 127, np.uint8), labels


@pytest.mark.parametrize("size", [(80, 100), pytest.param((3000, 4000), marks=pytest.mark.whole)])
def test_numbers_have_the_same_share_of_any_picture(size: tuple[int, int]):
    shown = draw(*halves(*size))
    longer = max(shown.shape)
    assert SHORTEST_PX <= longer <= LONGEST_PX and shown.shape[1] / shown.shape[0] == pytest.approx(size[1] / size[0])
    left = (shown[:, : shown.shape[1] * 2 // 5] != 127).any(axis=2)
    heights = np.flatnonzero(left.any(axis=1))
    assert 1 / 60 < np.ptp(heights) / longer < 1 / 15, "the number 0 in the middle of the left half"
    assert heights.mean() / shown.shape[0] == pytest.approx(0.5, abs=0.02)


def test_borders_are_visible_and_coarse_grids_are_of_middles():
    picture, labels = halves(600, 800)
    for grey in (0, 255):
        row = draw(np.full_like(picture, grey), labels)[5]
        middle = len(row) // 2
        assert {0, 255} <= set(row[middle - 10 : middle + 10].ravel().tolist())
        assert (row[: middle - 20] == grey).all()
    assert _coarse(np.arange(12, dtype=np.int32)[None], 4).tolist() == [[1, 4, 7, 10]]


def test_names_and_numbers_are_written_where_there_is_room():
    picture, labels = halves(600, 800)
    labels[:30, :30] = 2  # a part too small for its name
    plain, named = draw(picture, labels), draw(picture, labels, ("corner of the wall", "helmet", ""))

    def count_ink(shown: np.ndarray, columns: slice) -> int:
        return int((shown[:, columns] == 0).all(axis=2).sum())

    left, right = slice(100, plain.shape[1] // 2 - 40), slice(plain.shape[1] // 2 + 40, None)
    assert count_ink(named, left) > 3 * count_ink(plain, left), "1 helmet"
    assert count_ink(named, right) == count_ink(plain, right), "no name, its number alone"
    assert (named[:60, :60] == plain[:60, :60]).all(), "its number alone"
    bar = np.zeros((20, 60), bool)
    bar[3:8, 10:51] = True
    disc = largest_disc(bar)
    assert disc is not None
    assert (disc.column, disc.row) == (30, 5)


def parts(*rows: list[int]) -> PartMap:
    labels = np.int32(rows)
    return PartMap(labels, tuple(range(int(labels.max()) + 1)))


def test_parts_are_the_same_that_cover_most_of_each_other():
    drawn = Drawn(np.int32([[0, 0, 0, 1]]))
    assert drawn.before(parts([0, 0, 0, 1])) == (Before(0, 0), Before(1, 1))
    assert drawn.before(parts([0, 0, 1, 2])) == (Before(0, 0), Before(None, 0), Before(1, 1))
    assert drawn.before(parts([0, 0, 0, 0])) == (Before(0, 0),)
    assert Drawn(np.int32([[1, 1]])).before(parts([1, 1])) == (Before(None, 0), Before(1, 1))
    assert Drawn(np.int32([[0, 0, 1, 1]])).before(parts([0], [0], [1], [1])) is None


@pytest.fixture
def pipeline() -> Pipeline:
    picture = np.zeros((24, 32, 3), np.uint8)
    picture[:, 16:] = 255
    return Pipeline(
        Scene.photo(picture), depth=Luminance(), texture=Gradient(), workspace=Workspace(width_m=0.04), cached=False
    )


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_export_to_sheet_writes_a_file_of_its_format(pipeline, tmp_path, ending):
    done = pipeline.export(tmp_path, [Sheet(format=ending)])
    [exported] = done.exports
    assert exported.outcome.outcome == "ran"
    assert [path.suffix for path in exported.files] == [f".{ending}"]


def test_sheet_and_show_draw_what_the_exporter_draws(pipeline, tmp_path):
    [path] = pipeline.export(tmp_path, ["sheet"]).files["sheet"]
    described = Image.open(path).text["Description"]
    assert all(each in described for each in ("Input", "Segments and their materials", "Relief"))
    axes = show(pipeline.relief)
    assert axes.get_title() == Sheet().show(pipeline.relief).get_title() != ""

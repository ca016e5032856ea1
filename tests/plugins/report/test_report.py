"""The sheet of a run: if a case fails, its picture shows something else than was computed, or there is none."""

import json
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.quiver import Quiver
from PIL import Image

from tangible_core.data import (
    Calibration,
    DisparityMap,
    HapticSurface,
    Material,
    MaterialMap,
    PartMap,
    Relief,
    SegmentMap,
    Views,
)
from tangible_core.errors import OutputError, PictureError
from tangible_core.files.json_text import write_figures
from tangible_core.materials.assignment import library
from tangible_core.plugins import hooks
from tangible_core.plugins.hooks import Panel, hookimpl
from tangible_core.plugins.registry import Registry
from tangible_core.session import Recording
from tangible_report.drawing.layout import Cell, arrange
from tangible_report.drawing.sheet import WIDTH_IN, draw_figure, draw_sheet
from tangible_report.panels import PANELS
from tangible_report.panels.relief import cell_points, heights_under, round_number, spread
from tangible_report.style import colours

NAN = np.nan
SHAPE = ROWS, COLUMNS = 40, 60


def record(count: int = 200) -> Recording:
    """A tip that goes down a slanted line, pressing in the second half."""
    time_s = np.arange(count) / 1000
    way = np.linspace(-0.03, 0.03, count)
    force_n = np.outer(time_s >= time_s[count // 2], [0.1, -0.2, 0.5])
    position_m = np.stack([way, way / 2, 0.01 - way / 10], axis=1)
    return Recording.of(time_s=time_s, position_m=position_m, velocity_m_per_s=np.ones((count, 3)), force_n=force_n)


def whole_run() -> dict[str, object]:
    rng = np.random.default_rng(0)
    picture = rng.integers(0, 256, (*SHAPE, 3), dtype=np.uint8)
    truth = np.full(SHAPE, 8.0, np.float32)
    estimate = truth + rng.uniform(-3, 3, SHAPE).astype(np.float32)
    truth[:3], estimate[5:9] = NAN, NAN
    labels = np.repeat(np.int32([[0, 1, 2]]), ROWS, axis=0).repeat(20, axis=1)
    materials = tuple(Material(name, 900.0, 1.0, 0.5, 0.4) for name in ("ice", "sandpaper", "ice"))
    heights_m = np.linspace(0, 0.02, COLUMNS, dtype=np.float32) * np.ones(SHAPE, np.float32)
    return {
        "views": Views(picture, picture, Calibration(1000.0, 0.2)),
        "truth": truth,
        "disparity": DisparityMap(estimate),
        "segments": SegmentMap(labels),
        "materials": MaterialMap(materials, ("", "", "")),
        "relief": HapticSurface.from_heights(heights_m).relief,
        "recording": record(),
    }


class TestFigures:
    def test_figures_that_are_not_finite_become_null(self, tmp_path: Path) -> None:
        figures = {
            "bad": {"bad1": NAN, "rms": np.float32(np.inf)},
            "map": np.array([[1.0, NAN]]),
            "count": np.int32(3),
            "file": Path("a") / "b",
            "flag": np.bool_(True),
            7: "é",
        }
        path = tmp_path / "deep" / "figures.json"
        write_figures(path, figures)  # pyright: ignore[reportArgumentType]
        with pytest.raises(TypeError):
            write_figures(path, {"a": {1, 2}})
        assert list(path.parent.iterdir()) == [path]
        assert json.loads(path.read_text(encoding="utf-8")) == {
            "bad": {"bad1": None, "rms": None},
            "map": [[1.0, None]],
            "count": 3,
            "file": str(Path("a") / "b"),
            "flag": True,
            "7": "é",
        }


class TestLayout:
    def test_layout_fills_rows_and_leaves_room_for_text(self) -> None:
        cell = Cell(aspect=2.0, left_in=0.5, right_in=0.5, bottom_in=0.3, top_in=0.4)
        boxes, width_in, height_in = arrange([cell, cell], 12.0)
        np.testing.assert_allclose(boxes, [(0.5, 0.4, 5.0, 2.5), (6.5, 0.4, 5.0, 2.5)])
        assert (width_in, height_in) == (pytest.approx(12.0), pytest.approx(3.2))
        narrow = Cell(0.1, 0.0, 0.0, 0.0, 0.0, least_in=3.0)
        boxes, _, _ = arrange([narrow, narrow], 12.0)
        assert boxes[1].left_in >= 3.0

    @given(st.lists(st.floats(0.5, 5.0), min_size=1, max_size=8))
    def test_layout_rows_fill_the_sheet_without_overlap(self, aspects: list[float]) -> None:
        cells = [Cell(aspect, 0.2, 0.8, 0.5, 0.4, 2.9) for aspect in aspects]
        boxes, width_in, height_in = arrange(cells, WIDTH_IN)
        tops = sorted({box.top_in for box in boxes})
        for top, below in zip(tops, [*tops[1:], height_in + 0.4], strict=True):
            row = [box for box in boxes if box.top_in == top]
            assert len({box.height_in for box in row}) == 1
            assert all(b.left_in >= a.left_in + a.width_in + 1.0 - 1e-9 for a, b in pairwise(row))
            assert top + row[0].height_in + 0.5 <= below - 0.4 + 1e-9
        assert width_in <= WIDTH_IN + 1e-6
        assert [(box.top_in, box.left_in) for box in boxes] == sorted((box.top_in, box.left_in) for box in boxes)


class TestPoints:
    def test_points_are_the_cells_centres_at_their_heights(self) -> None:
        points_m = cell_points(Relief(np.float32([[1, 2]]), (0.4, 0.1)))
        np.testing.assert_allclose(points_m, [[[-0.1, 0, 1], [0.1, 0, 2]]])
        relief = Relief(np.float32([[1, 2], [3, 4]]), (0.2, 0.2))
        points_m = np.array([[-0.05, 0.05, 9], [0.05, 0.05, 0], [-0.05, -0.05, 0], [0.099, -0.099, 0], [0.2, 0, 0]])
        np.testing.assert_array_equal(heights_under(relief, points_m), [1, 2, 3, 4, NAN])


class TestForces:
    def test_arrows_are_at_equal_steps_of_the_path(self) -> None:
        way_mm = np.r_[np.zeros(50), np.arange(51.0)]
        at_mm = np.stack([way_mm, 0 * way_mm, 0 * way_mm], axis=1)
        some = spread(at_mm, np.ones(101, bool), 6)
        np.testing.assert_array_equal(at_mm[some, 0], [0, 10, 20, 30, 40, 50])

        np.testing.assert_array_equal(spread(np.zeros((9, 3)), np.ones(9, bool), 3), [0, 4, 8])  # by time
        assert spread(at_mm, np.zeros(101, bool), 5).size == 0

    @given(st.floats(1e-9, 1e9))
    def test_round_number_is_the_largest_below_the_value(self, value: float) -> None:
        number = round_number(value)
        assert number <= value * (1 + 1e-9) < 2.5 * number * (1 + 1e-9)
        assert f"{number:e}"[0] in "125"


HEADLINES = {
    "a": "Input: left, inset right",
    "b": "Disparity",
    "d": "Segments and their materials",
    "e": "Relief and its normals",
    "f": "Lateral force along the path",
    "g": "Force and tip over time: peak 0.55 N, contact 50 %",
}


def headlines(run: dict[str, object]) -> dict[str, str]:
    return panel_headlines(draw_figure(run, "title", PANELS))


def panel_headlines(figure: Figure) -> dict[str, str]:
    _, *texts = [text.get_text() for text in figure.texts]
    return dict(zip(texts[::2], texts[1::2], strict=True))


def images(axes: Axes) -> list[np.ma.MaskedArray]:
    """Return the pixels of every picture on a panel."""
    return [np.ma.masked_array(image.get_array()) for image in axes.images]


@pytest.fixture
def draw_figure_of(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Figure]:
    """Return a function that draws a sheet and returns its figure."""
    figures: list[Figure] = []

    def keep(*given: Any) -> Figure:
        figures.append(draw_figure(*given))
        return figures[-1]

    def draw(**run: Any) -> Figure:
        draw_sheet(tmp_path / "sheet.png", **run)
        return figures[-1]

    monkeypatch.setattr("tangible_report.drawing.sheet.draw_figure", keep)
    monkeypatch.setattr("tangible_report.drawing.sheet.DPI", 40)
    return draw


def histogram(axes: Axes, relief: Relief, recording: Recording | None = None) -> str:
    """A plugin's panel."""
    axes.hist(relief.height_m.ravel())
    return f"Heights, {'felt' if recording else 'unfelt'}"


def raises(axes: Axes, **_: Any) -> str:
    axes.plot([0, 1])
    raise ZeroDivisionError("no\nheights")


@pytest.fixture
def adding(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Return a function that installs hook modules that add panels, one each."""

    class Adds:
        def __init__(self, panel: Any) -> None:
            self.panel = panel

        @hookimpl
        def tangible_panels(self) -> tuple[Any, ...]:
            return (self.panel,)

    def add(*panels: Any) -> None:
        plugins = hooks.manager()
        for number, panel in enumerate(panels):
            plugins.register(Adds(panel), name=f"acme/{number}")
        monkeypatch.setattr("tangible_report.drawing.sheet.default_registry", lambda: Registry(plugins))

    return add


class TestAddedPanels:
    """Panels of plugins, by the moment `tangible_panels`."""

    def test_added_panels_are_drawn_last_with_their_products(self, adding: Any, draw_figure_of: Any) -> None:
        adding(Panel(histogram, {"relief"}, {"recording"}, aspect=1.5))
        run = whole_run()
        assert panel_headlines(draw_figure_of(**run))["h"] == "Heights, felt"
        assert panel_headlines(draw_figure_of(relief=run["relief"]))["b"] == "Heights, unfelt"
        assert len(panel_headlines(draw_figure_of(views=run["views"]))) == 1
        adding(*[Panel(histogram, {"relief"}, aspect=1.5)] * 26)
        found = panel_headlines(draw_figure_of(relief=whole_run()["relief"]))
        assert list(found) == [*"abcdefghijklmnopqrstuvwxyz", "aa"]

    def test_added_panel_that_fails_shows_its_error_and_what_is_no_panel_is_left_out(
        self, adding: Any, draw_figure_of: Any
    ) -> None:
        adding((histogram, {"relief"}), Panel(raises, {"relief"}), Panel(histogram, {"relief"}))
        figure = draw_figure_of(relief=whole_run()["relief"])
        assert list(panel_headlines(figure).values())[1:] == [
            "Not drawn, ZeroDivisionError: no\\nheights",
            "Heights, unfelt",
        ]
        assert not figure.axes[-2].lines


class TestSheet:
    def test_sheet_of_a_whole_run_has_every_panel(self) -> None:
        found = headlines(whole_run())
        assert found.pop("c").startswith("Error: bad1 ")
        assert found == HEADLINES

    @pytest.mark.parametrize(
        ("names", "expected"),
        [
            ("views segments", ["Input: left, inset right", "Segments"]),
            ("truth views materials", ["Input: left, inset right"]),
            ("recording", ["Force and tip over time: peak 0.55 N, contact 50 %"]),
        ],
    )
    def test_sheet_leaves_out_missing_products(self, names: str, expected: list[str]) -> None:
        run = {name: value for name, value in whole_run().items() if name in names.split()}
        assert list(headlines(run).values()) == expected

    def test_sheet_without_products_is_refused(self, tmp_path: Path) -> None:
        with pytest.raises(OutputError, match="nothing to draw"):
            draw_sheet(tmp_path / "sheet.png", title="demo", truth=np.ones((4, 4), np.float32))
        assert not list(tmp_path.iterdir())

    @pytest.mark.usefixtures("unchecked_shapes")
    def test_sheet_with_truth_of_another_size_is_refused(self, tmp_path: Path) -> None:
        disparity = DisparityMap(np.zeros((2, 2), np.float32))
        with pytest.raises(PictureError, match="truth"):
            draw_sheet(tmp_path / "sheet.png", disparity=disparity, truth=np.zeros((3, 2), np.float32))

    def test_sheet_is_drawn_with_truth_everywhere_or_thousands_of_segments(
        self, draw_figure_of: Callable[..., Figure]
    ) -> None:
        disparity = DisparityMap(np.float32([[0.0, 0.25], [0.5, 1.0]]), unit="relative")
        figure = draw_figure_of(disparity=disparity, truth=np.zeros((3, 2), np.float32))
        assert panel_headlines(figure) == {"a": "Relative nearness"}
        (axes,) = figure.axes
        np.testing.assert_array_equal(images(axes)[0], disparity.disparity_px)
        assert axes.images[0].get_clim() == pytest.approx(np.percentile([0, 0.25, 0.5, 1], (0.5, 99.5)))
        assert [bar.get_ylabel() for bar in axes.child_axes] == ["nearness, 0 far to 1 near"]
        assert axes.get_xlabel() == "known everywhere"
        estimate = np.full(SHAPE, 8.0, np.float32)
        estimate[:, :6], estimate[:, 6:9], estimate[:, 9:12] = 9.5, 18.0, NAN
        figure = draw_figure_of(disparity=DisparityMap(estimate), truth=np.full(SHAPE, 8.0, np.float32))
        assert panel_headlines(figure) == {"a": "Disparity", "b": "Error: bad1 20.0 %, bad2 10.0 %"}
        assert figure.axes[0].get_xlabel() == "hatched: unknown, 5.0 %"
        white, error = images(figure.axes[1])
        assert np.ma.getmaskarray(white).all()
        assert np.array_equal(np.ma.getmaskarray(error), np.isnan(estimate))
        np.testing.assert_array_equal(error.compressed(), np.abs(estimate - 8)[np.isfinite(estimate)])
        assert figure.axes[1].images[1].get_clim() == (0, 4)
        labels = np.arange(2400, dtype=np.int32).reshape(SHAPE)
        figure = draw_figure_of(views=Views(np.zeros(SHAPE, np.uint8)), segments=SegmentMap(labels))
        assert panel_headlines(figure) == {"a": "Input", "b": "Segments"}
        axes = figure.axes[1]
        assert not axes.texts  # none of them is large enough for its name
        (picture,) = images(axes)
        assert picture.shape == (13 * ROWS, 13 * COLUMNS, 3)
        for label in (0, 1, 7, 8, 2399):
            row, column = divmod(label, COLUMNS)
            np.testing.assert_allclose(picture[13 * row + 6, 13 * column + 6], 0.45 * colours(2400)[label])
        outlined = 0.2 * 0.45 * colours(2400)[61]
        np.testing.assert_allclose(picture[13, 13], outlined)

    @pytest.mark.parametrize(("count", "arrows", "contact"), [(1, 1, 100), (5000, 150, 50)])
    def test_sheet_of_recordings_of_any_length_is_drawn(
        self, draw_figure_of: Callable[..., Figure], count: int, arrows: int, contact: int
    ) -> None:
        hand = record(count)
        figure = draw_figure_of(surface=HapticSurface.from_heights(np.full((5, 5), 0.004)), recording=hand)
        assert list(panel_headlines(figure).values())[1:] == [
            "Lateral force along the path",
            f"Force and tip over time: peak 0.55 N, contact {contact} %",
        ]
        _, way, time = figure.axes
        np.testing.assert_allclose(way.lines[0].get_xydata(), 1000 * hand.position_m[:, :2])
        (quiver,) = [collection for collection in way.collections if isinstance(collection, Quiver)]
        assert len(quiver.U) == arrows
        np.testing.assert_allclose(np.stack([quiver.U, quiver.V, quiver.get_array()]).T, [[0.1, -0.2, 0.5]] * arrows)
        touched = 1000 * hand.position_m[hand.force_n.any(axis=1), :2]
        assert np.isin(quiver.XY[:, 0], touched[:, 0]).all()
        assert way.images[0].get_extent() == pytest.approx([-40, 40, -40, 40])
        upper, lower = time.child_axes
        (force,), (tip,) = upper.lines, lower.lines
        np.testing.assert_allclose(force.get_xydata(), np.c_[hand.time_s, np.linalg.norm(hand.force_n, axis=1)])
        np.testing.assert_allclose(tip.get_xydata(), np.c_[hand.time_s, 1000 * hand.position_m[:, 2]])

    def test_sheet_leaves_out_what_nothing_touched(self, tmp_path: Path) -> None:
        surface = HapticSurface.from_heights(np.zeros((5, 5)))
        recording = Recording(np.empty((0, 17)))
        draw_sheet(tmp_path / "a.png", surface=surface, recording=recording)
        draw_sheet(tmp_path / "b.png", surface=surface)
        assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
        rows = record().rows.copy()
        rows[:, 11:14] = 0
        recording = Recording(rows)
        assert headlines({"relief": surface.relief, "recording": recording})["b"] == "Path, never in contact"


def scene(rows: int, columns: int, count: int = 14) -> dict[str, Any]:
    """A run on a picture of this shape, with segments in stripes, each of a material of its own."""
    labels = np.int32(np.arange(rows)[:, None] * count // rows * np.ones(columns, np.int32))
    heights_m = np.float32(0.005 + 0.004 * np.sin(np.arange(columns) / 9)) * np.ones((rows, columns), np.float32)
    chosen = tuple(library().values())[:count]
    return {
        "views": Views(np.zeros((rows, columns, 3), np.uint8)),
        "disparity": DisparityMap(heights_m * 1000),
        "segments": SegmentMap(labels),
        "materials": MaterialMap(chosen, ("",) * count),
        "relief": HapticSurface.from_heights(heights_m).relief,
        "recording": record(),
    }


class TestParts:
    def test_parts_are_drawn_in_place_of_segments_from_near_to_far(self, tmp_path: Path) -> None:
        labels = np.zeros(SHAPE, np.int32)
        labels[10:30, 5:25], labels[10:30, 35:55] = 1, 2
        parts, segments = PartMap(labels, (0, 1, 1)), SegmentMap(np.minimum(labels, 1))
        materials = tuple(Material(name, 900.0, 1.0, 0.5, 0.4) for name in ("stone", "ice", "ice"))
        flat = HapticSurface.from_heights(np.float32([0.001, 0.002, 0.003])[labels], 0.08, labels, materials)
        surface = replace(flat, names=("wall", "", "a very long name"))
        says = draw_sheet(
            tmp_path / "sheet.svg", views=Views(np.zeros(SHAPE, np.uint8)), segments=segments, parts=parts,
            surface=surface, title="Haus", language="de-AT",
        )  # fmt: skip
        assert (
            "Teile, von nah nach fern: 3 Teile; 3 a very lo...: Eis, 17 %; 2: Eis, 17 %; 1 wall: Stein, 67 %. " in says
        )
        assert "Segmente" not in says and says.startswith("Bildseite von Haus, 3 Bilder.")
        assert "Ihre Teile sind, von nah nach fern, a very long name (rechts" in says


class TestEveryShape:
    """Portrait and panorama; a map of heights alone."""

    @pytest.mark.parametrize(
        ("shape", "alone"),
        [
            ((180, 60), False),
            ((600, 30), True),
            pytest.param((50, 200), False, marks=pytest.mark.whole),
            pytest.param((90, 90), True, marks=pytest.mark.whole),
        ],
    )
    def test_sheet_of_any_shape_is_filled_without_overlap(self, shape: tuple[int, int], alone: bool) -> None:
        run = scene(*shape)
        if alone:
            run = {name: run[name] for name in ("relief", "recording")}
        figure = draw_figure(run, "title", PANELS)
        if not alone:
            views, _, segments, _, way, _ = figure.axes
            for axes in (views, segments, way):
                assert axes.bbox.width / axes.bbox.height == pytest.approx(shape[1] / shape[0], rel=1e-6)
        FigureCanvasAgg(figure).draw()
        bars = [bar for axes in figure.axes for bar in axes.child_axes if axes.images or axes.collections]
        texts = [
            *figure.texts,
            *(axes.xaxis.label for axes in figure.axes if axes.get_xlabel()),
            *(bar.yaxis.label for bar in bars),
            *(text for axes in figure.axes if (legend := axes.get_legend()) for text in legend.get_texts()),
        ]
        boxes = [text.get_window_extent() for text in texts]
        for number, box in enumerate(boxes):
            assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1 and figure.bbox.y0 <= box.y0
            assert not any(box.overlaps(other) for other in boxes[:number]), texts[number].get_text()
        for row in {round(axes.get_position().y1, 6) for axes in figure.axes}:
            panels = [axes for axes in figure.axes if round(axes.get_position().y1, 6) == row]
            ends = [axes.get_position().x1 for axes in panels]
            ends += [
                bar.yaxis.label.get_window_extent().x1 / figure.bbox.x1 for panel in panels for bar in panel.child_axes
            ]
            assert max(ends) > 0.65


class TestSegments:
    def test_segments_are_numbered_in_the_order_of_the_legend(self) -> None:
        run = scene(900, 900)
        del run["recording"], run["disparity"]  # the rest is drawn larger
        axes = draw_figure(run, "title", PANELS).axes[1]
        names = list(library())[:14]
        assert sorted(int(text.get_text().split()[0]) for text in axes.texts) == [*range(1, 15)]
        legend = axes.get_legend()
        assert legend is not None
        said = [text.get_text() for text in legend.get_texts()]
        assert [each.rpartition(",")[0] for each in said] == [
            f"{number}: {name}" for number, name in enumerate(names, 1)
        ]
        shown = {key.get_facecolor() for key in legend.get_patches()}
        assert len(shown) == 14

    @pytest.mark.parametrize("count", [0, 24, 25, 3000])
    def test_colours_are_all_different(self, count: int) -> None:
        found = colours(count)
        assert found.shape == (count, 3) and (found >= 0).all() and (found <= 1).all()
        assert len(np.unique(found.round(6), axis=0)) == count
        if count > 24:  # the first of Roberts' sequence for three dimensions, from the middle on
            step = np.array([0.8191725133961645, 0.6710436067037893, 0.5497004779019703])
            assert found[24] == pytest.approx(0.1 + 0.8 * ((0.5 + step) % 1))
        if 8 < count < 30:
            apart = np.linalg.norm(found[:, None] - found, axis=2) + np.eye(count)
            assert apart.min() > 0.1


class TestFiles:
    SAYS = (
        "A sheet of 3 pictures of a & b. Input: left, inset right: 60 x 40 px, f 1000 px, B 200 mm. "
        "Segments and their materials: 3 segments, 2 materials; 1, 3: ice, 67 %; 2: sandpaper, 33 %. "
        "Relief and its normals: 80 x 53.3 mm, heights in mm."
    )

    @pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
    def test_sheet_file_has_a_description(self, tmp_path: Path, suffix: str) -> None:
        run: dict[str, Any] = {name: whole_run()[name] for name in ("views", "segments", "materials", "relief")}
        for name in "xy":
            assert draw_sheet(tmp_path / f"{name}.{suffix}", title="a & b", **run) == self.SAYS
        first = (tmp_path / f"x.{suffix}").read_bytes()
        assert first == (tmp_path / f"y.{suffix}").read_bytes()
        if suffix == "png":
            with Image.open(tmp_path / "x.png") as sheet:
                assert (sheet.info["Title"], sheet.info["Description"]) == ("a & b", self.SAYS)
        elif suffix == "svg":
            root = ElementTree.fromstring(first)
            texts = {each.tag.rpartition("}")[2]: each.text for each in [*root][:2]}
            assert texts == {"title": "a & b", "desc": self.SAYS}
            assert root.get("role") == "img"
        else:
            assert first.startswith(b"%PDF") and b"/Subject" in first

    def test_sheet_with_another_suffix_is_refused(self, tmp_path: Path) -> None:
        with pytest.raises(OutputError, match=r"drawn as \.png, \.svg or \.pdf"):
            draw_sheet(tmp_path / "sheet.jpg", views=Views(np.zeros((4, 4), np.uint8)))

"""Parts proposed from a stroke, outlines on the picture's edges: otherwise somebody draws each border by hand."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from tangible_core.data import SegmentTree
from tangible_core.errors import ConfigError
from tangible_texture import Hierarchy
from tangible_ui.worker.jobs import JOBS
from tangible_ui.worker.parts import outlines, proposals
from tangible_ui.worker.parts.outlines import snap
from tangible_ui.worker.parts.proposals import as_points, propose, propose_region, runs
from tangible_ui.worker.state import WorkerState

SHAPE = (240, 320)


def two_things() -> tuple[np.ndarray, np.ndarray]:
    """A picture of a leaning ellipse on another ground, both rough, and where the ellipse is."""
    inside = np.zeros(SHAPE, np.uint8)
    cv2.ellipse(inside, (160, 120), (80, 45), 30, 0, 360, 1, -1)
    rough = cv2.GaussianBlur(np.random.default_rng(1).normal(0, 40, (*SHAPE, 3)), (0, 0), 1.5)
    picture = rough + np.where(inside[..., None], [190, 120, 60], [80, 110, 140])
    return np.clip(picture, 0, 255).astype(np.uint8), inside.astype(bool)


def place(box: tuple[int, ...], mask: np.ndarray, shape: tuple[int, int] = SHAPE) -> np.ndarray:
    found = np.zeros(shape, bool)
    x, y, columns, rows = box
    found[y : y + rows, x : x + columns] = mask
    return found


def overlap(one: np.ndarray, other: np.ndarray) -> float:
    return float((one & other).sum() / (one | other).sum())


STROKE = np.array([[120.0, 97.0], [160.0, 120.0], [200.0, 143.0]])


class TestProposals:
    @pytest.mark.parametrize("kind", ["grabcut", "watershed"])
    @pytest.mark.parametrize("factor", [1, 6])
    def test_proposal_is_the_object_under_the_stroke(self, kind: proposals.Kind, factor: int) -> None:
        picture, inside = two_things()
        picture = cv2.resize(picture, None, fx=factor, fy=factor, interpolation=cv2.INTER_CUBIC)
        box, mask = propose(picture, STROKE * factor, 12 * factor, kind)
        found = place(box, mask, (factor * SHAPE[0], factor * SHAPE[1]))
        assert overlap(found[factor // 2 :: factor, factor // 2 :: factor], inside) > 0.95
        assert all(side.any() for side in (mask[0], mask[-1], mask[:, 0], mask[:, -1])), "the box just holds it"

    @pytest.mark.parametrize("kind", ["grabcut", "watershed"])
    @pytest.mark.parametrize("factor", [1, 5])
    def test_proposal_of_half_a_picture_reaches_its_edges(self, kind: proposals.Kind, factor: int) -> None:
        rows, columns, half = 96 * factor, 120 * factor, 63 * factor + 2
        picture = np.full((rows, columns, 3), [80, 110, 140], np.uint8)
        picture[:, :half] = [190, 120, 60]
        stroke = np.array([[30.0, 10.0], [30.0, 86.0]]) * factor
        box, mask = propose(picture, stroke, 8 * factor, kind)
        assert (box.x, box.y, box.rows) == (0, 0, rows)
        assert box.columns == pytest.approx(half, abs=1)
        assert mask.sum(axis=1) == pytest.approx(np.full(rows, half), abs=1)

    @pytest.mark.parametrize("turns", range(4))
    @pytest.mark.parametrize(("edge", "inside", "outside"), [(48, 52, 60), (56, 52, 60), (59, 52, 60), (64, 52, 60)])
    def test_refined_border_moves_by_a_cell_at_most(self, turns: int, edge: int, inside: int, outside: int) -> None:
        """The picture's edge is two cells beside the coarse border, of 14 of 24 cells, or near it; a cell has 4 x 4."""
        coarse = np.zeros((24, 24), bool)
        coarse[:, :14] = True
        picture = np.full((96, 96, 3), [80, 110, 140], np.uint8)
        picture[:, :edge] = [190, 120, 60]
        fine = np.rot90(proposals._refine_border(np.rot90(picture, turns).copy(), np.rot90(coarse, turns)), -turns)
        assert fine[:, :inside].all()
        assert not fine[:, outside:].any()
        if inside < edge < outside:
            assert fine.sum(axis=1) == pytest.approx(np.full(96, edge), abs=1)

    def test_part_is_what_hangs_together_with_the_stroke_without_specks_and_small_holes(self) -> None:
        mask = np.zeros((60, 90), bool)
        mask[10:50, 10:50] = True
        mask[20:24, 20:24] = mask[30:35, 30:35] = False  # holes of 0.8 % and, without their corners, of 1.3 %
        mask[10:20, 60:70] = mask[50:56, 50:56] = True  # apart, and connected by a corner
        mask[30, 50] = mask[5, 5] = True  # specks
        stroke = np.zeros_like(mask)
        stroke[12, 12:20] = True
        wanted = np.zeros_like(mask)
        wanted[10:50, 10:50] = True
        wanted[31:34, 30:35] = wanted[30:35, 31:34] = False
        wanted[[10, 10, 49], [10, 49, 10]] = False  # its own corners, but where the other one touches it
        np.testing.assert_array_equal(proposals._keep_connected(mask, stroke), wanted)

    @pytest.mark.parametrize("points", [STROKE, STROKE[1:2]], ids=["stroke", "click"])
    def test_region_is_the_object_under_a_stroke_or_click(self, points: np.ndarray) -> None:
        picture, inside = two_things()
        box, mask = propose_region(Hierarchy().tree(picture), points, 12, 0.6)
        assert overlap(place(box, mask), inside) > 0.95
        assert all(side.any() for side in (mask[0], mask[-1], mask[:, 0], mask[:, -1])), "the box just holds it"

    def test_strokes_take_regions_of_every_level(self) -> None:
        picture, inside = two_things()
        tree = Hierarchy().tree(picture)
        sizes = [place(*propose_region(tree, STROKE[1:2], 3, level)).sum() for level in (0.05, 0.6, 1.0)]
        assert sizes[0] < 0.5 * inside.sum()
        assert sizes[0] < sizes[1] < sizes[2] == picture[..., 0].size
        labels = np.zeros((20, 30), np.int32)
        labels[:, 10:20], labels[:, 20:] = 1, 2
        tree = SegmentTree(labels, np.array([[0, 1], [2, 3]], np.int32), np.float32([0.4, 0.8]))
        both = np.array([[14.0, 10.0], [25.0, 10.0]])
        assert propose_region(tree, both, 1, 0.3)[0] == (10, 0, 20, 20)
        share = np.array([[10.0, 10.0], [22.0, 10.0]])  # ten pixels and three
        assert propose_region(tree, share, 1, 0.3)[0] == (10, 0, 20, 20)
        most = np.array([[11.0, 10.0], [21.0, 10.0]])
        assert propose_region(tree, most, 1, 0.3)[0] == (10, 0, 12, 20), "the stroke itself and one region"
        assert propose_region(tree, most, 1, 0.3, [12, 5, 18, 9])[0][1] >= 5
        assert propose_region(tree, most[:1], 1, 0.5)[0] == (0, 0, 20, 20)

    @pytest.mark.parametrize(
        ("within", "over_px"), [((100, 80, 215, 160), 0), ((100, 80, 201, 144), 7), ((120, 97, 215, 160), 7)]
    )
    def test_proposal_stays_in_the_drawn_box(self, within: tuple[int, int, int, int], over_px: int) -> None:
        """A stroke may end at the box's last column and row; half of its own width is then beside the box."""
        picture, _ = two_things()
        x0, y0, x1, y1 = within
        box, mask = propose(picture, STROKE, 12, "grabcut", within)
        found = place(box, mask)
        assert found[y0:y1, x0:x1].sum() > 1500
        found[y0 - over_px : y1 + over_px, x0 - over_px : x1 + over_px] = False
        assert not found.any()

    @pytest.mark.parametrize(
        ("within", "window"),
        [
            (None, (55, 55, 130, 110)),
            ([90, 80, 150, 170], (90, 80, 60, 85)),
            ([0, 0, 150, 130], (55, 55, 95, 75)),
            ([100, 100, 141, 121], (100, 100, 41, 21)),  # just around the stroke's points
            ([100, 100, 140, 121], (55, 55, 130, 110)),  # which the stroke leaves
            ([90, 80, 150], (55, 55, 130, 110)),
            ([90, 80, 150, np.inf], (55, 55, 130, 110)),
        ],
    )
    def test_window_reaches_beyond_the_stroke_by_its_length_and_width(
        self, within: list[float] | None, window: tuple[int, ...]
    ) -> None:
        """The stroke covers 50 x 30 pixels: 0.4 of 50, and two widths of 10, to each side."""
        points = np.array([[100.0, 100.0], [140.0, 120.0]])
        assert proposals._window((*SHAPE, 3), points, 10, within) == window

    def test_window_and_rim_end_with_the_picture(self) -> None:
        """A click of 10 pixels: 5, 0.4 of 10 and 20 to each side."""
        assert proposals._window((*SHAPE, 3), np.array([[5.0, 230.0]]), 10, None) == (0, 201, 34, 39)
        assert proposals._window((*SHAPE, 3), np.array([[315.0, 4.0]]), 10, None) == (286, 0, 34, 33)
        inside = [10.2, 20.2, 10.8, 20.8]
        assert proposals._window((*SHAPE, 3), np.array([[10.5, 20.5]]), 1, inside) == (10, 20, 1, 1)
        for window, sides in (
            ((0, 0, 320, 240), [False, False, False, False]),
            ((0, 100, 320, 140), [True, False, False, False]),
            ((100, 0, 220, 200), [False, True, True, False]),
            ((0, 0, 300, 240), [False, False, False, True]),
        ):
            stroke = np.zeros((9, 12), bool)
            rim = proposals._rim(proposals.Window(*window), stroke, SHAPE)
            for deep in (0, 1):
                ends = rim[deep, 5], rim[-1 - deep, 5], rim[4, deep], rim[4, -1 - deep]
                assert [bool(end) for end in ends] == sides
            assert not rim[2:-2, 2:-2].any()
            stroke[:, 6] = True
            assert not proposals._rim(proposals.Window(*window), stroke, SHAPE)[:, 6].any()

    @pytest.mark.parametrize("kind", ["grabcut", "watershed"])
    @pytest.mark.parametrize("shape", [(1, 1), (1, 40), (60, 80)])
    def test_proposal_in_a_flat_or_tiny_picture_contains_the_stroke(
        self, kind: proposals.Kind, shape: tuple[int, int]
    ) -> None:
        picture = np.full((*shape, 3), 128, np.uint8)
        points = as_points([[0, 0], [1e9, -1e9]], picture.shape)
        box, mask = propose(picture, points, 3, kind)
        found = place(box, mask, shape)
        assert found[0, 0]
        assert found[0, -1]

    def test_runs_and_strokes_of_a_mask_are_encoded_and_thinned(self) -> None:
        for mask in (np.array([[True, False], [False, True]]), np.array([[False, True, True]]), np.ones((2, 2), bool)):
            inside = np.repeat(np.arange(len(runs(mask))) % 2, runs(mask))
            np.testing.assert_array_equal(inside.reshape(mask.shape), mask)
        most = [[float(each % 300), each / 100] for each in range(proposals.MAX_POINTS)]
        np.testing.assert_array_equal(as_points(most, (*SHAPE, 3)), most)
        many = [[each / 100, 0.0] for each in range(2 * proposals.MAX_POINTS - 1)]
        np.testing.assert_array_equal(as_points(many, (*SHAPE, 3)), many[::2])
        assert as_points([[400.0, 300.0], [-1.0, -1.0]], (*SHAPE, 3)).tolist() == [[319, 239], [0, 0]]

    @pytest.mark.parametrize("points", [[], [[1.0]], [[1.0, 2.0, 3.0]], [[float("nan"), 1.0]], [[1.0, 2.0], []]])
    def test_invalid_stroke_is_refused(self, points: list[list[float]]) -> None:
        with pytest.raises(ConfigError, match="at least one"):
            as_points(points, (*SHAPE, 3))


class TestSnapping:
    def wobbling(self, around: np.ndarray, by: float) -> np.ndarray:
        found, _ = cv2.findContours(around.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        points = found[0][:, 0].astype(float)
        angle = np.linspace(0, 2 * np.pi, len(points))[:, None]
        middle = points.mean(0)
        return middle + (points - middle) * (1 + by * (np.sin(5 * angle) + 0.5 * np.sin(9 * angle)))

    def fill_outline(self, points: np.ndarray, shape: tuple[int, int] = SHAPE) -> np.ndarray:
        found = np.zeros(shape, np.uint8)
        cv2.fillPoly(found, [np.round(points).astype(np.int32)], 1)
        return found.astype(bool)

    @pytest.mark.parametrize("factor", [1, 5])
    def test_outline_moves_to_the_edges(self, factor: int) -> None:
        picture, inside = two_things()
        outline = self.wobbling(inside, 0.07)
        assert overlap(self.fill_outline(outline), inside) < 0.93
        picture = cv2.resize(picture, None, fx=factor, fy=factor, interpolation=cv2.INTER_CUBIC)
        found = snap(picture, outline * factor, 12.0 * factor) / factor
        assert overlap(self.fill_outline(found), inside) > 0.97

    def test_outline_stays_within_reach_and_without_edges_in_place(self) -> None:
        picture, inside = two_things()
        outline = self.wobbling(inside, 0.07)
        found = snap(picture, outline, 3.0)
        far = np.min(np.hypot(*(found[:, None] - outline[None]).transpose(2, 0, 1)), axis=1)
        assert far.max() < 4.0
        for reach_px in (1.0, 5.0, 12.0, 100.0):
            still = snap(np.full((*SHAPE, 3), 90, np.uint8), outline, reach_px)
            assert still == pytest.approx(outlines._resample(outline))

    @pytest.mark.parametrize("reach_px", [0.0, np.nan])
    def test_outline_with_nothing_in_reach_or_of_few_pixels_stays(self, reach_px: float) -> None:
        picture, inside = two_things()
        outline = self.wobbling(inside, 0.07)
        np.testing.assert_array_equal(snap(picture, outline, reach_px), outline)
        tiny = np.array([[160.0, 75.0], [161.0, 75.0], [160.0, 76.0]])  # 3.4 pixels round
        np.testing.assert_array_equal(snap(picture, tiny, 12.0), tiny)
        assert len(snap(picture, np.array([[160.0, 75.0], [161.0, 75.0], [161.0, 76.0], [160.0, 76.0]]), 12.0)) == 4

    @pytest.mark.parametrize(("edge", "moves"), [(150 + 380, True), (150 + 420, False)])
    def test_outline_reaches_400_pixels_at_most(self, edge: int, moves: bool) -> None:
        picture = np.zeros((300, 800, 3), np.uint8)
        picture[:, edge:] = 255
        outline = np.array([[50.0, 20.0], [150.0, 20.0], [150.0, 280.0], [50.0, 280.0]])
        assert (snap(picture, outline, 1000.0)[:, 0].max() > 500) == moves

    def test_places_and_normals_are_those_of_the_outline(self) -> None:
        square = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
        side, zero, ten = np.arange(10.0), np.zeros(10), np.full(10, 10.0)
        round_it = np.concatenate([np.c_[side, zero], np.c_[ten, side], np.c_[10 - side, ten], np.c_[zero, 10 - side]])
        assert outlines._resample(square) == pytest.approx(round_it)
        assert outlines._resample(75 * square) == pytest.approx(  # 3000 pixels, of which 1500 places
            2 * outlines._resample(37.5 * square)
        )
        angle = 0.1 + np.arange(24) * np.pi / 12
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        assert outlines._normals([40.0, 30.0] + 9 * circle) == pytest.approx(-circle)
        lopsided = np.array([[0.0, 0.0], [5.0, 0.0], [9.0, 1.0], [9.0, 7.0], [4.0, 8.0], [0.0, 3.0], [-1.0, 1.0]])
        assert np.hypot(*outlines._normals(lopsided).T) == pytest.approx(np.ones(7))

    def test_edges_are_steepest_where_they_are_and_the_cheapest_path_bends_there(self) -> None:
        """It lies between columns 29 and 30, 9.5 pixels from the places, from row 20 on; smoothed by known sigmas."""
        picture = np.zeros((60, 60, 3), np.uint8)
        picture[20:, 30:] = 255
        places = np.stack([np.full(50, 20.0), np.arange(5.0, 55.0)], axis=1)
        away = np.linspace(-1, 1, 25) * 12
        found = outlines._edges(picture, places, np.tile([1.0, 0.0], (50, 1)), away)
        across = np.exp(-np.square(np.arange(4)) / (2 * 0.8**2))
        steep = (across[:-1] + across[1:]) / (across[0] + across[1])
        at = np.flatnonzero(away == 9)[0]
        assert found[40, at - 2 : at + 4] == pytest.approx([*steep[::-1], *steep], abs=0.01)
        assert found[40, : at - 4].max() == pytest.approx(0, abs=0.01)
        faint = np.full((60, 60, 3), 100, np.uint8)
        faint[:, 30:] = 102
        lightness = cv2.cvtColor(faint, cv2.COLOR_RGB2Lab)[0, [0, -1], 0].astype(float)
        share = (across[0] + across[1]) / (across[0] + 2 * across[1:].sum())
        weak = outlines._edges(faint, places, np.tile([1.0, 0.0], (50, 1)), away)
        assert weak.max() == pytest.approx(share * np.ptp(lightness) / 4, abs=0.002)
        along = np.exp(-np.square(np.arange(-6, 7)) / (2 * 1.5**2))
        shares = np.cumsum(along / along.sum())
        assert found[9:22, at] == pytest.approx(shares, abs=0.01)

        def beside(row: int, column: int, straight: float) -> list[int]:
            cost = np.ones((9, 9), np.float32)
            cost[:, 1] = 0
            cost[row, 1], cost[row, column] = straight, 0
            return outlines._cheapest(cost).tolist()

        for row in (0, 4, 8):
            straight = [1] * 9
            aside = {column: [*straight[:row], column, *straight[row + 1 :]] for column in (2, 3)}
            assert beside(row, 2, 0.22) == straight
            assert beside(row, 2, 0.26) == aside[2]
            assert beside(row, 3, 0.46) == straight
            assert beside(row, 3, 0.50) == aside[3]
            assert beside(row, 4, 0.99) == straight


def test_jobs_return_json_data(tmp_path: Path) -> None:
    picture, inside = two_things()
    Image.fromarray(picture).save(tmp_path / "a.png")
    worker_state = WorkerState(tmp_path, lambda event, **told: None)
    told = {"text": "scene: {photo: a.png}\n", "path": tmp_path / "a.yaml", "sets": []}
    found = JOBS["parts_propose"].do(
        worker_state, **told, points=STROKE.tolist(), width_px=12, kind="grabcut", within=None, level=0.5
    )
    x, y, columns, rows = found["box"]
    mask = np.repeat(np.arange(len(found["runs"])) % 2, found["runs"]).reshape(rows, columns)
    assert overlap(place((x, y, columns, rows), mask.astype(bool)), inside) > 0.95
    assert all(type(each) is int for each in [*found["box"], *found["runs"]])
    click = {"points": [[160, 120]], "width_px": 3, "kind": "regions", "within": None}
    large, small = (JOBS["parts_propose"].do(worker_state, **told, **click, level=level) for level in (0.6, 0.05))
    x, y, columns, rows = large["box"]
    mask = np.repeat(np.arange(len(large["runs"])) % 2, large["runs"]).reshape(rows, columns)
    assert overlap(place((x, y, columns, rows), mask.astype(bool)), inside) > 0.95
    assert small["box"][2] * small["box"][3] < columns * rows
    found = JOBS["parts_snap"].do(worker_state, **told, points=[[80, 60], [240, 60], [240, 180]], reach_px=5)
    assert all(type(each) is float for point in found["points"] for each in point)

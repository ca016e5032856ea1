"""Parts that are propose from a stroke, and outlines that follow the picture's edges."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from drawn_parts import drawn
from tangible_core.data import SegmentTree
from tangible_core.errors import ConfigError
from tangible_texture import Hierarchy
from tangible_ui.worker.jobs import JOBS
from tangible_ui.worker.parts import proposals
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


def things(name: str) -> list[tuple[str, np.ndarray]]:
    """Parts that were drawn by hand, but specks."""
    found = drawn(name)
    masks = [(part, np.asarray(found.parts.labels == number)) for number, part in enumerate(found.names)]
    return [(part, mask) for part, mask in masks if mask.sum() > 400]


def stroke_along(mask: np.ndarray) -> tuple[np.ndarray, float]:
    """Along the longer side of a part, through the place farthest inside, over the middle 60 %; and its width."""
    depth = cv2.distanceTransform(np.pad(mask.astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    row, column = np.unravel_index(int(depth.argmax()), depth.shape)
    rows, columns = np.nonzero(mask)
    along = np.linalg.eigh(np.cov(columns, rows))[1][:, 1]
    ends: list[list[float]] = []
    for way in (-along, along):
        steps = 0
        while _holds(mask, column + (steps + 1) * way[0], row + (steps + 1) * way[1]):
            steps += 1
        ends.append([float(column + 0.6 * steps * way[0]), float(row + 0.6 * steps * way[1])])
    return np.array(ends), max(3.0, 0.35 * float(depth.max()))


def _holds(mask: np.ndarray, x: float, y: float) -> bool:
    column, row = round(x), round(y)
    return 0 <= row < mask.shape[0] and 0 <= column < mask.shape[1] and bool(mask[row, column])


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
        assert mask[0].any()  # the box just holds it
        assert mask[-1].any()
        assert mask[:, 0].any()
        assert mask[:, -1].any()

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

    def test_proposal_border_is_as_fine_as_the_picture(self, monkeypatch: pytest.MonkeyPatch) -> None:
        picture, inside = two_things()
        monkeypatch.setattr(proposals, "MOST_CELLS", 2000)
        fine = place(*propose(picture, STROKE, 12, "grabcut"))
        monkeypatch.setattr(proposals, "_refine_border", lambda whole, mask: cv2.resize(
            mask.astype(np.uint8), whole.shape[1::-1], interpolation=cv2.INTER_NEAREST) > 0)  # fmt: skip
        coarse = place(*propose(picture, STROKE, 12, "grabcut"))
        assert overlap(fine, inside) > max(0.96, overlap(coarse, inside) + 0.02)

    def test_proposal_finds_objects_in_photographs(self) -> None:
        """Overlap with parts drawn by hand, of one stroke along the middle of each."""
        found = {
            (name, part): overlap(
                place(*propose(drawn(name).picture, *stroke_along(mask), "grabcut"), mask.shape), mask
            )
            for name in ("astronaut", "coffee")
            for part, mask in things(name)
        }
        good = {"head", "collar", "helmet", "suit", "table", "coffee", "floor", "spoon"}
        assert {part for (_, part), share in found.items() if share > 0.75} >= good, found
        assert np.median(list(found.values())) > 0.75

    @pytest.mark.parametrize("points", [STROKE, STROKE[1:2]], ids=["stroke", "click"])
    def test_region_is_the_object_under_a_stroke_or_click(self, points: np.ndarray) -> None:
        picture, inside = two_things()
        box, mask = propose_region(Hierarchy().tree(picture), points, 12, 0.6)
        assert overlap(place(box, mask), inside) > 0.95
        assert mask[0].any()  # the box just holds it
        assert mask[-1].any()
        assert mask[:, 0].any()
        assert mask[:, -1].any()

    def test_region_of_a_lower_level_is_a_piece_of_that_of_a_higher_one(self) -> None:
        picture, inside = two_things()
        tree = Hierarchy().tree(picture)
        sizes = [place(*propose_region(tree, STROKE[1:2], 3, level)).sum() for level in (0.05, 0.6, 1.0)]
        assert sizes[0] < 0.5 * inside.sum()
        assert sizes[0] < sizes[1] < sizes[2] == picture[..., 0].size

    def test_stroke_over_two_regions_takes_both(self) -> None:
        labels = np.zeros((20, 30), np.int32)
        labels[:, 10:20], labels[:, 20:] = 1, 2
        tree = SegmentTree(labels, np.array([[0, 1], [2, 3]], np.int32), np.float32([0.4, 0.8]))
        both = np.array([[14.0, 10.0], [25.0, 10.0]])
        assert propose_region(tree, both, 1, 0.3)[0] == (10, 0, 20, 20)
        most = np.array([[11.0, 10.0], [21.0, 10.0]])
        assert propose_region(tree, most, 1, 0.3)[0] == (10, 0, 12, 20), "the stroke itself and one region"
        assert propose_region(tree, most, 1, 0.3, [12, 5, 18, 9])[0][1] >= 5
        assert propose_region(tree, most[:1], 1, 0.5)[0] == (0, 0, 20, 20)

    def test_regions_find_objects_in_photographs_by_one_click(self) -> None:
        """Overlap with parts drawn by hand, of one click in the middle of each, at the best of five levels."""
        shares = [
            max(
                overlap(
                    place(*propose_region(tree, stroke.mean(axis=0, keepdims=True), width, level), mask.shape), mask
                )
                for level in (0.2, 0.4, 0.6, 0.7, 0.8)
            )
            for name in ("astronaut", "coffee")
            for tree in [Hierarchy().tree(drawn(name).picture)]
            for _, mask in things(name)
            for stroke, width in [stroke_along(mask)]
            for middle in [stroke.mean(axis=0, keepdims=True)]
        ]
        assert np.mean(shares) > 0.65

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

    def test_rim_is_where_the_picture_goes_on(self) -> None:
        none = np.zeros((9, 12), bool)
        for window, sides in (
            (proposals.Window(0, 0, 320, 240), [False, False, False, False]),
            (proposals.Window(0, 100, 320, 140), [True, False, False, False]),
            (proposals.Window(100, 0, 220, 200), [False, True, True, False]),
            (proposals.Window(0, 0, 300, 240), [False, False, False, True]),
        ):
            rim = proposals._rim(window, none, SHAPE)
            assert [bool(each) for each in (rim[0, 5], rim[-1, 5], rim[5, 0], rim[5, -1])] == sides

    @pytest.mark.parametrize(
        ("point", "size", "row", "column"),
        [
            ((12.4, 23.4), (8, 6), 3, 2),  # pixels have their middles at whole numbers
            ((12.6, 22.6), (8, 6), 3, 3),
            ((13.4, 23.4), (4, 3), 1, 1),  # a pixel of the small grid has two by two of the picture
            ((13.6, 23.6), (4, 3), 2, 2),
        ],
    )
    def test_thin_stroke_is_drawn_on_the_pixel_below_it(
        self, point: tuple[float, float], size: tuple[int, int], row: int, column: int
    ) -> None:
        window = proposals.Window(10, 20, 8, 6)
        drawn = proposals._draw_stroke(np.array([point]), 1.0, window, size)
        assert np.argwhere(drawn).tolist() == [[row, column]]

    def test_proposal_ignores_a_box_that_the_stroke_leaves(self) -> None:
        picture, inside = two_things()
        assert overlap(place(*propose(picture, STROKE, 12, "grabcut", [0, 0, 20, 20])), inside) > 0.95

    @pytest.mark.parametrize("kind", ["grabcut", "watershed"])
    @pytest.mark.parametrize("shape", [(1, 1), (1, 40), (3, 3), (40, 1), (60, 80)])
    def test_proposal_in_a_flat_or_tiny_picture_contains_the_stroke(
        self, kind: proposals.Kind, shape: tuple[int, int]
    ) -> None:
        picture = np.full((*shape, 3), 128, np.uint8)
        points = as_points([[0, 0], [1e9, -1e9]], picture.shape)
        box, mask = propose(picture, points, 3, kind)
        found = place(box, mask, shape)
        assert found[0, 0]
        assert found[0, -1]

    def test_proposal_of_a_stroke_over_everything_is_everything(self) -> None:
        picture, _ = two_things()
        box, mask = propose(picture, STROKE, 1e6, "grabcut")
        assert box == (0, 0, 320, 240)
        assert mask.all()

    def test_runs_encode_the_mask(self) -> None:
        for mask in (np.array([[True, False], [False, True]]), np.array([[False, True, True]]), np.ones((2, 2), bool)):
            inside = np.repeat(np.arange(len(runs(mask))) % 2, runs(mask))
            np.testing.assert_array_equal(inside.reshape(mask.shape), mask)

    @pytest.mark.parametrize("points", [[], [[1.0]], [[1.0, 2.0, 3.0]], [[float("nan"), 1.0]], [[1.0, 2.0], []]])
    def test_invalid_stroke_is_refused(self, points: list[list[float]]) -> None:
        with pytest.raises(ConfigError, match="at least one"):
            as_points(points, (*SHAPE, 3))


class TestSnapping:
    def wobbling(self, around: np.ndarray, by: float) -> np.ndarray:
        outlines, _ = cv2.findContours(around.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        points = outlines[0][:, 0].astype(float)
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
        still = snap(np.full((*SHAPE, 3), 90, np.uint8), outline, 12.0)
        far = np.min(np.hypot(*(still[:, None] - outline[None]).transpose(2, 0, 1)), axis=1)
        assert far.max() < 1.0

    def test_outline_in_the_corner_of_a_wide_picture_stays_there(self) -> None:
        corner = np.array([[290.0, 200.0], [325.0, 200.0], [325.0, 245.0], [290.0, 245.0]])
        found = snap(np.full((*SHAPE, 3), 90, np.uint8), corner, 3.0)
        assert np.ptp(found, axis=0) == pytest.approx([29, 39], abs=3)
        assert found.max(axis=0).tolist() == [319, 239]

    @pytest.mark.parametrize(
        "points", [[[5, 5]], [[5, 5], [5, 5], [5, 5]], [[0, 0], [319, 0]], [[1, 1], [2, 1], [2, 2]]]
    )
    def test_degenerate_outline_stays_in_the_picture(self, points: list[list[float]]) -> None:
        picture, _ = two_things()
        found = snap(picture, np.array(points, float), 12.0)
        assert np.isfinite(found).all()
        assert (found >= 0).all()
        assert (found <= [319, 239]).all()


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

"""What networks see stands out, rounded and never too steep; else a person is a cliff, or nothing."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from onnx_models import mono
from tangible_core import Pipeline, Scene
from tangible_core.data import DisparityMap, Figure, PartMap, Views
from tangible_core.errors import ConfigError, ModelAbsent, PictureError
from tangible_core.pipeline.output.export_result import Exported
from tangible_core.pipeline.output.exporting import flatten_ground
from tangible_core.relief import ReliefChoice, figure_relief
from tangible_core.relief.figure import BODY, FACE, GROOVE_M, GROUND, STEP
from tangible_core.scene.workspace import FeltSize, Workspace
from tangible_depth import Cues, Luminance

SHAPE = (240, 320)
SIZE: FeltSize = Workspace().size("figure")
ROW, COLUMN = np.mgrid[: SHAPE[0], : SHAPE[1]]
DISK = np.hypot(ROW - 120, COLUMN - 160) < 90
VIEWS = Views(np.full((*SHAPE, 3), 128, np.uint8))


def heights(seen: Figure, slope: float = 0.0, views: Views = VIEWS) -> np.ndarray:
    return figure_relief(views, seen, SIZE, ReliefChoice(by="figure", slope=slope)).height_m


def face(centre: tuple[float, float], radius: float) -> np.ndarray:
    """The points of a face that is a half ball, in pixels."""
    angle, share = np.arange(468) * 2.399963, np.sqrt(np.arange(468) / 467)
    across = radius * share[:, None] * np.stack([np.cos(angle), np.sin(angle)], 1)
    return np.column_stack([across + centre, np.sqrt(radius**2 - (across**2).sum(1)).clip(0)]).astype(np.float32)


def test_figure_stands_on_a_ground_that_rises_to_the_viewer() -> None:
    height_m = heights(Figure(DISK.astype(np.float32)))
    assert height_m[120, 160] == pytest.approx((STEP + BODY) * SIZE.relief_m, rel=0.02), "level in its middle"
    assert height_m[0, 0] == pytest.approx(0, abs=1e-5)
    assert height_m[-1, 0] == pytest.approx(GROUND * SIZE.relief_m, rel=0.02)
    from_rim = height_m[120, 80:160]
    assert (np.diff(from_rim) > -1e-6).all(), "rounded: it rises from the rim to the middle"
    assert from_rim[5] < 0.9 * from_rim[-1]


@pytest.mark.parametrize("slope", [0.5, 1.1])
def test_nowhere_steeper_than_asked(slope: float) -> None:
    seen = Figure(DISK.astype(np.float32), DISK.astype(np.float32), face((160, 120), 40)[None])
    height_m = heights(seen, slope)
    pitch_m = SIZE.width_m / SHAPE[1]
    assert max(np.abs(np.diff(height_m, axis=axis)).max() for axis in (0, 1)) <= 1.03 * slope * pitch_m


def test_borders_are_grooves() -> None:
    line = np.zeros(SHAPE, np.float32)
    line[:, 158:163] = 1
    depth_m = heights(Figure(None, line))[0, 100] - heights(Figure(None, line))[0, 160]
    assert depth_m == pytest.approx(GROOVE_M, rel=0.1)


def test_faces_have_their_shape_and_are_higher_than_the_head() -> None:
    ball = face((160, 120), 40)
    plain, faced = (
        heights(Figure(DISK.astype(np.float32))),
        heights(Figure(DISK.astype(np.float32), faces_px=ball[None])),
    )
    scale = (faced[120, 160] - faced[120, 136]) / (SIZE.width_m / SHAPE[1] * (40 - np.sqrt(40**2 - 24**2)))
    share = FACE * SIZE.relief_m / (40 * SIZE.width_m / SHAPE[1])
    assert scale == pytest.approx(share, rel=0.1), "a lower ball, as high as the share of the height allows"
    middle = (faced[120, 160] - faced[120, 148]) / (SIZE.width_m / SHAPE[1] * (40 - np.sqrt(40**2 - 12**2)))
    assert middle == pytest.approx(scale, rel=0.15), "of the same proportions everywhere"
    assert np.abs(np.diff(faced[120])).max() < 1.5 * np.abs(np.diff(plain[120])).max()
    assert np.array_equal(faced[:70], plain[:70]), "nothing else changes"
    pair = np.stack([face((120, 120), 25), face((200, 120), 25)])
    height_m = heights(Figure(DISK.astype(np.float32), faces_px=pair))
    assert min(height_m[120, 120], height_m[120, 200]) > height_m[120, 160] + 0.0003


def test_depth_shapes_the_figure_without_spikes_at_its_outline() -> None:
    rim = np.abs(np.hypot(ROW - 120, COLUMN - 160) - 90) < 2
    nearness = np.where(DISK, 0.6 + 0.001 * COLUMN, 0.001 * ROW) + 3 * rim
    size, choice = SIZE._replace(smooth_m=0.0), ReliefChoice(by="figure", slope=0)
    height_m = figure_relief(VIEWS, Figure(DISK.astype(np.float32)), size, choice, DisparityMap(nearness)).height_m
    assert height_m.max() <= (STEP + BODY) * SIZE.relief_m * 1.001
    assert (np.diff(height_m[120, 80:240]) > -1e-6).all(), "nearer to the right, up to the rim"
    assert height_m[120, 235] - height_m[120, 85] == pytest.approx(BODY * SIZE.relief_m, rel=0.15)
    assert np.ptp(height_m[:, :60].max(axis=1)) == pytest.approx(GROUND * SIZE.relief_m, rel=0.1)


def test_flat_things_and_boards_are_level_and_a_pole_is_not() -> None:
    nearness = np.where(DISK, 0.9 + 0.00001 * COLUMN, 0.001 * ROW)
    height_m = figure_relief(
        VIEWS, Figure(DISK.astype(np.float32)), SIZE, ReliefChoice(by="figure"), DisparityMap(nearness)
    ).height_m
    assert np.ptp(height_m[80:160, 120:200]) < 0.1 * BODY * SIZE.relief_m
    board, pole = np.zeros(SHAPE, np.float32), np.zeros(SHAPE, np.float32)
    board[40:200, 60:260] = pole[40:200, 150:170] = 1
    top_m = (STEP + BODY) * SIZE.relief_m
    assert heights(Figure(board))[45:195, 65:255].min() == pytest.approx(top_m, rel=0.02)
    assert heights(Figure(pole))[40:200].max() < 0.8 * top_m
    assert np.ptp(heights(Figure(np.ones(SHAPE, np.float32)))) < 1e-6, "all of the picture"


@pytest.mark.parametrize("shape", [(1, 1), (1, 50), (3, 2)])
def test_small_pictures(shape: tuple[int, int]) -> None:
    views = Views(np.zeros(shape, np.uint8))
    seen = Figure(np.ones(shape, np.float32), np.ones(shape, np.float32), face((0, 0), 40)[None])
    height_m = heights(seen, 1.1, views)
    assert height_m.shape == shape
    assert np.isfinite(height_m).all()


def test_maps_of_two_sizes_are_refused() -> None:
    with pytest.raises(PictureError):
        Figure(np.zeros((2, 2), np.float32), np.zeros((3, 2), np.float32))


class TestPipeline:
    @pytest.fixture
    def models(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
        monkeypatch.setenv("TANGIBLE_MODELS_DIR", str(tmp_path))
        return tmp_path

    def test_figure_changes_with_its_network_and_stays_apart(self, models: Path) -> None:
        picture = np.zeros((*SHAPE, 3), np.uint8)
        picture[DISK] = 255
        with pytest.raises(ModelAbsent, match="tangible networks add"):
            _ = Pipeline(Scene.photo(picture), relief="figure").relief
        mono(models / "own.onnx")
        (models / "own.yaml").write_text("task: figure\noutput: {means: figure}\n")
        pipeline = Pipeline(Scene.photo(picture), relief="figure")
        assert pipeline.relief.height_m[120, 160] > 0.5 * pipeline.relief.height_m.max()
        (models / "own.onnx").unlink()
        with pytest.raises(ModelAbsent):
            _ = Pipeline(Scene.photo(picture), relief="figure").relief
        picture = np.full((*SHAPE, 3), 120, np.uint8)
        picture[:120] = 0
        labels = np.where(DISK, 2, picture[..., 0] // 120).astype(np.int32)
        picture[DISK] = 130

        def simplified(relief: str) -> PartMap:
            scene = Scene.photo(picture, segments=labels)
            return Pipeline(scene, relief=relief, simplify={"textures": 2}, workspace={"width_m": 0.2}).make(
                "simplified"
            )

        for relief, network, apart in (("figure", False, False), ("edges", True, False), ("figure", True, True)):
            if network:
                mono(models / "own.onnx")
                (models / "own.yaml").write_text("task: figure\noutput: {means: figure}\n")
            found = simplified(relief)
            rows, columns = found.labels.shape
            middle, below = (found.segments[found.labels[row, columns // 2]] for row in (rows // 2, rows - 9))
            assert (middle != below) == apart

    def test_cut_out_leaves_the_ground_away(self, models: Path) -> None:
        picture = np.zeros((*SHAPE, 3), np.uint8)
        picture[DISK] = 255
        picture[:20] = 100

        def write(shown: np.ndarray) -> Exported:
            pipeline = Pipeline(Scene.photo(shown), relief="edges")
            return pipeline.export(models / "out", "heights", cut_out=True, force=True).exports[0]

        assert "tangible networks add figure" in write(picture).outcome.why
        mono(models / "own.onnx")
        (models / "own.yaml").write_text("task: figure\noutput: {means: figure}\n")
        height_mm = np.asarray(Image.open(write(picture).files[2]))
        assert (height_mm[~DISK] == 0).all()
        assert height_mm[DISK].max() > 1
        assert "nothing stands out" in write(picture // 4).outcome.why
        parts = PartMap((picture[..., 0] // 100).astype(np.int32), (0, 1, 2))
        cut = flatten_ground(parts, Figure(DISK.astype(np.float32)))
        assert np.array_equal(cut.labels, np.where(DISK, 2, 3))

    def test_depth_of_a_method_shapes_the_figure_and_wrong_words_are_told(self, models: Path) -> None:
        mono(models / "own.onnx")
        (models / "own.yaml").write_text("task: figure\noutput: {means: figure}\n")
        scene = Scene.photo(np.where(DISK, 255, 0).astype(np.uint8))
        for depth, outcome in ((Luminance(), None), (Cues(), "ran")):
            plan = Pipeline(scene, relief="figure", depth=depth).plan("relief")
            assert {step.product: step.outcome for step in plan.steps}.get("disparity") == outcome
        with pytest.raises(ConfigError, match="figure"):
            Pipeline(Scene.builtin("builtin/brick"), relief="figur")

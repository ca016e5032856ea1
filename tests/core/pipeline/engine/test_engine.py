"""The engine, on methods of its own that count how often they run."""

import contextlib
import logging
from itertools import count
from pathlib import Path
from time import perf_counter
from typing import ClassVar

import numpy as np
import pluggy
import pytest

from pictures import write_png
from tangible_core.data import DeviceSpec, DisparityMap, Force, HapticState, HapticSurface, Note, SegmentMap, Views
from tangible_core.errors import BrokenMethod, ConfigError, GeometryError, PictureError, UnknownMethod
from tangible_core.pipeline.config.material_choice import MaterialChoice
from tangible_core.pipeline.config.methods import NamedMethod
from tangible_core.pipeline.config.model import PipelineConfig
from tangible_core.pipeline.engine.cache import Cache
from tangible_core.pipeline.engine.engine import Engine
from tangible_core.plugins import hooks
from tangible_core.plugins.interfaces import (
    DepthEstimator,
    ForceRenderer,
    HapticDevice,
    Link,
    PlainTouch,
    Segmenter,
    Skippable,
    Touch,
)
from tangible_core.plugins.notes import doubt, note
from tangible_core.plugins.registry import Registry
from tangible_core.relief import ReliefChoice
from tangible_core.scene import pair_checks
from tangible_core.scene.scene import Scene
from tangible_core.scene.scene_files import SceneFiles
from tangible_core.scene.workspace import Workspace

ran: list[str] = []


class Ramp(DepthEstimator):
    """Disparity grows from left to right."""

    slope: float = 1.0

    def estimate(self, views: Views) -> DisparityMap:
        ran.append("disparity")
        return DisparityMap(np.tile(np.arange(views.shape[1], dtype=np.float32) * self.slope, (views.shape[0], 1)))


class Never(DepthEstimator, Skippable):
    """A depth method that every scene skips."""

    def skip(self, views: Views) -> str | None:
        return "nothing to see"

    def estimate(self, views: Views) -> DisparityMap:
        raise AssertionError("it was to be skipped")


class Halves(Segmenter):
    """A segmenter of a left and a right half."""

    def segment(self, picture: np.ndarray) -> SegmentMap:
        ran.append("segments")
        labels = np.zeros(picture.shape[:2], np.int32)
        labels[:, picture.shape[1] // 2 :] = 1
        return SegmentMap(labels)


class Says(Segmenter):
    """Leaves something out, and says so."""

    def segment(self, picture: np.ndarray) -> SegmentMap:
        note(logging.getLogger("tests"), "skipped: everything")
        return SegmentMap(np.zeros(picture.shape[:2], np.int32))


class Shrinks(Segmenter):
    """Labels a part of the picture."""

    def segment(self, picture: np.ndarray) -> SegmentMap:
        return SegmentMap(np.zeros((picture.shape[0] // 2, picture.shape[1]), np.int32))


class Grows(DepthEstimator):
    """A disparity for a larger picture."""

    def estimate(self, views: Views) -> DisparityMap:
        return DisparityMap(np.zeros((views.shape[0], views.shape[1] + 3), np.float32))


class Fails(Segmenter):
    """Raises what a plugin may raise."""

    def segment(self, picture: np.ndarray) -> SegmentMap:
        raise ZeroDivisionError("a bug of its own")


class Knowing(PlainTouch):
    """A touch that feels nothing, and knows its surface."""

    def __init__(self, surface: HapticSurface) -> None:
        self.surface = surface

    def force(self, state: HapticState) -> Force:
        return Force(0.0, 0.0, 0.0)


class Feel(ForceRenderer):
    """A law with materials."""

    def touch(self, surface: HapticSurface) -> Touch:
        ran.append("touch")
        return Knowing(surface)


class FeelHeights(ForceRenderer):
    """A law without materials."""

    uses_materials: ClassVar[bool] = False

    def touch(self, surface: HapticSurface) -> Touch:
        return Knowing(surface)


@pytest.fixture(autouse=True)
def forget():
    ran.clear()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    picture = np.random.default_rng(0).integers(0, 255, (20, 30), dtype=np.uint8)
    write_png(tmp_path / "left.png", picture)
    write_png(tmp_path / "right.png", picture[:, ::-1])
    np.save(tmp_path / "heights.npy", np.tile(np.arange(30.0), (20, 1)))
    return tmp_path


def name_method(method, name: str = ""):
    return NamedMethod(name or type(method).__name__.lower(), "tests 1.0", method)


def pipeline(folder: Path, cached: bool = True, plugins: pluggy.PluginManager | None = None, **parts) -> Engine:
    parts = {
        "scene": SceneFiles(left=Path("left.png"), right=Path("right.png")),
        "want": "touch",
        "depth": name_method(Ramp()),
        "texture": name_method(Halves()),
        "materials": MaterialChoice(by={0: "ice", 1: "sand"}),
        "render": name_method(Feel()),
    } | parts
    plugins = plugins or hooks.manager()
    config = PipelineConfig(path=folder / "p.yaml", **parts)
    return Engine(config, Registry(plugins), Cache(folder / "cache") if cached else None)


def outcome_kinds(pipe: Engine) -> dict[str, str]:
    return {each.product: each.outcome for each in pipe.outcomes}


class Soft(HapticDevice):
    """A device that holds no more than so many newtons a metre."""

    most_n_per_m: float

    def spec(self) -> DeviceSpec:
        return DeviceSpec(9.0, self.most_n_per_m, 1.0, (0.2, 0.2, 0.2), 1e-5)

    def open(self) -> Link:
        raise AssertionError("no touch needs it open")


def test_touch_on_another_device_is_limited_by_that_device_and_shares_all_else(folder: Path):
    pipe = pipeline(folder, device=name_method(Soft(most_n_per_m=50.0)))
    touches = [pipe.make(), pipe.touch_on(Soft(most_n_per_m=20.0)), pipe.touch_on(Soft(most_n_per_m=90.0)), pipe.make()]
    assert ran == ["disparity", "segments", "touch", "touch", "touch"], "the own touch is not made again"
    limits = [{each.stiffness_n_per_m for each in touch.surface.materials} for touch in touches]
    assert limits == [{40.0}, {16.0}, {72.0}, {40.0}], "the safety margin is 0.8"
    assert touches[3] is touches[0]
    assert min(each.stiffness_n_per_m for each in pipe.make("surface").materials) > 90.0, "ice and sand as they are"


def test_touch_on_a_device_leaves_its_products_to_the_engine(folder: Path):
    pipe = pipeline(folder)
    pipe.touch_on(Soft(most_n_per_m=20.0))
    stiffest = max(each.stiffness_n_per_m for each in pipe.make().surface.materials)
    assert stiffest > 20.0
    assert ran == ["disparity", "segments", "touch", "touch"]


def test_engine_with_other_products_makes_what_depends_on_them_and_neither_keeps_nor_tells_it(folder: Path):
    told = list[str]()

    class Listening:
        @hooks.hookimpl
        def tangible_stage_started(self, product, method):
            told.append(product)

        @hooks.hookimpl
        def tangible_stage_finished(self, outcome):
            told.append(outcome.product)

    plugins = hooks.manager()
    plugins.register(Listening())
    pipe = pipeline(folder, plugins=plugins, workspace=Workspace(width_m=0.03, relief_m=0.01, smooth_m=0))
    first, kept, heard = pipe.make().surface, set((folder / "cache").iterdir()), list(told)
    down = DisparityMap(np.ascontiguousarray(np.tile(np.arange(20, dtype=np.float32)[:, None], (1, 30))))
    other = pipe.with_products(disparity=down)
    second = other.make().surface
    assert ran == ["disparity", "segments", "touch", "touch"], "segments and materials are shared"
    assert (first.height_m[0, 0], first.height_m[-1, 0], first.height_m[0, -1]) == pytest.approx((0, 0, 0.01), abs=1e-6)
    assert (second.height_m[0, 0], second.height_m[-1, 0], second.height_m[0, -1]) == pytest.approx(
        (0, 0.01, 0), abs=1e-6
    )
    assert other.make("disparity") is down
    assert other.make("segments") is pipe.make("segments")
    assert (set((folder / "cache").iterdir()), told) == (kept, heard)
    assert pipe.make().surface is first
    assert "disparity" not in {each.product for each in other.outcomes if each.outcome == "ran"}


def test_make_makes_each_needed_product_once(folder: Path):
    pipe = pipeline(folder)
    surface = pipe.make().surface
    assert ran == ["disparity", "segments", "touch"]
    assert [material.name for material in surface.materials] == ["ice", "sand"]
    made = ("disparity", "relief", "segments", "materials", "surface", "touch")
    assert outcome_kinds(pipe) == {"views": "given", **dict.fromkeys(made, "ran")}
    pipe.make("relief")
    assert ran == ["disparity", "segments", "touch"]


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        ({"texture": name_method(Shrinks(), "halved")}, "texture method halved (tests 1.0) made labels of 30 x 10"),
        ({"depth": name_method(Grows(), "more")}, "depth method more (tests 1.0) made disparity of 33 x 20"),
    ],
)
def test_result_of_another_size_is_refused(folder: Path, parts: dict, says: str):
    with pytest.raises(BrokenMethod) as error:
        pipeline(folder, **parts).make("surface")
    assert str(error.value).startswith(f"{says} for a picture of 30 x 20; ")
    coarse = Workspace(width_m=0.03, finest_m=0.002)
    with pytest.raises(BrokenMethod, match="for a picture of 15 x 10; `tangible check "):
        pipeline(folder, workspace=coarse, **parts).make("surface")


def test_make_leaves_out_products_that_nothing_needs(folder: Path):
    pipe = pipeline(folder)
    pipe.make("relief")
    assert ran == ["disparity"]
    left = {each.product: each.why for each in pipe.outcomes if each.outcome == "skipped"}
    assert left == dict.fromkeys(("segments", "materials", "surface", "touch"), "not needed for what was requested")


def test_outcome_has_the_notes_of_a_method(folder: Path):
    pipe = pipeline(folder, texture=name_method(Says()))
    pipe.make("segments")
    [outcome] = [each for each in pipe.outcomes if each.product == "segments"]
    assert outcome.why == "requested; skipped: everything"


class Warns(Ramp):
    """A depth method with a warning."""

    def estimate(self, views: Views) -> DisparityMap:
        note(logging.getLogger("tests"), "every row is strange", logging.WARNING)
        doubt(logging.getLogger("tests"), "hardly worth it")
        return super().estimate(views)


def test_outcome_of_a_cached_product_repeats_its_notes(folder: Path, caplog: pytest.LogCaptureFixture):
    parts = {"depth": name_method(Warns()), "texture": name_method(Says()), "materials": MaterialChoice(by={0: "ice"})}
    noticed = [Note("every row is strange", "warning"), Note("hardly worth it", "doubt")]
    first = pipeline(folder, **parts)
    first.make("disparity")
    first.make("surface")
    for want in ("disparity", "surface"):  # of the second, only the surface is read, and holds what it is made from
        caplog.clear()
        again = pipeline(folder, **parts)
        assert again.plan(want).steps[-1].notes == tuple(noticed)
        again.make(want)
        told = {each.product: each for each in again.outcomes}
        assert outcome_kinds(again)["disparity"] == ("cached" if want == "disparity" else "skipped")
        assert list(told["disparity"].notes) == noticed
        assert told["disparity"].why.endswith("; every row is strange; hardly worth it")
        assert [each.message for each in caplog.records] == ["every row is strange", "hardly worth it"]
    assert told["segments"].why == "within an unchanged product; skipped: everything"
    again.make("disparity")
    assert len(caplog.records) == 2  # and not told twice


def test_outcome_of_views_has_the_notes_on_their_files(folder: Path, monkeypatch: pytest.MonkeyPatch):
    def read(*_: object) -> Scene:
        note(logging.getLogger("tests"), "the first of 3 frames is taken", logging.WARNING)
        return Scene.photo(np.zeros((4, 4)))

    monkeypatch.setattr(Scene, "read", read)
    pipe = pipeline(folder)
    pipe.make("segments")
    assert pipe.outcomes[0].notes == (Note("the first of 3 frames is taken", "warning"),)
    assert pipe.outcomes[0].why.startswith("provided by the scene ")
    assert pipe.outcomes[0].why.endswith("; the first of 3 frames is taken")


def test_views_ordered_as_named_are_not_exchanged(folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(pair_checks, "view_order", lambda *_: pair_checks.ViewOrder(True, "exchanged"))
    paths = {"left": Path("left.png"), "right": Path("right.png")}
    found = pipeline(folder, scene=SceneFiles(**paths), depth=name_method(Ramp(slope=-3.0))).make("disparity")
    assert np.nanmax(found.disparity_px) == 87
    found = pipeline(folder, scene=SceneFiles(**paths, order="as-named"), depth=name_method(Ramp(slope=-3.0)))
    assert np.nanmax(found.make("disparity").disparity_px) == 0


def test_second_run_takes_the_surface_from_the_cache(folder: Path):
    pipeline(folder).make()
    ran.clear()
    again = pipeline(folder)
    again.make()
    assert ran == ["touch"]
    assert outcome_kinds(again)["surface"] == "cached"
    assert outcome_kinds(again)["disparity"] == "skipped"
    assert again.make("disparity") is not None
    assert outcome_kinds(again)["disparity"] == "cached"


def test_outcomes_tell_no_more_time_than_passed(folder: Path):
    told = set[str]()
    for parts in ({}, {}, {"texture": name_method(Fails()), "want": "segments"}):
        pipe, begun_s = pipeline(folder, **parts), perf_counter()
        with contextlib.suppress(ZeroDivisionError):
            pipe.make()
        passed_s = perf_counter() - begun_s
        timed = [each for each in pipe.outcomes if each.outcome != "skipped"]
        told.update(each.outcome for each in timed)
        assert all(0 <= each.seconds <= passed_s for each in timed)
    assert told == {"given", "ran", "cached", "failed"}


def test_outcomes_tell_the_time_of_their_own_making(folder: Path, monkeypatch: pytest.MonkeyPatch):
    """By a clock that goes on by a second whenever it is read: once before and once after each."""
    monkeypatch.setattr("tangible_core.pipeline.engine.engine.perf_counter", count().__next__)
    told = list[tuple[str, float]]()
    for parts in ({}, {}, {"texture": name_method(Fails()), "want": "segments"}):
        pipe = pipeline(folder, **parts)
        with contextlib.suppress(ZeroDivisionError):
            pipe.make()
        told += [(each.outcome, each.seconds) for each in pipe.outcomes if each.outcome != "skipped"]
    assert set(told) == {("given", 1), ("ran", 1), ("cached", 1), ("failed", 1)}


@pytest.mark.parametrize(
    "change",
    [
        {"depth": name_method(Ramp(slope=2.0))},
        {"depth": NamedMethod("ramp", "tests 1.1", Ramp())},
        {"scene": SceneFiles(left=Path("right.png"), right=Path("left.png"))},
    ],
    ids=["an option", "another version of its distribution", "another scene"],
)
def test_changed_input_is_never_answered_from_the_cache(folder: Path, change: dict):
    pipeline(folder).make("disparity")
    ran.clear()
    pipe = pipeline(folder, **change)
    pipe.make("disparity")
    assert ran == ["disparity"]


def test_changed_option_keeps_earlier_products_cached(folder: Path):
    pipeline(folder).make()
    ran.clear()
    pipe = pipeline(folder, materials=MaterialChoice(by={0: "sand", 1: "ice"}))
    pipe.make()
    assert ran == ["touch"]
    assert outcome_kinds(pipe)["relief"] == "cached"
    assert outcome_kinds(pipe)["surface"] == "ran"


def test_engine_without_a_cache_runs_everything(folder: Path):
    for _ in range(2):
        pipeline(folder, cached=False).make("disparity")
    assert ran == ["disparity"] * 2


def test_scene_with_a_disparity_runs_no_stereo(folder: Path):
    np.save(folder / "d.npy", np.full((20, 30), 3.0, np.float32))
    files = SceneFiles(left=Path("left.png"), right=Path("right.png"), disparity=Path("d.npy"))
    pipe = pipeline(folder, scene=files)
    pipe.make("relief")
    assert ran == []
    assert outcome_kinds(pipe)["disparity"] == "given"


def test_scene_with_heights_runs_no_depth_and_no_texture(folder: Path):
    pipe = pipeline(folder, scene=SceneFiles(height=Path("heights.npy")))
    surface = pipe.make("surface")
    assert ran == []
    assert surface.height_m.max() == pytest.approx(0.02)
    assert outcome_kinds(pipe)["relief"] == "given"
    assert outcome_kinds(pipe)["segments"] == "skipped"


def test_skipped_depth_makes_a_flat_relief(folder: Path):
    pipe = pipeline(folder, depth=name_method(Never()))
    relief = pipe.make("relief")
    assert np.ptp(relief.height_m) == 0
    why = {each.product: each.why for each in pipe.outcomes}
    assert why["disparity"] == "nothing to see"


def test_relief_of_a_frame_has_the_scale_of_another_where_it_is_given(folder: Path):
    size = Workspace(width_m=0.03, relief_m=0.01, smooth_m=0)
    stage = pipeline(folder, workspace=size, relief=ReliefChoice(slope=0, spread=0, accent_m=0, grain_m=0)).stages[
        "relief"
    ]
    far = np.tile(np.linspace(0, 8, 30, dtype=np.float32), (20, 1))
    near, half = DisparityMap(2 * far), DisparityMap(far)
    assert stage.from_disparity(half).height_m.max() == pytest.approx(0.01)
    assert stage.from_disparity(half, stage.scale(near)).height_m.max() == pytest.approx(0.005, rel=0.02)
    assert stage.from_disparity(near, stage.scale(half)).height_m[:, 15:].min() == pytest.approx(0.01, rel=0.02)


def test_law_without_materials_runs_no_texture(folder: Path):
    pipe = pipeline(folder, render=name_method(FeelHeights()))
    assert pipe.make().surface.materials is None
    assert "segments" not in ran


@pytest.mark.parametrize(
    "parts", [{}, {"depth": name_method(Never())}, {"texture": None}, {"render": name_method(FeelHeights())}]
)
def test_plan_equals_the_outcomes(folder: Path, parts: dict):
    foreseen = {each.product: each.outcome for each in pipeline(folder, **parts).plan().steps}
    assert ran == []
    pipe = pipeline(folder, **parts)
    pipe.make()
    happened = {each.product: each.outcome for each in pipe.outcomes if "not needed" not in each.why}
    assert {name: foreseen.get(name, "skipped") for name in happened} == happened
    for again in (pipeline(folder, cached=False, **parts), pipeline(folder, **parts)):
        steps, _ = again.plan().steps, again.make()
        told = {each.product: each for each in again.outcomes}
        assert [(each.outcome, each.method) for each in steps] == [
            (told[each.product].outcome, told[each.product].method) for each in steps
        ]
        foretold = {each.product: each.why.partition("; the relief is flat")[0] for each in steps}  # a skipped depth
        assert all(told[name].why.startswith(why) for name, why in foretold.items()), "notes are known afterwards"
    assert {each.product: each.outcome for each in pipeline(folder, **parts).plan().steps}["surface"] == "cached"


def test_failed_stage_is_noted_and_not_kept(folder: Path):
    pipe = pipeline(folder, texture=name_method(Fails()))
    with pytest.raises(ZeroDivisionError):
        pipe.make()
    assert {each.product: each.why for each in pipe.outcomes}["segments"] == "ZeroDivisionError: a bug of its own"
    assert outcome_kinds(pipe)["segments"] == "failed"
    assert pipe.key("segments") not in pipe.cache


def test_missing_method_is_refused_with_the_cure(folder: Path):
    with pytest.raises(ConfigError, match=r"p\.yaml: `render:` is missing"):
        pipeline(folder, render=None).make()


class Pairs(Ramp):
    """Finds nothing in one picture."""

    needs_pair: ClassVar[bool] = True


@pytest.mark.parametrize(
    ("parts", "product", "error", "says"),
    [
        (
            {"scene": SceneFiles(photo=Path("left.png")), "depth": name_method(Pairs(), "pairs")},
            "disparity",
            PictureError,
            "depth method pairs needs two views, and the scene left.png has one",
        ),
        ({"depth": None}, "disparity", ConfigError, "`depth:` is missing"),
        ({"render": None}, "touch", ConfigError, "`render:` is missing"),
        (
            {"scene": SceneFiles(height=Path("heights.npy")), "want": "disparity"},
            "disparity",
            ConfigError,
            "no picture",
        ),
    ],
)
def test_plan_ends_with_a_refusal_before_anything_runs(folder: Path, parts: dict, product, error, says: str):
    plan = pipeline(folder, **parts).plan()
    assert (plan.steps[-1].product, plan.steps[-1].outcome) == (product, "refused")
    assert says in plan.refusal
    pipe = pipeline(folder, **parts)
    with pytest.raises(error) as raised:
        pipe.make()
    assert str(raised.value) == plan.refusal
    assert plan.refusal in [each.why for each in pipe.outcomes]
    assert ran == []
    assert outcome_kinds(pipe)[product] == "refused"
    assert not pipeline(folder).plan().refusal


def test_pair_is_not_needed_for_a_product_of_the_scene(folder: Path):
    np.save(folder / "d.npy", np.full((20, 30), 3.0, np.float32))
    files = SceneFiles(photo=Path("left.png"), disparity=Path("d.npy"))
    assert not pipeline(folder, scene=files, depth=name_method(Pairs())).plan("relief").refusal
    assert not pipeline(folder, scene=SceneFiles(photo=Path("left.png")), depth=None).plan("segments").refusal


def test_unknown_product_is_refused(folder: Path):
    with pytest.raises(UnknownMethod, match="did you mean 'surface'"):
        pipeline(folder).make("surfaces")


def test_wrong_geometry_is_an_error_of_the_user(folder: Path):
    np.save(folder / "heights.npy", np.full((4, 4), np.nan))
    with pytest.raises(GeometryError):
        pipeline(folder, scene=SceneFiles(height=Path("heights.npy"))).make("relief")


def test_observers_are_called_though_one_fails(folder: Path, caplog: pytest.LogCaptureFixture):
    heard: list[tuple[str, str]] = []

    class Good:
        @hooks.hookimpl
        def tangible_plan_made(self, plan):
            heard.append(("plan", plan.want))

        @hooks.hookimpl
        def tangible_stage_started(self, product, method):
            heard.append(("started", product))

        @hooks.hookimpl
        def tangible_stage_finished(self, outcome):
            heard.append((outcome.outcome, outcome.product))

    class Bad:
        @hooks.hookimpl
        def tangible_stage_finished(self, outcome):
            raise RuntimeError("always")

    plugins = hooks.manager()
    plugins.register(Good())
    plugins.register(Bad())
    pipe = pipeline(folder, plugins=plugins)
    pipe.plan("disparity")
    pipe.make("disparity")
    assert heard == [("given", "views"), ("plan", "disparity"), ("started", "disparity"), ("ran", "disparity")]
    assert "tangible_stage_finished" in caplog.text


def test_fine_pictures_are_matched_smaller_with_a_note(folder: Path):
    pipe = pipeline(folder, workspace=Workspace(width_m=0.03, finest_m=0.002))  # 30 columns of 1 mm
    disparity = pipe.make("disparity")
    assert disparity.disparity_px.shape == (20, 30)
    assert disparity.disparity_px[0, 15] == pytest.approx(15, abs=1)
    (why,) = [each.why for each in pipe.outcomes if each.product == "disparity"]
    reason = "at 1/2 of the size, as detail below 2 mm cannot be felt (`workspace: {finest_m: 0}` keeps everything)"
    assert why == f"requested; {reason}"
    whole = pipeline(folder, workspace=Workspace(width_m=0.03, finest_m=0))
    whole.make("disparity")
    assert "of the size" not in "".join(each.why for each in whole.outcomes)


def test_fine_photo_is_segmented_smaller_with_a_note(folder: Path):
    parts = {"scene": SceneFiles(photo=Path("left.png")), "depth": None}
    pipe = pipeline(folder, **parts, workspace=Workspace(width_m=0.03, finest_m=0.002))  # 30 columns of 1 mm
    segments = pipe.make("segments")
    assert segments.labels.tolist() == [[0] * 14 + [1] * 16] * 20  # half of 15 columns is 7
    (why,) = [each.why for each in pipe.outcomes if each.product == "segments"]
    assert (
        "at 1/2 of the size, as detail below 2 mm cannot be felt (`workspace: {finest_m: 0}` keeps everything)" in why
    )
    whole = pipeline(folder, **parts, workspace=Workspace(width_m=0.03, finest_m=0))
    assert whole.make("segments").labels.tolist() == [[0] * 15 + [1] * 15] * 20
    assert "of the size" not in "".join(each.why for each in whole.outcomes)


class TestWorkingGrid:
    """Thirty columns of 1 mm, of which 2 mm are felt."""

    COARSE = Workspace(width_m=0.03, relief_m=0.01, smooth_m=0, finest_m=0.002)

    def test_surface_is_as_coarse_and_as_large_in_metres(self, folder: Path):
        surface = pipeline(folder, workspace=self.COARSE).make("surface")
        assert surface.height_m.shape == surface.labels.shape == (10, 15)
        assert surface.extent_m == (0.03, 0.02)
        assert surface.labels.tolist() == [[0] * 7 + [1] * 8] * 10
        finest = Workspace(width_m=0.03, relief_m=0.01, smooth_m=0, finest_m=0)
        whole = pipeline(folder, workspace=finest).make("surface")
        assert whole.height_m.shape == whole.labels.shape == (20, 30)
        pairs = whole.height_m.reshape(10, 2, 15, 2).mean(axis=(1, 3))
        np.testing.assert_allclose(surface.height_m, pairs, atol=0.01 / 15)

    def test_disparity_on_the_grid_is_in_pixels_of_the_picture(self, folder: Path):
        found = pipeline(folder, workspace=self.COARSE).make_on_grid("disparity")
        assert found.disparity_px.tolist() == [[2.0 * column for column in range(15)]] * 10

    def test_full_size_products_of_the_scene_make_an_equally_coarse_surface(self, folder: Path):
        labels = np.zeros((20, 30), np.uint8)
        labels[:, 20:], labels[3, 4] = 2, 1  # one is smaller than can be felt, and keeps its material
        write_png(folder / "labels.png", labels)
        files = {"segments": Path("labels.png"), "disparity": Path("heights.npy")}
        pipe = pipeline(
            folder,
            scene=SceneFiles(photo=Path("left.png"), **files),
            workspace=self.COARSE,
            relief=ReliefChoice(slope=0, spread=0, accent_m=0, grain_m=0),
            materials=MaterialChoice(rules=[{"at": [4, 3], "material": "sand"}], by={0: "ice", 2: "wood"}),
        )
        surface = pipe.make("surface")
        assert [each.name for each in surface.materials] == ["ice", "sand", "wood"]
        assert surface.labels.tolist() == [[0] * 2 + [int(row == 1)] + [0] * 7 + [2] * 5 for row in range(10)]
        np.testing.assert_allclose(surface.height_m[0], np.linspace(0, 0.01, 15), atol=1e-8)
        assert pipe.make("segments").labels.shape == (20, 30)

    def test_heights_are_reduced_and_holes_stay_holes(self, folder: Path):
        heights = np.tile(np.arange(30.0), (20, 1))
        heights[4:6, 10:12], heights[8, 20] = np.nan, np.nan
        np.save(folder / "torn.npy", heights)
        parts = {"scene": SceneFiles(height=Path("torn.npy")), "texture": None}
        surface = pipeline(folder, **parts, workspace=self.COARSE.model_copy(update={"holes": "cut"})).make("surface")
        wanted = np.tile(np.linspace(0, 0.01, 15), (10, 1))
        wanted[2, 5] = 0
        np.testing.assert_allclose(surface.height_m, wanted, atol=0.0002)


def test_pixels_not_finite_are_an_error_or_a_mask_on_request(folder: Path):
    picture = np.random.default_rng(0).random((20, 30))
    np.save(folder / "whole.npy", picture)
    picture[3, 5] = np.nan
    np.save(folder / "torn.npy", picture)

    def scene(photo: str, non_finite: str = "mask") -> Engine:
        return pipeline(folder, scene=SceneFiles(photo=Path(photo), non_finite=non_finite))

    with pytest.raises(PictureError, match=r"torn\.npy.*the first at row 3, column 5"):
        scene("torn.npy", "error").make("segments")
    torn = scene("torn.npy")
    segments, disparity = torn.make("segments"), torn.make("disparity")
    assert np.argwhere(segments.confidence == 0).tolist() == [[3, 5]]
    assert np.argwhere(np.isnan(disparity.disparity_px)).tolist() == [[3, 5]]
    assert np.argwhere(disparity.confidence == 0).tolist() == [[3, 5]]
    assert scene("whole.npy").make("segments").confidence.min() == 1

"""The engine. Otherwise a user would feel what an older file said, or wait for what was made already."""

import logging
from itertools import count
from pathlib import Path
from typing import ClassVar

import numpy as np
import pluggy
import pytest

from pictures import write_png
from tangible_core.data import DeviceSpec, DisparityMap, Force, HapticState, HapticSurface, Note, SegmentMap, Views
from tangible_core.errors import BrokenMethod, ConfigError, PictureError, UnknownMethod
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
from tangible_core.scene.scene_files import SceneFiles
from tangible_core.scene.workspace import Workspace

ran = list[str]()
heard = list[tuple[str, str]]()


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
    heard.clear()


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
        "materials": MaterialChoice(by={1: "ice", 2: "sand"}),
        "render": name_method(Feel()),
    } | parts
    plugins = plugins or hooks.manager()
    config = PipelineConfig(path=folder / "p.yaml", **parts)
    return Engine(config, Registry(plugins), Cache(folder / "cache") if cached else None)


def outcome_kinds(pipe: Engine) -> dict[str, str]:
    return {outcome.product: outcome.outcome for outcome in pipe.outcomes}


class Soft(HapticDevice):
    """A device that holds no more than so many newtons a metre."""

    most_n_per_m: float

    def spec(self) -> DeviceSpec:
        return DeviceSpec(9.0, self.most_n_per_m, 1.0, (0.2, 0.2, 0.2), 1e-5)

    def open(self) -> Link:
        raise AssertionError("no touch needs it open")


class Listening:
    """Notes what hooks are called with."""

    @hooks.hookimpl
    def tangible_plan_made(self, plan):
        heard.append(("plan", plan.want))

    @hooks.hookimpl
    def tangible_stage_started(self, product, method):
        heard.append(("started", product))

    @hooks.hookimpl
    def tangible_stage_finished(self, outcome):
        heard.append((outcome.outcome, outcome.product))


def listening() -> pluggy.PluginManager:
    plugins = hooks.manager()
    plugins.register(Listening())
    return plugins


def test_touch_on_another_device_is_limited_by_that_device_and_shares_all_else(folder: Path):
    pipe = pipeline(folder, device=name_method(Soft(most_n_per_m=50.0)))
    touches = [pipe.make(), pipe.touch_on(Soft(most_n_per_m=20.0)), pipe.touch_on(Soft(most_n_per_m=90.0)), pipe.make()]
    assert ran == ["disparity", "segments", "touch", "touch", "touch"], "the own touch is not made again"
    limits = [{material.stiffness_n_per_m for material in touch.surface.materials} for touch in touches]
    assert limits == [{40.0}, {16.0}, {72.0}, {40.0}], "the safety margin is 0.8"
    assert touches[3] is touches[0]
    assert min(material.stiffness_n_per_m for material in pipe.make("surface").materials) > 90.0, (
        "ice and sand as they are"
    )
    first = pipeline(folder)
    first.touch_on(Soft(most_n_per_m=20.0))
    assert max(material.stiffness_n_per_m for material in first.make().surface.materials) > 20.0, (
        "the engine has its own touch"
    )


def test_engine_with_other_products_makes_what_depends_on_them_and_neither_keeps_nor_tells_it(folder: Path):
    pipe = pipeline(folder, plugins=listening(), workspace=Workspace(width_m=0.03, relief_m=0.01, smooth_m=0))
    first, kept, before = pipe.make().surface, set((folder / "cache").iterdir()), list(heard)
    down = DisparityMap(np.ascontiguousarray(np.tile(np.arange(20, dtype=np.float32)[:, None], (1, 30))))
    other = pipe.with_products(disparity=down)
    second = other.make().surface
    assert ran == ["disparity", "segments", "touch", "touch"], "segments and materials are shared"
    for surface, corners in ((first, (0, 0, 0.01)), (second, (0, 0.01, 0))):
        assert surface.height_m[[0, -1, 0], [0, 0, -1]] == pytest.approx(corners, abs=1e-6)
    assert other.make("disparity") is down
    assert other.make("segments") is pipe.make("segments")
    assert (set((folder / "cache").iterdir()), heard) == (kept, before)
    assert pipe.make().surface is first
    assert "disparity" not in {outcome.product for outcome in other.outcomes if outcome.outcome == "ran"}
    fresh = pipeline(folder)
    fresh.plan()
    fresh.with_products(disparity=down).make("segments")
    fresh.make("segments")
    assert outcome_kinds(fresh)["segments"] == "cached", "each engine reports what it made itself"


def test_make_makes_each_needed_product_once(folder: Path):
    pipe = pipeline(folder)
    assert pipe.make("relief") is not None
    assert ran == ["disparity"]
    unneeded = [
        outcome.product for outcome in pipe.outcomes if outcome.outcome == "skipped" and "not needed" in outcome.why
    ]
    assert unneeded == ["segments", "materials", "surface", "touch"]
    surface = pipe.make().surface
    assert ran == ["disparity", "segments", "touch"]
    assert [material.name for material in surface.materials] == ["ice", "sand"]
    made = ("disparity", "relief", "segments", "materials", "surface", "touch")
    assert outcome_kinds(pipe) == {"views": "given", **dict.fromkeys(made, "ran")}
    with pytest.raises(UnknownMethod, match="did you mean 'surface'"):
        pipe.make("surfaces")


def test_parts_of_the_scene_stand_for_products(folder: Path):
    np.save(folder / "d.npy", np.full((20, 30), 3.0, np.float32))
    files = SceneFiles(left=Path("left.png"), right=Path("right.png"), disparity=Path("d.npy"))
    pipe = pipeline(folder, scene=files)
    pipe.make("relief")
    assert outcome_kinds(pipe)["disparity"] == "given"
    pipe = pipeline(folder, scene=SceneFiles(height=Path("heights.npy")))
    assert pipe.make("surface").height_m.max() == pytest.approx(0.02)
    assert (outcome_kinds(pipe)["relief"], outcome_kinds(pipe)["segments"]) == ("given", "skipped")
    photo = SceneFiles(photo=Path("left.png"), disparity=Path("d.npy"))
    assert not pipeline(folder, scene=photo, depth=name_method(Pairs())).plan("relief").refusal
    assert not pipeline(folder, scene=SceneFiles(photo=Path("left.png")), depth=None).plan("segments").refusal
    assert ran == []


def test_stages_that_are_skipped_or_fail_are_not_kept(folder: Path):
    pipe = pipeline(folder, depth=name_method(Never()))
    assert np.ptp(pipe.make("relief").height_m) == 0
    assert {outcome.product: outcome.why for outcome in pipe.outcomes}["disparity"] == "nothing to see"
    pipe = pipeline(folder, render=name_method(FeelHeights()))
    assert pipe.make().surface.materials is None
    assert "segments" not in ran
    pipe = pipeline(folder, texture=name_method(Fails()))
    with pytest.raises(ZeroDivisionError):
        pipe.make()
    assert {outcome.product: outcome.why for outcome in pipe.outcomes}[
        "segments"
    ] == "ZeroDivisionError: a bug of its own"
    assert outcome_kinds(pipe)["segments"] == "failed"
    assert pipe.key("segments") not in pipe.cache


@pytest.mark.parametrize("parts", [{"texture": name_method(Shrinks())}, {"depth": name_method(Grows())}])
def test_result_of_another_size_is_refused(folder: Path, parts: dict):
    with pytest.raises(BrokenMethod, match="for a picture of 30 x 20"):
        pipeline(folder, **parts).make("surface")
    coarse = Workspace(width_m=0.03, finest_m=0.002)
    with pytest.raises(BrokenMethod, match="for a picture of 15 x 10"):
        pipeline(folder, workspace=coarse, **parts).make("surface")


class Warns(Ramp):
    """A depth method with a warning."""

    def estimate(self, views: Views) -> DisparityMap:
        note(logging.getLogger("tests"), "every row is strange", logging.WARNING)
        doubt(logging.getLogger("tests"), "hardly worth it")
        return super().estimate(views)


def test_surface_is_taken_from_the_cache_with_its_notes(
    folder: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
):
    parts = {"depth": name_method(Warns()), "texture": name_method(Says()), "materials": MaterialChoice(by={1: "ice"})}
    noticed = [Note("every row is strange", "warning"), Note("hardly worth it", "doubt")]
    first = pipeline(folder, **parts)
    first.make("disparity")
    first.make("surface")
    for want in ("disparity", "surface"):  # of the second, only the surface is read, and holds what it is made from
        caplog.clear()
        again = pipeline(folder, **parts)
        assert again.plan(want).steps[-1].notes == tuple(noticed)
        again.make(want)
        found = {outcome.product: outcome for outcome in again.outcomes}
        assert outcome_kinds(again)["disparity"] == ("cached" if want == "disparity" else "skipped")
        assert list(found["disparity"].notes) == noticed
        assert found["disparity"].why.endswith("; every row is strange; hardly worth it")
        assert [record.message for record in caplog.records] == ["every row is strange", "hardly worth it"]
    assert found["segments"].why.endswith("; skipped: everything")
    again.make("disparity")
    assert len(caplog.records) == 2, "each note is logged once"
    monkeypatch.setattr("tangible_core.pipeline.engine.engine.perf_counter", count().__next__)
    pipeline(folder).make()
    ran.clear()
    again = pipeline(folder)
    again.make()
    assert (ran, outcome_kinds(again)["surface"]) == (["touch"], "cached")
    assert outcome_kinds(again)["disparity"] == "skipped"
    assert again.make("disparity") is not None
    assert outcome_kinds(again)["disparity"] == "cached"
    assert {outcome.seconds for outcome in again.outcomes if outcome.outcome in ("ran", "cached")} == {1}
    other = pipeline(folder, materials=MaterialChoice(by={1: "sand", 2: "ice"}))
    other.make()
    assert ran == ["touch"] * 2
    assert (outcome_kinds(other)["relief"], outcome_kinds(other)["surface"]) == ("cached", "ran")


def test_views_ordered_as_named_are_not_exchanged(folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(pair_checks, "view_order", lambda *_: pair_checks.ViewOrder(True, "exchanged"))
    for order, most_px in ((None, 87), ("as-named", 0)):
        files = SceneFiles(left=Path("left.png"), right=Path("right.png"), order=order)
        found = pipeline(folder, scene=files, depth=name_method(Ramp(slope=-3.0))).make("disparity")
        assert np.nanmax(found.disparity_px) == most_px


@pytest.mark.parametrize(
    "change",
    [
        {"depth": name_method(Ramp(slope=2.0))},
        {"depth": NamedMethod("ramp", "tests 1.1", Ramp())},
        {"scene": SceneFiles(left=Path("right.png"), right=Path("left.png"))},
        {"cached": False},
    ],
    ids=["an option", "another version of its distribution", "another scene", "no cache"],
)
def test_changed_input_is_never_answered_from_the_cache(folder: Path, change: dict):
    pipeline(folder).make("disparity")
    ran.clear()
    pipe = pipeline(folder, **change)
    pipe.make("disparity")
    assert ran == ["disparity"]


@pytest.mark.parametrize(
    "parts", [{}, {"depth": name_method(Never())}, {"texture": None}, {"render": name_method(FeelHeights())}]
)
def test_plan_equals_the_outcomes(folder: Path, parts: dict):
    foreseen = {step.product: step.outcome for step in pipeline(folder, **parts).plan().steps}
    assert ran == []
    pipe = pipeline(folder, **parts)
    pipe.make()
    happened = {outcome.product: outcome.outcome for outcome in pipe.outcomes if "not needed" not in outcome.why}
    assert {name: foreseen.get(name, "skipped") for name in happened} == happened
    for again in (pipeline(folder, cached=False, **parts), pipeline(folder, **parts)):
        steps, _ = again.plan().steps, again.make()
        told = {outcome.product: outcome for outcome in again.outcomes}
        assert list(told) == [outcome.product for outcome in pipe.outcomes], "along the road, from the cache too"
        assert [(step.outcome, step.method) for step in steps] == [
            (told[step.product].outcome, told[step.product].method) for step in steps
        ]
        foretold = {step.product: step.why.partition("; the relief is flat")[0] for step in steps}  # a skipped depth
        assert all(told[name].why.startswith(why) for name, why in foretold.items()), "notes are known afterwards"
    assert {step.product: step.outcome for step in pipeline(folder, **parts).plan().steps}["surface"] == "cached"


class Pairs(Ramp):
    """Finds nothing in one picture."""

    needs_pair: ClassVar[bool] = True


@pytest.mark.parametrize(
    ("parts", "product", "error"),
    [
        ({"scene": SceneFiles(photo=Path("left.png")), "depth": name_method(Pairs())}, "disparity", PictureError),
        ({"depth": None}, "disparity", ConfigError),
        ({"render": None}, "touch", ConfigError),
        ({"scene": SceneFiles(height=Path("heights.npy")), "want": "disparity"}, "disparity", ConfigError),
    ],
)
def test_plan_ends_with_a_refusal_before_anything_runs(folder: Path, parts: dict, product, error):
    plan = pipeline(folder, **parts).plan()
    assert (plan.steps[-1].product, plan.steps[-1].outcome) == (product, "refused")
    pipe = pipeline(folder, **parts)
    with pytest.raises(error) as raised:
        pipe.make()
    assert str(raised.value) == plan.refusal
    assert plan.refusal in [outcome.why for outcome in pipe.outcomes]
    assert (ran, outcome_kinds(pipe)[product]) == ([], "refused")
    assert not pipeline(folder).plan().refusal


def test_observers_are_called_though_one_fails(folder: Path, caplog: pytest.LogCaptureFixture):
    class Bad:
        @hooks.hookimpl
        def tangible_stage_finished(self, outcome):
            raise RuntimeError("always")

    plugins = listening()
    plugins.register(Bad())
    pipe = pipeline(folder, plugins=plugins)
    pipe.plan("disparity")
    pipe.make("disparity")
    assert heard == [("given", "views"), ("plan", "disparity"), ("started", "disparity"), ("ran", "disparity")]
    assert "tangible_stage_finished" in caplog.text


class TestWorkingGrid:
    """Thirty columns of 1 mm, of which 2 mm are felt."""

    COARSE = Workspace(width_m=0.03, relief_m=0.01, smooth_m=0, finest_m=0.002)

    def test_working_grid_is_as_coarse_in_metres_and_keeps_holes(self, folder: Path):
        surface = pipeline(folder, workspace=self.COARSE).make("surface")
        assert surface.height_m.shape == surface.labels.shape == (10, 15)
        assert surface.extent_m == (0.03, 0.02)
        assert surface.labels.tolist() == [[0] * 7 + [1] * 8] * 10
        whole_pipe = pipeline(folder, workspace=Workspace(width_m=0.03, relief_m=0.01, smooth_m=0, finest_m=0))
        whole = whole_pipe.make("surface")
        assert whole.height_m.shape == whole.labels.shape == (20, 30)
        pairs = whole.height_m.reshape(10, 2, 15, 2).mean(axis=(1, 3))
        np.testing.assert_allclose(surface.height_m, pairs, atol=0.01 / 15)
        pipe = pipeline(folder, workspace=self.COARSE)
        found = pipe.make_on_grid("disparity")
        found = pipe.make_on_grid("disparity")
        assert found.disparity_px.tolist() == [[2.0 * column for column in range(15)]] * 10
        assert pipe.make("disparity").disparity_px[0, 15] == pytest.approx(15, abs=1)
        assert pipe.make("disparity").disparity_px.shape == (20, 30)
        assert pipe.make("segments").labels.tolist() == [[0] * 14 + [1] * 16] * 20, "half of 15 columns is 7"
        whys = {outcome.product: outcome.why for outcome in pipe.outcomes}
        assert all("at 1/2 of the size" in whys[product] for product in ("disparity", "segments"))
        assert whole_pipe.make("segments").labels.tolist() == [[0] * 15 + [1] * 15] * 20
        assert "of the size" not in "".join(outcome.why for outcome in whole_pipe.outcomes)
        heights = np.tile(np.arange(30.0), (20, 1))
        heights[4:6, 10:12], heights[8, 20] = np.nan, np.nan
        np.save(folder / "torn.npy", heights)
        parts = {"scene": SceneFiles(height=Path("torn.npy")), "texture": None}
        surface = pipeline(folder, **parts, workspace=self.COARSE.model_copy(update={"holes": "cut"})).make("surface")
        wanted = np.tile(np.linspace(0, 0.01, 15), (10, 1))
        wanted[2, 5] = 0
        np.testing.assert_allclose(surface.height_m, wanted, atol=0.0002)

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
            materials=MaterialChoice(rules=[{"at": [4, 3], "material": "sand"}], by={1: "ice", 3: "wood"}),
        )
        surface = pipe.make("surface")
        assert [material.name for material in surface.materials] == ["ice", "sand", "wood"]
        assert surface.labels.tolist() == [[0] * 2 + [int(row == 1)] + [0] * 7 + [2] * 5 for row in range(10)]
        np.testing.assert_allclose(surface.height_m[0], np.linspace(0, 0.01, 15), atol=1e-8)
        assert pipe.make("segments").labels.shape == (20, 30)

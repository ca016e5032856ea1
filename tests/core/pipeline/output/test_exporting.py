"""Exports: what exporters get, where their files come to, and what becomes of whatever goes wrong."""

import json
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Event
from time import perf_counter
from typing import Any, ClassVar

import numpy as np
import pytest

from command_line import tangible
from full_disk import files_up_to
from pictures import write_png
from tangible_core import DisparityMap, Pipeline, Recording, Scene, SegmentMap, Views
from tangible_core.data import TICK_COLUMNS, PartMap
from tangible_core.data.products import PRODUCTS
from tangible_core.errors import ConfigError, OutputError, PictureError, Stopped, UnknownMethod
from tangible_core.parts import reduced_parts
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.pipeline.engine.cache import Cache
from tangible_core.pipeline.engine.working_grid import parts_on_grid
from tangible_core.pipeline.feeling import Feeling
from tangible_core.pipeline.output import export_folder
from tangible_core.pipeline.output.export_folder import move, read_list
from tangible_core.pipeline.output.exporting import EXPORTABLE, MOST_STEM_BYTES, stem_of
from tangible_core.pipeline.output.parts_text import part_heights
from tangible_core.plugins import DepthEstimator, Exporter, Segmenter, Work
from tangible_core.plugins.registry import default_registry

LABELS = np.kron(np.int32([[0, 1, 1], [0, 2, 2]]), np.ones((24, 24), np.int32))
PHOTO = (LABELS * 90).astype(np.uint8)
LABELLED = Scene.photo(PHOTO, segments=LABELS, name="still life")
SAID: Any = {"parts": {0: "wall", 1: {"name": "box", "height_m": 0.004}, 2: {"height_m": 0.002}}, "heights": "given"}


class Report(Exporter):
    """An exporter that writes its work as JSON."""

    needs: ClassVar[tuple[str, ...]] = ("relief",)
    width_m: float | None = None

    def picture_width_m(self, aspect: float) -> float | None:
        return self.width_m

    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        path = stem.with_suffix(".report")
        relief = {"extent_m": work.relief.extent_m, "cells": work.relief.height_m.shape}
        path.write_text(json.dumps({"title": work.title, "language": work.language, "names": work.names, **relief}))
        return (path,)


class Steepest(Exporter):
    """An exporter that writes the steepest slope along the rows of its relief."""

    needs: ClassVar[tuple[str, ...]] = ("relief",)

    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        slopes = np.abs(np.diff(work.relief.height_m, axis=1)) / work.relief.pitch_m[0]
        return write_file(stem.with_suffix(f".{type(self).__name__}"), str(slopes.max()))


class SteepestUpright(Steepest):
    limits_slopes: ClassVar[bool] = False


class Does(Exporter):
    """An exporter that calls a function with the stem."""

    do: Callable[[Path], Any]

    def write(self, work: Work, stem: Path) -> Any:
        return self.do(stem)


class NeedsMore(Report):
    def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
        return (stem.with_suffix(f".{work.parts}"),)


class NeedsATouch(Report):
    needs: ClassVar[tuple[str, ...]] = ("touch",)


class Fingers(Report):
    needs: ClassVar[tuple[str, ...]] = ("relief", "simplified")
    medium: ClassVar[Any] = "swell"


class SolidOnly(Report):
    medium: ClassVar[Any] = "print"


class Flat(DepthEstimator):
    def estimate(self, views: Views) -> DisparityMap:
        return DisparityMap(views.left[..., 0].astype(np.float32) if views.left.ndim == 3 else views.left.astype("f4"))


class Counted(Segmenter):
    """A segmenter that records the sizes of its pictures."""

    seen: ClassVar[list[tuple[int, ...]]] = []

    def segment(self, picture: np.ndarray) -> SegmentMap:
        self.seen.append(picture.shape)
        return SegmentMap((picture > 80).astype(np.int32) + (picture > 170))


def write_file(path: Path, text: str = "x") -> tuple[Path, ...]:
    path.write_text(text)
    return (path,)


def pipeline(**said: Any) -> Pipeline:
    return Pipeline(LABELLED, cached=False, **said)


def report_of(folder: Path) -> dict[str, Any]:
    return json.loads(next(folder.glob("*.report")).read_text())


class TestWork:
    def test_work_has_products_and_words(self, tmp_path: Path):
        done = pipeline(**SAID, title="Ein Stück", language="de-AT").export(tmp_path, [Report()])
        said = report_of(tmp_path)
        assert (said["title"], said["language"], said["names"]) == ("Ein Stück", "de-AT", ["wall", "box", ""])
        assert [each.outcome for each in done.outcomes] == ["ran"]
        assert done.files == {"Report": (tmp_path / "Ein Stück.report",)}

    def test_work_without_a_title_has_the_name_of_the_scene(self, tmp_path: Path):
        np.save(tmp_path / "old harbour.v2.npy", np.eye(8))
        Pipeline(Scene.heights(tmp_path / "old harbour.v2.npy"), cached=False).export(tmp_path / "out", [Report()])
        assert report_of(tmp_path / "out")["title"] == "old harbour.v2"
        assert (tmp_path / "out/old harbour-v2.report").is_file()

    def test_work_has_the_width_of_the_exporter(self, tmp_path: Path):
        exporters = [Report(), Report(width_m=0.16), Report(width_m=0.16)]
        done = pipeline(**SAID).export(tmp_path, exporters)
        widths = [json.loads(each.files[0].read_text())["extent_m"][0] for each in done.exports]
        assert widths == [0.08, 0.16, 0.16]
        made = [[each.product for each in one.made if each.outcome == "ran"] for one in done.exports]
        assert made == [["parts", "relief"], ["relief"], []]

    @pytest.mark.parametrize(
        ("said", "steepest"),
        [({}, (1.1, 4)), ({"relief": {"slope": 2.0}}, (2.0, 2.0)), ({"relief": {"slope": 0}}, (4, 4))],
    )
    def test_slopes_are_limited_where_a_hand_is_held_up_or_the_file_says_so(
        self, tmp_path: Path, said: dict[str, Any], steepest: tuple[float, float]
    ):
        wall = np.repeat(np.float32([[2, 9]]), 60, 1).repeat(90, 0)
        step = Pipeline(Scene.pair(wall, wall, disparity=wall), cached=False, **said)
        step.export(tmp_path, [Steepest(), SteepestUpright()])
        found = [float(path.read_text()) for path in sorted(tmp_path.glob("*.Steepest*"))]
        assert [min(each, 4) for each in found] == pytest.approx(steepest, rel=0.05)

    def test_parts_do_not_depend_on_the_width_of_the_exporter(self, tmp_path: Path):
        """Names are given by the numbers of parts, which would be those of other parts."""
        Counted.seen.clear()
        scene = Scene.photo(PHOTO)
        said = {**SAID, "workspace": {"width_m": 0.0096, "finest_m": 3e-4}}
        done = Pipeline(scene, texture=Counted(), cached=False, **said).export(
            tmp_path, [Report(width_m=0.16), Report(width_m=0.001), Report()]
        )
        cells = {tuple(json.loads(each.files[0].read_text())["cells"]) for each in done.exports}
        assert cells == {(24, 36)}
        assert Counted.seen == [(24, 36)]

    def test_work_makes_only_the_needed_products(self, tmp_path: Path):
        """A print of a photo by its brightness needs no texture, and is not judged by parts either."""
        Counted.seen.clear()
        photo = Pipeline(Scene.photo(PHOTO), depth=Flat(), texture=Counted(), cached=False)
        (one,) = photo.export(tmp_path, [SolidOnly()]).exports
        assert [each.product for each in one.made if each.outcome == "ran"] == ["disparity", "relief"]
        heights = Pipeline(Scene.heights(np.eye(8)), texture=Counted(), cached=False)
        (one,) = heights.export(tmp_path, [SolidOnly()]).exports
        assert {each.product: each.outcome for each in one.made} == {"relief": "given"}
        assert Counted.seen == []

    def test_simplified_parts_without_a_key_follow_the_usual_rules(self, tmp_path: Path):
        class Parts(Fingers):
            def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
                assert isinstance(work.simplified, PartMap)
                return write_file(stem.with_suffix(".txt"), f"{work.simplified.count} {work.names}")

        (one,) = pipeline(**SAID).export(tmp_path, [Parts()]).exports
        assert one.files[0].read_text() == "3 ('wall', 'box', '')"
        (one,) = (
            Pipeline(Scene.heights(np.eye(8)), cached=False)
            .export(tmp_path, [Does(do=lambda stem: write_file(stem.with_suffix(".txt")))])
            .exports
        )
        assert one.outcome.outcome == "ran"

    def test_work_without_segments_has_no_parts(self, tmp_path: Path):
        class Parts(Fingers):
            def write(self, work: Work, stem: Path) -> tuple[Path, ...]:
                return write_file(stem.with_suffix(".txt"), str(work.simplified))

        (one,) = Pipeline(Scene.heights(np.eye(8)), cached=False).export(tmp_path, [Parts()]).exports
        assert one.files[0].read_text() == "None"
        assert one.legible.sentence == "Illegible, because the picture is not divided into parts."

    def test_legibility_is_judged_at_the_width_of_the_files(self, tmp_path: Path):
        class Small(Fingers):
            width_m: float | None = 0.01

        thing = pipeline(**SAID)
        small, large = thing.export(tmp_path, [Small(), Fingers(width_m=0.16)]).exports
        assert not small.legible.readable
        assert small.files
        assert [each.kind for each in small.outcome.notes] == ["warning"]
        assert small.legible.sentence in small.outcome.why
        assert large.legible.readable
        assert large.outcome.notes == ()
        assert Feeling(thing).legible("swell", 0.16).readable
        assert not Feeling(thing).legible("swell", 0.01).readable

    def test_exportable_products_are_the_records(self):
        assert tuple(each for each in PRODUCTS if each != "touch") == EXPORTABLE


class TestSimplify:
    def test_simplify_applies_to_relief_labels_and_materials(self):
        labels = np.zeros((60, 80), np.int32)
        labels[10:40, 10:40], labels[20:24, 60:64] = 1, 2
        said = {"parts": {0: "ground", 1: {"height_m": 0.004}, 2: {"height_m": 0.003}}, "heights": "given"}
        scene = Scene.photo(labels.astype(np.uint8), segments=labels)
        plain, simple = (Pipeline(scene, cached=False, **said, **more) for more in ({}, {"simplify": {}}))
        assert np.unique(plain.surface.labels).tolist() == [0, 1, 2]
        assert np.unique(simple.surface.labels).tolist() == [0, 1]
        assert simple.surface.names == plain.surface.names == ("ground", "", "")
        assert simple.surface.height_m[22, 62] < 0.001 < plain.surface.height_m[22, 62]
        assert simple.surface.height_m.shape == plain.surface.height_m.shape
        assert len(simple.materials.materials) == simple.make("parts").count == simple.make("simplified").count == 3
        assert part_heights(simple.engine).heights_m == part_heights(plain.engine).heights_m

    def test_simplified_parts_are_felt_in_their_places(self):
        """Cell by cell of the nearest, though their grid is another one; and no more of them than are there."""
        parts = PartMap(np.int32([[0, 3, 2]]), (0, 1, 2, 3))
        felt = parts_on_grid(parts, (1, 8), "simplified")
        assert felt.labels.tolist() == [[0, 0, 0, 3, 3, 2, 2, 2]]
        assert parts_on_grid(parts, (1, 2), "parts").labels.tolist() == [[0, 2]]
        assert reduced_parts(PartMap(np.int32([[0, 0, 0, 2]]), (0, 1, 2)), (1, 2)).labels.tolist() == [[0, 2]]

    def test_simplify_without_segments_is_refused(self):
        with pytest.raises(ConfigError, match=r"simplify: parts are pieces of segments, and the scene has none"):
            Pipeline(Scene.photo(PHOTO), simplify={}, cached=False).make("simplified")

    def test_cached_simplified_parts_are_checked(self, tmp_path: Path):
        def pipeline_with(height_m: float) -> Pipeline:
            said = {**SAID, "parts": {1: {"height_m": height_m}}}
            found = Pipeline(Scene.photo(PHOTO), texture=Counted(), simplify={}, cached=False, **said)
            found.engine.cache = Cache(tmp_path)
            return found

        assert pipeline_with(0.004).relief.height_m.max() > 0
        with pytest.raises(ConfigError, match="the highest can be"):
            _ = pipeline_with(0.4).relief


class TestFiles:
    def test_later_export_replaces_an_earlier_one(self, tmp_path: Path):
        np.save(tmp_path / "map.npy", np.eye(8))
        for title in ("one", "two"):
            said = [f"title={title}"]
            config = parse_config("scene: {height: map.npy}", tmp_path / "coins.yaml", default_registry(), said)
            done = Pipeline.from_config(config, default_registry(), None).export(tmp_path, ["heights"])
            assert [each.outcome for each in done.outcomes] == ["ran"]
        assert json.loads((tmp_path / "coins-heights.json").read_text())["title"] == "two"

    @pytest.mark.parametrize("before", ["somebody's", "edited", "of another"])
    def test_other_file_is_not_overwritten_unless_forced(self, tmp_path: Path, before: str):
        path, out = tmp_path / "still life.report", tmp_path
        if before == "edited":
            pipeline(**SAID).export(out, [Report()])
        elif before == "of another":
            pipeline(**SAID).export(out, [Does(do=lambda stem: write_file(stem.with_suffix(".report")))])
        if before != "of another":
            path.write_text("mine")
        kept = path.read_text()
        (one,) = pipeline(**SAID).export(out, [Report()]).exports
        assert one.outcome.outcome == "refused"
        assert one.files == ()
        assert "is there already" in one.outcome.why
        assert "--force" in one.outcome.why
        assert path.read_text() == kept
        (one,) = pipeline(**SAID).export(out, [Report()], force=True).exports
        assert one.files == (path,)
        assert path.read_text() != kept

    def test_files_are_moved_all_or_none(self, tmp_path: Path):
        (tmp_path / "still life.b").mkdir()

        def both(stem: Path) -> tuple[Path, ...]:
            return (*write_file(stem.with_suffix(".a")), *write_file(stem.with_suffix(".b")))

        (one,) = pipeline().export(tmp_path, [Does(do=both)], force=True).exports
        assert one.outcome.outcome == "refused"
        assert sorted(path.name for path in tmp_path.iterdir()) == ["still life.b"]

    def test_exporters_of_one_name_have_numbered_files(self, tmp_path: Path):
        done = pipeline(**SAID).export(tmp_path, [Report(), Report(width_m=0.1)])
        assert {name: files[0].name for name, files in done.files.items()} == {
            "Report": "still life.report",
            "Report-2": "still life-2.report",
        }

    def test_concurrent_exports_keep_the_whole_list(self, tmp_path: Path):
        names = [f"{letter}{number}" for letter in "ab" for number in range(20)]
        for folder in ("from", "to"):
            (tmp_path / folder).mkdir()
        for name in names:
            write_file(tmp_path / "from" / name)

        def bring(letter: str) -> None:
            for number in range(20):
                move([tmp_path / "from" / f"{letter}{number}"], tmp_path / "to", "mine.yaml", "report", False)

        with ThreadPoolExecutor(2) as both:
            list(both.map(bring, "ab"))
        assert sorted(read_list(tmp_path / "to")) == sorted(names)

    def test_second_export_of_a_name_is_refused_during_the_first(self, tmp_path: Path):
        def export_another(stem: Path) -> tuple[Path, ...]:
            with pytest.raises(OutputError, match="another program is writing the same files there; wait for it"):
                pipeline(**SAID, language="de").export(tmp_path, [Report(), Steepest()])
            other = Pipeline(Scene.photo(PHOTO, segments=LABELS, name="other"), cached=False, **SAID)
            assert other.export(tmp_path, [Report()]).files == {"Report": (tmp_path / "other.report",)}
            return write_file(stem.with_suffix(".first"))

        first = pipeline(**SAID, language="fr").export(tmp_path, [Report(), Does(do=export_another)])
        assert [each.outcome for each in first.outcomes] == ["ran", "ran"], first
        assert json.loads((tmp_path / "still life.report").read_text())["language"] == "fr"
        written = ["other.report", "still life.first", "still life.report"]
        assert sorted(path.name for path in tmp_path.iterdir()) == [".exports.json", *written]

    def test_files_have_the_permissions_of_new_files(self, tmp_path: Path):
        (one,) = pipeline(**SAID).export(tmp_path, [Report()]).exports
        beside = tmp_path / "beside"
        beside.write_text("")
        assert one.files[0].stat().st_mode == beside.stat().st_mode

    @pytest.mark.parametrize(
        ("title", "stem"),
        [
            ("a/b\\c:d.e", "a-b-c-d-e"),
            ("東京 ♞", "東京"),
            ("...", "export"),
            ("x" * 300, "x" * MOST_STEM_BYTES),
            ("ß" * 200, "ß" * (MOST_STEM_BYTES // 2)),
        ],
    )
    def test_stem_of_any_title_is_a_file_name(self, title: str, stem: str):
        config = pipeline(title=title[:200]).config
        assert stem_of(config, Scene("x" * 300) if title[:2] == "xx" else LABELLED) == stem[: len(stem)]


class TestFailures:
    FAULTS: ClassVar[dict[str, tuple[Callable[[Path], Any], str, str]]] = {
        "raises": (lambda stem: 1 / 0, "failed", "Does failed in write: ZeroDivisionError"),
        "exits": (lambda stem: exit(3), "failed", "called sys.exit"),
        "no tuple": (lambda stem: str(stem), "failed", "write gave the str"),
        "nothing": (lambda stem: (), "failed", "write returned no path"),
        "no path": (lambda stem: (7,), "failed", "write returned 7 for a path"),
        "no such file": (lambda stem: (stem.with_suffix(".txt"),), "failed", "there is no such file"),
        "outside": (lambda stem: write_file(stem.parent.parent / "x.txt"), "failed", "is not the given stem"),
        "another name": (lambda stem: write_file(stem.with_name("x.txt")), "failed", "is not the given stem"),
        "a way out": (lambda stem: (stem.parent / f"{stem.name}/../../etc",), "failed", "is not the given stem"),
        "refuses": (lambda stem: (_ for _ in ()).throw(PictureError("no part is big enough; take A3")), "refused",
                    "no part is big enough; take A3"),
    }  # fmt: skip

    @pytest.mark.parametrize("fault", FAULTS)
    def test_failure_is_one_line_and_the_others_write(self, tmp_path: Path, fault: str):
        do, became, why = self.FAULTS[fault]
        first, other = pipeline(**SAID).export(tmp_path / "out", [Does(do=do), Report()]).exports
        assert (first.outcome.outcome, first.files) == (became, ())
        assert why in first.outcome.why
        assert "\n" not in first.outcome.why
        assert other.files
        assert {path.name for path in (tmp_path / "out").iterdir()} - {"x.txt"} == {
            ".exports.json",
            "still life.report",
        }

    def test_link_in_place_of_a_file_is_refused(self, tmp_path: Path):
        def link(stem: Path) -> tuple[Path, ...]:
            path = stem.with_suffix(".txt")
            path.symlink_to(__file__)
            return (path,)

        (one,) = pipeline().export(tmp_path, [Does(do=link)]).exports
        assert one.outcome.outcome == "failed"

    def test_product_that_is_not_needed_cannot_be_read(self, tmp_path: Path):
        (one,) = pipeline(**SAID).export(tmp_path, [NeedsMore()]).exports
        assert one.outcome.outcome == "failed"
        assert "reads parts, which it does not name in `needs`" in one.outcome.why

    def test_need_of_an_unknown_product_is_a_fault(self, tmp_path: Path):
        (one,) = pipeline(**SAID).export(tmp_path, [NeedsATouch()]).exports
        assert one.outcome.outcome == "failed"
        assert "needs 'touch'; an exporter may need disparity," in one.outcome.why

    def test_refused_product_refuses_the_exporter(self, tmp_path: Path):
        (one,) = pipeline().export(tmp_path, [Report()]).exports
        assert (one.outcome.outcome, one.outcome.why) == (
            "refused",
            "the pipeline has no depth; give it one: Pipeline(scene, depth=...)",
        )

    @pytest.mark.parametrize("width_m", [0.0, -1.0, float("nan"), 1e9])
    def test_invalid_width_is_refused(self, tmp_path: Path, width_m: float):
        (one,) = pipeline(**SAID).export(tmp_path, [Report(width_m=width_m)]).exports
        assert one.outcome.outcome == "refused"
        assert "a width is from" in one.outcome.why

    def test_full_disk_is_refused_with_the_cure(self, tmp_path: Path):
        big = Does(do=lambda stem: write_file(stem.with_suffix(".txt"), "x" * 100_000))
        with files_up_to(10_000):
            first, other = pipeline(**SAID).export(tmp_path, [big, Report()]).exports
        assert first.outcome.outcome == "refused"
        assert "free some space or choose another folder" in first.outcome.why
        assert other.files
        assert sorted(path.name for path in tmp_path.iterdir()) == [".exports.json", "still life.report"]

    def test_full_disk_at_the_list_leaves_no_file(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
        """A file that no list names would be in the way of the next export."""

        def full(path: Path, text: str) -> None:
            raise OutputError(f"{path}: cannot be written: No space left on device")

        monkeypatch.setattr(export_folder, "write_text", full)
        (one,) = pipeline(**SAID).export(tmp_path, [Report()]).exports
        assert one.outcome.why == f"{tmp_path / '.exports.json'}: cannot be written: No space left on device"
        assert not list(tmp_path.iterdir())

    def test_error_names_the_place_of_a_file_and_not_the_temporary_folder(self, tmp_path: Path):
        def refuse(stem: Path) -> tuple[Path, ...]:
            raise OutputError(f"{stem.with_suffix('.txt')}: cannot be written")

        (one,) = pipeline(**SAID).export(tmp_path, [Does(do=refuse)]).exports
        assert one.outcome.why == f"{tmp_path / 'still life.txt'}: cannot be written"

    def test_folder_of_a_killed_export_is_swept_by_the_next(self, tmp_path: Path):
        left = tmp_path / ".export.0123456789ab.tangible"
        left.mkdir()
        os.utime(left, (1, 1))
        pipeline(**SAID).export(tmp_path, [Report()])
        assert sorted(path.name for path in tmp_path.iterdir()) == [".exports.json", "still life.report"]

    def test_unwritable_folder_is_refused(self, tmp_path: Path):
        (tmp_path / "file").write_text("")
        with pytest.raises(OutputError, match="choose another folder"):
            pipeline().export(tmp_path / "file" / "out", [Report()])

    @pytest.mark.parametrize("content", ["", "{}", '{"files": {"a": 1}}', "[[", '{"files": {"a": {"b": 1}}}'])
    def test_list_of_another_program_is_refused(self, tmp_path: Path, content: str):
        (tmp_path / ".exports.json").write_text(content)
        with pytest.raises(OutputError, match="is not a list of exports; move or delete it"):
            pipeline(**SAID).export(tmp_path, [Report()])
        assert (tmp_path / ".exports.json").read_text() == content

    def test_names_of_exporters_are_checked(self, tmp_path: Path):
        with pytest.raises(UnknownMethod, match=r"no export method is named 'hights' \(did you mean 'heights'\?\)"):
            pipeline().export(tmp_path, ["hights"])
        with pytest.raises(ConfigError, match=r"no exporter is named; .* installed: .*heights"):
            pipeline().export(tmp_path)
        assert list(tmp_path.iterdir()) == []


class TestEnding:
    @pytest.mark.parametrize("error", [KeyboardInterrupt, Stopped])
    def test_interrupted_export_leaves_no_partial_files(self, tmp_path: Path, error: type[BaseException]):
        def halfway(stem: Path) -> Any:
            write_file(stem.with_suffix(".txt"))
            raise error

        done = [Report(), Does(do=halfway), Report()]
        with pytest.raises(error):
            pipeline(**SAID).export(tmp_path, done)
        assert sorted(path.name for path in tmp_path.iterdir()) == [".exports.json", "still life.report"]

    def test_export_is_stopped_from_another_thread(self, tmp_path: Path):
        stop = Event()
        halfway = Does(do=lambda stem: stop.set() or write_file(stem.with_suffix(".txt")))
        with pytest.raises(Stopped):
            pipeline(**SAID).export(tmp_path, [halfway, Report()], stop=stop)
        assert list(tmp_path.iterdir()) == []

    def test_stopped_export_writes_nothing_more(self, tmp_path: Path):
        stop, begun = Event(), list[Path]()
        stop.set()
        with pytest.raises(Stopped):
            pipeline().export(tmp_path, [Does(do=begun.append)], stop=stop)
        assert begun == []

    def test_progress_has_each_exporter(self, tmp_path: Path):
        heard = list[tuple[str, str | None]]()
        pipeline(**SAID).export(
            tmp_path, [Report()], lambda stage: heard.append((stage.product, stage.outcome and stage.outcome.outcome))
        )
        assert heard[-4:] == [("relief", None), ("relief", "ran"), ("export: Report", None), ("export: Report", "ran")]


class TestDocument:
    def test_exporters_of_a_file_are_listed(self, tmp_path: Path):
        config = parse_config(
            "scene: builtin/coins\nsimplify: {gap_m: 4 mm}\nexport: [heights, {use: heights, width_m: 160 mm}]",
            tmp_path / "p.yaml", default_registry(),
        )  # fmt: skip
        assert [each.method.width_m for each in config.export] == [None, 0.16]
        assert config.simplify.gap_m == 0.004
        again = parse_config(config.as_yaml(), tmp_path / "q.yaml", default_registry())
        assert again.export == config.export
        assert again.simplify == config.simplify

    @pytest.mark.parametrize(
        ("text", "says"),
        [
            ("export: stl", r"p.yaml:2:1: export: takes a list of exporters, such as \[\{use: ...\}\], not 'stl'"),
            ("export: [hights]", r"p.yaml:2:10: no export method is named 'hights' \(did you mean 'heights'\?\)"),
            ("export: [{width_m: 1}]", r"p.yaml:2:10: export needs the name of a method"),
            ("export: [7]", r"p.yaml:2:10: export needs the name of a method"),
            ("export: [{use: heights, wid_m: 1}]", r"p.yaml:2:25: export.0.wid_m: unknown option \(did you mean"),
            ("simplify: yes", r"p.yaml:2:1: simplify: Input should be a mapping"),
            ("simplify: {gap_m: -1}", r"p.yaml:2:12: simplify.gap_m: Input should be greater than or equal to 0"),
        ],
    )
    def test_wrong_exporters_are_refused_with_their_places(self, tmp_path: Path, text: str, says: str):
        with pytest.raises(ConfigError, match=says):
            parse_config(f"scene: builtin/coins\n{text}", tmp_path / "p.yaml", default_registry())

    @pytest.mark.parametrize("text", ["export:", "simplify:", "export: []", ""])
    def test_file_without_exporters_has_none(self, tmp_path: Path, text: str):
        config = parse_config(f"scene: builtin/coins\n{text}", tmp_path / "p.yaml", default_registry())
        assert config.export == ()
        assert config.simplify is None

    @pytest.mark.parametrize(
        ("before", "sets", "after"),
        [
            ("", ["export.heights.width_m=0.1"], [0.1]),
            ("export: [heights]", ["export.heights.width_m=0.1"], [0.1]),
            ("export: [{use: heights, width_m: 1}, heights]", ["export.1.width_m=0.1"], [1, 0.1]),
            ("export: [heights]", ["export=[heights, heights]", "export.1.width_m=0.1"], [None, 0.1]),
            ("export: [heights]", ["export=[]"], []),
        ],
    )
    def test_override_by_the_name_of_an_exporter_sets_its_option(
        self, tmp_path: Path, before: str, sets: list[str], after
    ):
        text = f"scene: builtin/coins\n{before}"
        config = parse_config(text, tmp_path / "p.yaml", default_registry(), sets)
        assert [each.method.width_m for each in config.export] == after

    @pytest.mark.parametrize(
        ("override", "says"),
        [
            ("export.hights.width_m=1", "--set export.hights.width_m=1: no export method is named 'hights'"),
            ("export.heights.wid_m=1", "--set export.heights.wid_m=1: export.0.wid_m: unknown option"),
            ("export.heights=1", r"--set export.heights=1: export is a list; set it as a whole: export=\[...\]"),
            ("export.9.width_m=1", "no export method is named '9'"),
        ],
    )
    def test_wrong_override_is_named_in_the_complaint(self, tmp_path: Path, override: str, says: str):
        with pytest.raises(ConfigError, match=says):
            parse_config("scene: builtin/coins", tmp_path / "p.yaml", default_registry(), [override])

    def test_outcome_tells_no_more_time_than_passed(self, tmp_path: Path):
        begun_s = perf_counter()
        (one,) = pipeline(**SAID).export(tmp_path, [Report()]).exports
        assert 0 <= one.outcome.seconds <= perf_counter() - begun_s

    def test_exporter_by_name_has_the_options_of_the_list(self, tmp_path: Path):
        np.save(tmp_path / "map.npy", np.eye(8))
        text = "scene: {height: map.npy}\nexport: [{use: heights, width_m: 0.16}]"
        config = parse_config(text, tmp_path / "p.yaml", default_registry())
        Pipeline.from_config(config, default_registry(), None).export(tmp_path, ["heights"])
        assert json.loads((tmp_path / "p-heights.json").read_text())["width_mm"] == 160

    def test_pipeline_in_python_lists_exporters(self, tmp_path: Path):
        done = pipeline(**SAID, export=[Report(width_m=0.1)]).export(tmp_path)
        assert "still life.report" in repr(done)
        assert "still life.report</td>" in done._repr_html_()
        assert report_of(tmp_path)["extent_m"][0] == 0.1


class TestCommand:
    @pytest.fixture
    def place(self, tmp_path: Path) -> Path:
        np.save(tmp_path / "map.npy", np.linspace(0, 1, 48, dtype=np.float32).reshape(6, 8))
        (tmp_path / "map.yaml").write_text("scene: {height: map.npy}\nexport: [heights]\n")
        return tmp_path

    def test_command_writes_the_exporters_of_a_file(self, place: Path):
        ran = tangible("export", "map.yaml", cwd=place)
        assert ran.returncode == 0, ran.stderr
        assert "map.npy is written as heights." in " ".join(ran.stdout.split())
        assert (place / "out/map/map-heights.tif").is_file()

    def test_command_exports_a_picture_by_names(self, place: Path):
        ran = tangible("export", "map.npy", "--to", "heights", "--out", "here", "--json", cwd=place)
        assert ran.returncode == 0, ran.stderr
        said = json.loads(ran.stdout)
        assert [each["outcome"]["outcome"] for each in said["exports"]] == ["ran"]
        assert said["exports"][0]["files"] == [f"here/map-heights.{end}" for end in ("json", "png", "tif")]
        assert said["exports"][0]["legible"] is None

    def test_command_says_that_parts_were_simplified(self, place: Path):
        labels = np.zeros((60, 80), np.uint8)
        labels[:, 40:] = 1
        write_png(place / "labels.png", labels)
        write_png(place / "photo.png", np.full((60, 80), 9, np.uint8))
        (place / "two.yaml").write_text("scene: {photo: photo.png, segments: labels.png}\nsimplify: {}\nwant: relief\n")
        sets = ("--set", "depth=luminance")
        ran = tangible("export", "two.yaml", "--to", "swell,heights", *sets, cwd=place)
        assert " is written as swell (parts simplified) and heights" in " ".join(ran.stdout.split()), ran.stderr
        run = tangible("run", "two.yaml", "--set", "heights.by=guess", *sets, cwd=place)
        assert run.stdout.startswith("photo.png, its parts simplified, is done: "), run.stderr

    def test_command_exports_a_recording_as_csv(self, place: Path):
        rows = np.arange(3.0 * len(TICK_COLUMNS)).reshape(3, -1)
        Recording(rows).save(place / "felt.nc")
        ran = tangible("export", "felt.nc", "--to", "csv", "--out", "here", cwd=place)
        assert ran.returncode == 0, ran.stderr
        np.testing.assert_allclose(Recording.load(place / "here/felt.csv").rows, Recording.load(place / "felt.nc").rows)
        again = tangible("export", "felt.nc", "--to", "csv", "--out", "here", cwd=place)
        assert (again.returncode, again.stderr.splitlines()) == (2, [
            "here/felt.csv: is there already; --out FOLDER writes to another folder, --force writes over it"
        ])  # fmt: skip
        assert tangible("export", "map.npy", "--to", "csv", cwd=place).returncode == 2

    def test_command_exit_codes_tell_refusal_and_fault(self, place: Path, monkeypatch: pytest.MonkeyPatch):
        from tangible_export.heights import Heights

        (place / "out").mkdir()
        (place / "out/map-heights.tif").write_text("mine")
        ran = tangible("export", "map.yaml", "--out", "out", cwd=place)
        assert ran.returncode == 2
        assert ran.stderr.startswith("heights: out/map-heights.tif: is there already")
        assert len(ran.stderr.splitlines()) == 1
        assert tangible("export", "map.yaml", "--out", "out", "--force", cwd=place).returncode == 0
        assert tangible("export", "map.yaml", "--to", "nothing", cwd=place).returncode == 2

        def raising(error: BaseException) -> Any:
            def write(self: Heights, work: Work, stem: Path) -> Any:
                raise error

            return write

        monkeypatch.setattr(Heights, "write", raising(ValueError("a fault")))
        ran = tangible("export", "map.yaml", cwd=place)
        assert ran.returncode == 1
        assert "a fault; the traceback is in" in ran.stderr
        monkeypatch.setattr(Heights, "write", raising(KeyboardInterrupt()))
        assert tangible("export", "map.yaml", cwd=place).returncode == 130
        assert not list((place / "out/map").iterdir())

"""Exports. Otherwise a picture would be printed with wrong words or sizes, or an export would destroy a file."""

import json
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Event
from typing import Any, ClassVar

import numpy as np
import pytest

from command_line import tangible
from full_disk import files_up_to
from tangible_core import DisparityMap, Pipeline, Recording, Scene, SegmentMap, Views
from tangible_core.data import TICK_COLUMNS, PartMap
from tangible_core.errors import ConfigError, OutputError, Stopped, UnknownMethod
from tangible_core.parts import reduced_parts
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.pipeline.engine.working_grid import parts_on_grid
from tangible_core.pipeline.feeling import Feeling
from tangible_core.pipeline.output import result_folders
from tangible_core.pipeline.output.exporting import MAX_STEM_BYTES, export_stem
from tangible_core.pipeline.output.parts_text import part_heights
from tangible_core.pipeline.output.result_folders import move, read_list
from tangible_core.plugins import DepthEstimator, Exporter, Segmenter, Work
from tangible_core.plugins.registry import default_registry

LABELS = np.kron(np.int32([[0, 1, 1], [0, 2, 2]]), np.ones((24, 24), np.int32))
PHOTO = (LABELS * 90).astype(np.uint8)
LABELLED = Scene.photo(PHOTO, segments=LABELS, name="still life")
SAID: Any = {"parts": {1: "wall", 2: {"name": "box", "height_m": 0.004}, 3: {"height_m": 0.002}}, "heights": "given"}


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
    product: str = "title"

    def write(self, work: Work, stem: Path) -> Any:
        getattr(work, self.product)
        return self.do(stem)


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


def link(stem: Path) -> tuple[Path, ...]:
    path = stem.with_suffix(".txt")
    path.symlink_to(__file__)
    return (path,)


def refuse(stem: Path) -> tuple[Path, ...]:
    raise OutputError(f"{stem.with_suffix('.txt')}: cannot be written")


def refused(text: str, place: Path, *sets: str) -> ConfigError:
    with pytest.raises(ConfigError) as error:
        parse_config(f"scene: builtin/coins\n{text}", place / "p.yaml", default_registry(), sets)
    return error.value


class TestWork:
    def test_work_has_products_words_and_a_title(self, tmp_path: Path):
        done = pipeline(**SAID, title="Ein Stück", language="de-AT", export=[Report(width_m=0.1)]).export(tmp_path)
        said = report_of(tmp_path)
        assert (said["title"], said["language"], said["names"]) == ("Ein Stück", "de-AT", ["wall", "box", ""])
        assert said["extent_m"][0] == 0.1
        assert [outcome.outcome for outcome in done.outcomes] == ["ran"]
        assert done.files == {"Report": (tmp_path / "Ein Stück.report",)}
        np.save(tmp_path / "old harbour.v2.npy", np.eye(8))
        Pipeline(Scene.heights(tmp_path / "old harbour.v2.npy"), cached=False).export(tmp_path / "out", [Report()])
        assert report_of(tmp_path / "out")["title"] == "old harbour.v2"
        assert (tmp_path / "out/old harbour-v2.report").is_file()

    def test_work_has_the_width_of_the_exporter_and_files_of_one_name_are_numbered(self, tmp_path: Path):
        exporters = [Report(), Report(width_m=0.16), Report(width_m=0.16)]
        done = pipeline(**SAID).export(tmp_path, exporters)
        widths = [json.loads(export.files[0].read_text())["extent_m"][0] for export in done.exports]
        assert widths == [0.08, 0.16, 0.16]
        made = [[each.product for each in one.made if each.outcome == "ran"] for one in done.exports]
        assert made == [["parts", "relief"], ["relief"], []]
        usual = [name for name, files in done.files.items() if files[0].stem == name.replace("Report", "still life")]
        assert usual == ["Report", "Report-2", "Report-3"]

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
                count = None if work.simplified is None else work.simplified.count
                return write_file(stem.with_suffix(".txt"), f"{count} {work.names}")

        (one,) = pipeline(**SAID).export(tmp_path, [Parts()]).exports
        assert one.files[0].read_text() == "3 ('wall', 'box', '')"
        (one,) = Pipeline(Scene.heights(np.eye(8)), cached=False).export(tmp_path, [Parts()]).exports
        assert one.files[0].read_text().startswith("None")
        assert not one.legible.readable

    def test_legibility_is_judged_at_the_width_of_the_files(self, tmp_path: Path):
        thing = pipeline(**SAID)
        (small, large) = (thing.export(tmp_path, [Fingers(width_m=each)]).exports[0] for each in (0.01, 0.16))
        assert (small.legible.readable, [note.kind for note in small.outcome.notes]) == (False, ["warning"])
        assert (large.legible.readable, large.outcome.notes) == (True, ())
        assert Feeling(thing).legible("swell", 0.16).readable
        assert not Feeling(thing).legible("swell", 0.01).readable


class TestSimplify:
    def test_simplified_parts_are_felt_in_their_places_with_relief_and_materials(self):
        labels = np.zeros((60, 80), np.int32)
        labels[10:40, 10:40], labels[20:24, 60:64] = 1, 2
        said = {"parts": {1: "ground", 2: {"height_m": 0.004}, 3: {"height_m": 0.003}}, "heights": "given"}
        scene = Scene.photo(labels.astype(np.uint8), segments=labels)
        plain, simple = (Pipeline(scene, cached=False, **said, **more) for more in ({}, {"simplify": {}}))
        assert np.unique(plain.surface.labels).tolist() == [0, 1, 2]
        assert np.unique(simple.surface.labels).tolist() == [0, 1]
        assert simple.surface.names == plain.surface.names == ("ground", "", "")
        assert simple.surface.height_m[22, 62] < 0.001 < plain.surface.height_m[22, 62]
        assert simple.surface.height_m.shape == plain.surface.height_m.shape
        assert len(simple.materials.materials) == simple.make("parts").count == simple.make("simplified").count == 3
        assert part_heights(simple.engine).heights_m == part_heights(plain.engine).heights_m
        parts = PartMap(np.int32([[0, 3, 2]]), (0, 1, 2, 3))
        felt = parts_on_grid(parts, (1, 8), "simplified")
        assert felt.labels.tolist() == [[0, 0, 0, 3, 3, 2, 2, 2]]
        assert parts_on_grid(parts, (1, 2), "parts").labels.tolist() == [[0, 2]]
        assert reduced_parts(PartMap(np.int32([[0, 0, 0, 2]]), (0, 1, 2)), (1, 2)).labels.tolist() == [[0, 2]]


class TestFiles:
    def test_later_export_replaces_an_earlier_one(self, tmp_path: Path):
        np.save(tmp_path / "map.npy", np.eye(8))
        for title in ("one", "two"):
            said = [f"title={title}"]
            config = parse_config("scene: {height: map.npy}", tmp_path / "coins.yaml", default_registry(), said)
            done = Pipeline.from_config(config, default_registry(), None).export(tmp_path, ["heights"])
            assert [outcome.outcome for outcome in done.outcomes] == ["ran"]
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
        assert (one.outcome.outcome, one.files) == ("refused", ())
        assert "is there already" in one.outcome.why
        assert "--force" in one.outcome.why
        assert path.read_text() == kept
        (one,) = pipeline(**SAID).export(out, [Report()], force=True).exports
        assert one.files == (path,)
        assert path.read_text() != kept

    def test_files_are_moved_all_or_none_by_one_export_of_a_name(self, tmp_path: Path):
        (tmp_path / "still life.b").mkdir()

        def both(stem: Path) -> tuple[Path, ...]:
            return (*write_file(stem.with_suffix(".a")), *write_file(stem.with_suffix(".b")))

        (one,) = pipeline().export(tmp_path, [Does(do=both)], force=True).exports
        assert one.outcome.outcome == "refused"
        assert sorted(path.name for path in tmp_path.iterdir()) == ["still life.b"]

        def export_another(stem: Path) -> tuple[Path, ...]:
            with pytest.raises(OutputError, match="another program is writing"):
                pipeline(**SAID, language="de").export(tmp_path, [Report()])
            other = Pipeline(Scene.photo(PHOTO, segments=LABELS, name="other"), cached=False, **SAID)
            assert other.export(tmp_path, [Report()]).files == {"Report": (tmp_path / "other.report",)}
            return write_file(stem.with_suffix(".first"))

        pipeline(**SAID, language="fr").export(tmp_path, [Report(), Does(do=export_another)])
        assert json.loads((tmp_path / "still life.report").read_text())["language"] == "fr"
        beside = write_file(tmp_path / "still life.second")[0]
        assert (tmp_path / "still life.first").stat().st_mode == beside.stat().st_mode

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

    @pytest.mark.parametrize(
        ("title", "stem"),
        [
            ("a/b\\c:d.e", "a-b-c-d-e"),
            ("東京 ♞", "東京"),
            ("...", "export"),
            ("x" * 300, "x" * MAX_STEM_BYTES),
            ("ß" * 200, "ß" * (MAX_STEM_BYTES // 2)),
        ],
    )
    def test_stem_of_any_title_is_a_file_name(self, title: str, stem: str):
        config = pipeline(title=title[:200]).config
        assert export_stem(config, Scene("x" * 300) if title[:2] == "xx" else LABELLED) == stem[: len(stem)]


class TestFailures:
    FAULTS: ClassVar[dict[str, tuple[Callable[[Path], Any], str, str]]] = {
        "raises": (lambda stem: 1 / 0, "failed", "ZeroDivisionError"),
        "exits": (lambda stem: exit(3), "failed", "called sys.exit"),
        "no tuple": (lambda stem: str(stem), "failed", "gave the str"),
        "nothing": (lambda stem: (), "failed", "no path"),
        "no path": (lambda stem: (7,), "failed", "returned 7"),
        "no such file": (lambda stem: (stem.with_suffix(".txt"),), "failed", "no such file"),
        "a link": (link, "failed", "no such file"),
        "outside": (lambda stem: write_file(stem.parent.parent / "x.txt"), "failed", "is not the given stem"),
        "another name": (lambda stem: write_file(stem.with_name("x.txt")), "failed", "is not the given stem"),
        "a way out": (lambda stem: (stem.parent / f"{stem.name}/../../etc",), "failed", "is not the given stem"),
        "fills the disk": (lambda stem: write_file(stem.with_suffix(".txt"), "x" * 100_000), "refused", "space"),
        "refuses": (refuse, "refused", "/out/still life.txt: cannot be written"),
    }  # fmt: skip

    @pytest.mark.parametrize("fault", FAULTS)
    def test_failure_is_one_line_and_the_others_write(self, tmp_path: Path, fault: str):
        do, became, why = self.FAULTS[fault]
        with files_up_to(10_000):
            first, other = pipeline(**SAID).export(tmp_path / "out", [Does(do=do), Report()]).exports
        assert (first.outcome.outcome, first.files) == (became, ())
        assert why in first.outcome.why
        assert "\n" not in first.outcome.why
        assert other.files
        written = {path.name for path in (tmp_path / "out").iterdir()} - {"x.txt"}
        assert written == {".exports.json", "still life.report"}

    @pytest.mark.parametrize(
        ("made", "exporter", "outcome", "why"),
        [
            (SAID, Does(do=lambda stem: None, product="parts"), "failed", "needs"),
            (SAID, NeedsATouch(), "failed", "'touch'"),
            ({}, Report(), "refused", "depth"),
            *((SAID, Report(width_m=width_m), "refused", "width") for width_m in (0.0, -1.0, float("nan"), 1e9)),
        ],
    )
    def test_exporter_with_impossible_needs_writes_nothing(
        self, tmp_path: Path, made, exporter, outcome: str, why: str
    ):
        (one,) = pipeline(**made).export(tmp_path, [exporter]).exports
        assert (one.outcome.outcome, one.files) == (outcome, ())
        assert why in one.outcome.why

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

    def test_full_disk_at_the_list_leaves_no_file(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
        """A file that no list names would be in the way of the next export."""
        monkeypatch.setattr(result_folders, "write_text", lambda path, text: refuse(path))
        (one,) = pipeline(**SAID).export(tmp_path, [Report()]).exports
        assert (one.outcome.outcome, list(tmp_path.iterdir())) == ("refused", [])


class TestEnding:
    def test_export_is_stopped_from_another_thread(self, tmp_path: Path):
        stop, heard = Event(), list[str]()
        halfway = Does(do=lambda stem: stop.set() or write_file(stem.with_suffix(".txt")))
        with pytest.raises(Stopped):
            pipeline(**SAID).export(tmp_path, [halfway, Report()], lambda stage: heard.append(stage.product), stop=stop)
        assert (list(tmp_path.iterdir()), heard) == ([], ["export: Does"])

    @pytest.mark.parametrize("error", [KeyboardInterrupt, Stopped])
    def test_interrupted_export_leaves_no_partial_files_and_sweeps_those_of_a_killed_one(
        self, tmp_path: Path, error: type[BaseException]
    ):
        left = tmp_path / ".export.0123456789ab.tangible"
        left.mkdir()
        os.utime(left, (1, 1))

        def halfway(stem: Path) -> Any:
            write_file(stem.with_suffix(".txt"))
            raise error

        done = [Report(), Does(do=halfway), Report()]
        with pytest.raises(error):
            pipeline(**SAID).export(tmp_path, done)
        assert sorted(path.name for path in tmp_path.iterdir()) == [".exports.json", "still life.report"]


class TestDocument:
    def test_names_and_places_of_exporters_are_checked(self, tmp_path: Path):
        config = parse_config(
            "scene: builtin/coins\nsimplify: {gap_m: 4 mm}\nexport: [heights, {use: heights, width_m: 160 mm}]",
            tmp_path / "p.yaml", default_registry(),
        )  # fmt: skip
        assert [each.method.width_m for each in config.export] == [None, 0.16]
        assert config.simplify.gap_m == 0.004
        again = parse_config(config.as_yaml(), tmp_path / "q.yaml", default_registry())
        assert again.export == config.export
        assert again.simplify == config.simplify
        for text in ("export:", "simplify:", "export: []"):
            config = parse_config(f"scene: builtin/coins\n{text}", tmp_path / "p.yaml", default_registry())
            assert (config.export, config.simplify) == ((), None)
        for text, column, word in (
            ("export: stl", 1, "list"),
            ("export: [hights]", 10, "'heights'"),
            ("export: [{width_m: 1}]", 10, "needs the name"),
            ("export: [7]", 10, "needs the name"),
            ("export: [{use: heights, wid_m: 1}]", 25, "wid_m"),
            ("simplify: yes", 1, "mapping"),
            ("simplify: {gap_m: -1}", 12, "gap_m"),
        ):
            error = refused(text, tmp_path)
            assert f"p.yaml:2:{column}: " in str(error)
            assert word in str(error)

    @pytest.mark.parametrize(
        ("before", "sets", "after"),
        [
            ("", ["export.heights.width_m=0.1"], [0.1]),
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
        for override in ("export.hights.width_m=1", "export.heights.wid_m=1", "export.heights=1", "export.9.width_m=1"):
            assert override.partition("=")[0].split(".")[1] in str(refused("", tmp_path, override))


class TestCommand:
    @pytest.fixture
    def place(self, tmp_path: Path) -> Path:
        np.save(tmp_path / "map.npy", np.linspace(0, 1, 48, dtype=np.float32).reshape(6, 8))
        (tmp_path / "map.yaml").write_text("scene: {height: map.npy}\nexport: [heights]\n")
        return tmp_path

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

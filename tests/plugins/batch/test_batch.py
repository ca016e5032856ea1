"""Batches: many scenes through one pipeline; failures are rows, and unchanged scenes are not made again."""

import csv
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from threading import Event

import numpy as np
import pytest

from command_line import tangible
from english import english_of
from farm_here import Here
from full_disk import files_up_to
from pictures import write_png
from tangible_batch import batch, job, results, running
from tangible_batch.farm import Done
from tangible_batch.job import Job, make_scene
from tangible_batch.manifest import rows_of
from tangible_core import Pipeline, Scene
from tangible_core.errors import ArgumentError, BatchError, OutputError, ResultsError, Stopped
from videos import greys

CONFIG = "scene: builtin/brick\nwant: relief\ndepth: luminance\nworkspace: {width_m: 0.04}\n"


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running, "Farm", Here)


@pytest.fixture
def archive(tmp_path: Path) -> Path:
    folder = tmp_path / "archive"
    folder.mkdir()
    for number in range(4):
        write_png(folder / f"p{number}.png", picture(number))
    (tmp_path / "mine.yaml").write_text(CONFIG)
    return folder


def picture(seed: int, shape: tuple[int, ...] = (24, 32)) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, shape, np.uint8)


def rows_in(out: Path) -> list[dict]:
    return [json.loads(line) for line in (out / "rows.jsonl").read_text().splitlines()]


def by_id(rows) -> dict[str, dict]:
    return {row["id"]: row for row in rows}


def damage_first_page(path: Path) -> None:
    import pyarrow
    import pyarrow.parquet

    pyarrow.parquet.write_table(pyarrow.table({"id": [str(number) for number in range(100)]}), path)
    data = bytearray(path.read_bytes())
    data[30:60] = b"\xff" * 30
    path.write_bytes(data)


ROW = {"id": "a\udcff", "key": "k", "outcome": "ok", "error": None, "seconds": 1, "folder": "scenes/a"}
"""As little as a row has; a name may have bytes that are not characters."""


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"id": None}, "id"),
        ({"id": 3}, "id"),
        ({"outcome": "done"}, "outcome"),
        ({"folder": ["a"]}, "folder"),
        ({"seconds": "1"}, "seconds"),
        ({"seconds": 10**400}, "seconds"),
        ({"figures": {"surface": {"width_mm": 4.0, "length_mm": 3.0}}}, "figures.surface.height_mm"),
        ({"figures": {"force": {}}}, "figures.force.peak_force_n"),
        ({"figures": {"disparity": {"bad2": [1]}}}, "figures.disparity.bad2"),
        ({"notes": "dark"}, "notes"),
    ],
)
def test_damaged_row_is_refused_with_its_line_and_field(tmp_path: Path, change: dict, place: str):
    (tmp_path / "rows.jsonl").write_text("".join(json.dumps(row) + "\n" for row in (ROW, ROW | change)))
    with pytest.raises(ResultsError, match=rf"rows\.jsonl:2: {place}: .*; remove the line$"):
        results.last_rows(tmp_path)
    (tmp_path / "rows.jsonl").write_text(json.dumps(ROW) + "\n")
    assert results.last_rows(tmp_path) == {ROW["id"]: ROW}


def test_half_characters_of_a_row_are_question_marks_in_the_gallery(tmp_path: Path):
    odd = "a\udcff"
    row = ROW | {"card": odd, "files": [f"sheet.{odd}", f"{odd}.html"], "notes": [odd], "scene": odd, "folder": odd}
    (tmp_path / "rows.jsonl").write_text(json.dumps(row) + "\n")
    (page,) = results.write_gallery(tmp_path, [ROW["id"]])
    assert 'src="a%3F/a?"' in page.read_text()


def test_figure_of_a_damaged_row_is_a_cell_of_the_table_whatever_it_is(tmp_path: Path):
    import pyarrow.parquet as pq

    row = ROW | {"figures": {"b\udcff": 10**400, "c": [1, "\udcff"], "d": True}}
    (tmp_path / "rows.jsonl").write_text(json.dumps(row) + "\n")
    (line,) = pq.read_table(results.write_index(tmp_path, [ROW["id"]])).to_pylist()
    assert (line["figures.b?"], line["figures.c"], line["figures.d"]) == (1e300, "1; ?", 1)


class TestScenes:
    @pytest.fixture(autouse=True)
    def one_process(self, here):
        pass

    def run(self, cwd: Path, *words: object):
        return tangible("batch", "mine.yaml", "--over", "archive", *words, cwd=cwd)

    def test_folder_gives_rows_files_a_table_and_a_gallery(self, archive: Path):
        import pyarrow.parquet as pq

        done = self.run(archive.parent)
        assert done.returncode == 0, done.stderr
        assert "4 of 4 scenes are made." in done.stdout
        out = archive.parent / "out/mine-batch"
        rows = by_id(rows_in(out))
        assert sorted(rows) == ["p0", "p1", "p2", "p3"]
        assert all(row["outcome"] == "ok" and row["seconds"] > 0 and "relief" in row["stages"] for row in rows.values())
        for row in rows.values():
            assert sorted(path.name for path in (out / row["folder"]).iterdir()) == sorted(row["files"])
        table = pq.read_table(out / "index.parquet").to_pydict()
        assert sorted(table["id"]) == sorted(rows)
        assert set(table["outcome"]) == {"ok"}
        page = (out / "gallery.html").read_text()
        for number in range(4):
            found = re.search(rf'<figure class="ok">.{{0,60}}src="scenes/p{number}/card.jpg".*?</figure>', page)
            assert found, number
            assert f'title="p{number}.png"' in found[0]
            assert f'alt="p{number}: the picture, and the relief made of it"' in found[0]
            assert f'<a href="scenes/p{number}/">p{number}</a>' in found[0]
            assert re.search(r"relief made in [\d.e-]+ s", found[0])

    def test_gallery_says_what_was_found_of_a_surface(self, archive: Path):
        done = self.run(archive.parent, "--set", "want=surface", "--set", "texture={use: histogram, segments: 2}")
        assert done.returncode == 0, done.stderr
        page = (archive.parent / "out/mine-batch/gallery.html").read_text()
        found = r"surface made in [\d.e-]+ s; 40 x \d+ mm, [\d.]+ mm high; [12] segments"
        assert len(re.findall(found, page)) == 4, page

    def test_gallery_is_in_the_language_of_the_terminal(self, archive: Path):
        (archive / "p3.png").write_bytes(b"no")
        done = self.run(archive.parent, "--lang", "de")
        assert done.returncode == 1
        page = (archive.parent / "out/mine-batch/gallery.html").read_text()
        assert '<html lang="de">' in page
        assert 'alt="p0: das Bild, und daraus berechnet: Relief"' in page
        assert re.search(r"Relief in [\d,e-]+ s berechnet", page)
        assert "ist kein Bild" in page, "the error of a picture too"
        assert not english_of(re.sub(r"<style>.*?</style>|<[^>]*>", " ", page))

    def test_pictures_that_a_shell_expanded_are_taken(self, archive: Path):
        pictures = [f"archive/p{number}.png" for number in range(3)]
        done = tangible("batch", "mine.yaml", "--over", *pictures, cwd=archive.parent)
        assert done.returncode == 0, done.stderr
        assert "3 of 3 scenes are made." in done.stdout
        before = tangible("batch", "--over", *pictures, "mine.yaml", "--json", cwd=archive.parent)
        assert json.loads(before.stdout)["kept"] == 3, "the same names, wherever the words stand"
        odd = tangible("batch", "mine.yaml", "--over", *pictures, "archive/nothing.png", cwd=archive.parent)
        assert (odd.returncode, odd.stderr.partition(";")[0]) == (2, "archive/nothing.png: there is no such file")

    def test_warning_names_its_picture(self, archive: Path):
        done = self.run(archive.parent, "--set", "depth=auto", "--set", "relief=disparity")
        said = re.findall(r"(\w+): one picture contains no depth", done.stderr)
        assert sorted(said) == ["p0", "p1", "p2", "p3"], done.stderr

    def test_scene_equals_that_of_a_run(self, archive: Path, tmp_path: Path):
        from tangible_core.pipeline.engine.cache import read_record

        self.run(archive.parent, "--set", "workspace.width_m=0.06")
        found = read_record(tmp_path / "out/mine-batch/scenes/p2/relief.npz")
        scene = Scene.photo(archive / "p2.png")
        from tangible_depth import Luminance

        same = Pipeline(scene, depth=Luminance(), workspace={"width_m": 0.06}, cached=False).relief
        assert found.digest() == same.digest()

    def test_bad_pictures_are_rows_with_the_usual_errors(self, tmp_path: Path):
        folder = tmp_path / "archive"
        folder.mkdir()
        (tmp_path / "mine.yaml").write_text(CONFIG.replace("luminance", "semi-global"))
        pair = picture(1, (48, 90))
        for name in ("good", "cut", "empty", "sizes", "none", "alone"):
            write_png(folder / f"{name}_left.png", pair)
            write_png(folder / f"{name}_right.png", np.roll(pair, -3, axis=1))
        whole = (folder / "cut_left.png").read_bytes()
        (folder / "cut_left.png").write_bytes(whole[: len(whole) // 2])
        (folder / "empty_left.png").write_bytes(b"")
        write_png(folder / "sizes_right.png", pair[:20])
        (folder / "none_right.png").write_text("not a picture")
        (folder / "alone_right.png").unlink()
        done = self.run(tmp_path)
        assert done.returncode == 1
        rows = by_id(rows_in(tmp_path / "out/mine-batch"))
        errors = {name: row["error"] for name, row in rows.items()}
        assert errors["good"] is None
        assert set(rows) == {"good", "cut", "empty", "sizes", "none", "alone_left"}
        for name, said in {
            "cut": "cut_left.png",
            "empty": "empty_left.png",
            "sizes": "must be of one size",
            "none": "none_right.png",
            "alone_left": "two views",
        }.items():
            assert said in errors[name]
            assert f"{name}: " in done.stderr
        assert "5 failed: --retry repeats these" in done.stdout

    def test_manifest_rows_set_keys_and_name_files(self, archive: Path):
        with (archive / "rows.csv").open("w", newline="") as file:
            table = csv.writer(file)
            table.writerow(["id", "scene.photo", "workspace.width_m", "depth.smoothing_px"])
            table.writerows([["wide", "p0.png", "0.1", ""], ["rough", "p0.png", "", 0], ["own", "", "0.03", ""]])
        done = tangible("batch", "mine.yaml", "--over", archive / "rows.csv", "--json", cwd=archive.parent)
        assert done.returncode == 0, done.stderr
        assert json.loads(done.stdout)["made"] == 3
        rows = by_id(rows_in(archive.parent / "out/mine-batch"))
        assert rows["own"]["scene"] == "builtin/brick"
        assert rows["wide"]["scene"] == rows["rough"]["scene"] == str(archive / "p0.png")
        assert rows["wide"]["key"] != rows["rough"]["key"]

    def test_row_with_a_video_is_made(self, here: None, archive: Path):
        greys(archive / "walk.avi", 2)
        rows = [{"id": "film", "scene.video": archive / "walk.avi"}, {"id": "frames", "scene.video": archive}]
        done = list(batch(Pipeline.from_yaml(archive.parent / "mine.yaml"), rows, archive.parent / "out"))
        assert [(row["outcome"], row["scene"]) for row in done] == [
            ("ok", f"{archive / 'walk.avi'}"),
            ("ok", f"{archive}"),
        ]

    def test_folder_without_pictures_gives_its_videos(self, archive: Path):
        """A phone lays a film of the same name beside each photo."""
        greys(archive / "p0.avi", 2)
        assert all("scene.photo=" in row.sets[0] for row in rows_of(str(archive)))
        films = archive / "films"
        films.mkdir()
        greys(films / "walk.avi", 2)
        greys(films / "run.MP4", 2)
        (films / "notes.txt").touch()
        rows = {row.id: row.sets for row in rows_of(str(films))}
        assert rows == {
            name: (f'scene.video="{films / file}"',) for name, file in (("run", "run.MP4"), ("walk", "walk.avi"))
        }

    def test_parquet_manifest_gives_its_rows(self, archive: Path):
        import pyarrow as pa
        import pyarrow.parquet as pq

        table = {"id": ["a", "b"], "scene.photo": ["p1.png", "p2.png"], "workspace.width_m": [0.05, None]}
        pq.write_table(pa.table(table), archive / "rows.parquet")
        done = tangible("batch", "mine.yaml", "--over", archive / "rows.parquet", cwd=archive.parent)
        assert done.returncode == 0, done.stderr
        assert sorted(by_id(rows_in(archive.parent / "out/mine-batch"))) == ["a", "b"]

    def test_second_batch_makes_changed_scenes_only(self, archive: Path):
        tally = [json.loads(self.run(archive.parent, "--json").stdout) for _ in range(2)]
        assert [(each["made"], each["kept"]) for each in tally] == [(4, 0), (0, 4)]
        write_png(archive / "p1.png", picture(9, (30, 30)))
        assert json.loads(self.run(archive.parent, "--json").stdout)["made"] == 1
        assert json.loads(self.run(archive.parent, "--json", "--set", "want=surface").stdout)["made"] == 4
        words = ("--json", "--set", "want=surface", "--sheets")
        assert json.loads(self.run(archive.parent, *words).stdout)["made"] == 4

    def test_batch_of_a_newer_program_makes_all_scenes_again(self, archive: Path, monkeypatch: pytest.MonkeyPatch):
        from tangible_batch import job_maker

        self.run(archive.parent)
        monkeypatch.setattr(job_maker.metadata, "version", lambda name: "1000.0")
        assert json.loads(self.run(archive.parent, "--json").stdout)["made"] == 4

    def test_failed_scenes_are_made_again_with_retry(self, archive: Path):
        whole = (archive / "p1.png").read_bytes()
        (archive / "p1.png").write_bytes(b"no")
        stamp = (archive / "p1.png").stat()
        self.run(archive.parent)
        tally = json.loads(self.run(archive.parent, "--json").stdout)
        assert (tally["made"], tally["kept"], tally["failed"]) == (0, 4, 1)
        (archive / "p1.png").write_bytes(whole)
        os.utime(archive / "p1.png", ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
        done = json.loads(self.run(archive.parent, "--json", "--retry").stdout)
        assert (done["made"], done["failed"]) == (1, 0)
        import pyarrow.parquet as pq

        table = pq.read_table(archive.parent / "out/mine-batch/index.parquet").to_pydict()
        assert (sorted(table["id"]), set(table["outcome"])) == (["p0", "p1", "p2", "p3"], {"ok"})

    def test_torn_last_line_is_removed_and_its_scene_made_again(self, archive: Path):
        out = archive.parent / "out/mine-batch"
        self.run(archive.parent)
        text = (out / "rows.jsonl").read_text()
        (out / "rows.jsonl").write_text(text[:-20])
        assert json.loads(self.run(archive.parent, "--json").stdout)["made"] == 1
        assert sorted(by_id(rows_in(out))) == ["p0", "p1", "p2", "p3"]

    def test_full_disk_ends_the_batch_which_then_continues(self, archive: Path, monkeypatch: pytest.MonkeyPatch):
        def full(*_: object) -> None:
            raise OutputError("relief.npz: cannot be written") from OSError(28, "No space left on device")

        with monkeypatch.context() as patch:
            patch.setattr(job, "write_record", full)
            done = self.run(archive.parent)
        assert done.returncode == 2
        assert "the batch ends here, and the same command continues from there" in done.stderr
        out = archive.parent / "out/mine-batch"
        assert rows_in(out) == []
        assert json.loads(self.run(archive.parent, "--json").stdout)["made"] == 4

    def test_row_on_a_full_disk_is_not_half_written(self, archive: Path, tmp_path: Path):
        from tangible_core.files.json_lines import JsonLines

        with JsonLines(tmp_path / "rows.jsonl") as file:
            file.add({"id": "a"})
            with files_up_to(20), pytest.raises(OutputError, match=r"rows\.jsonl: cannot be written"):
                file.add({"id": "b" * 100})
            file.add({"id": "c"})
        assert (tmp_path / "rows.jsonl").read_text() == '{"id": "a"}\n{"id": "c"}\n'

    @pytest.mark.parametrize(
        ("over", "said"),
        [
            ("nowhere/*.png", "holds no picture and no row"),
            ("rows.csv", "cannot be read: No such file"),
            ("twice.csv", "two rows are called 'a'"),
            ("broken.parquet", "is not a Parquet file"),
            ("cells.csv", "more cells than there are columns"),
            ("latin.csv", "latin.csv: is not a table: 'utf-8' codec"),
            ("page.parquet", "page.parquet: is not a Parquet file, or is damaged"),
            ("wrong", "unknown key"),
        ],
    )
    def test_command_with_a_mistake_reports_one_line_and_leaves_nothing(self, archive: Path, over: str, said: str):
        folder = archive.parent
        (folder / "twice.csv").write_text("id,scene.photo\na,archive/p0.png\na,archive/p1.png\n")
        (folder / "broken.parquet").write_text("PAR?")
        (folder / "latin.csv").write_bytes("id,title\na,Krüge\n".encode("latin-1"))
        (folder / "cells.csv").write_text("id,scene.photo\na,archive/p0.png,more\n")
        damage_first_page(folder / "page.parquet")
        (folder / "wrong").mkdir()
        write_png(folder / "wrong/p.png", picture(0))
        words = ("--set", "unknown=1") if over == "wrong" else ()
        done = tangible("batch", "mine.yaml", "--over", over, *words, cwd=folder)
        assert done.returncode == 2
        [line] = done.stderr.splitlines()
        assert said in line
        assert not (folder / "out").exists()

    def test_batch_in_python_yields_rows_and_stops(self, archive: Path, tmp_path: Path):
        from tangible_depth import Luminance

        pipeline = Pipeline.from_yaml(tmp_path / "mine.yaml")
        assert pipeline.config.depth is not None
        assert isinstance(pipeline.config.depth.method, Luminance)
        rows = [{"id": each.stem, "scene.photo": str(each)} for each in sorted(archive.glob("*.png"))]
        stop = Event()
        seen = []
        with pytest.raises(Stopped):
            for row in batch(pipeline, rows, tmp_path / "out", stop=stop):
                seen.append(row["id"])
                stop.set()
        assert seen == ["p0"]
        assert [row["id"] for row in batch(pipeline, rows, tmp_path / "out")] == ["p0", "p1", "p2", "p3"]

    def test_batch_in_python_with_a_mistake_reports_one_line(self, archive: Path, tmp_path: Path):
        pipeline, out = Pipeline.from_yaml(tmp_path / "mine.yaml"), tmp_path / "out"
        photo = {"scene.photo": str(archive / "p0.png")}
        with pytest.raises(BatchError, match="two rows are called 'a'; give each its own `id`"):
            list(batch(pipeline, [{"id": "a", **photo}, {"id": "a", **photo}], out))
        with pytest.raises(ArgumentError, match="workers: is the int 0"):
            list(batch(pipeline, [photo], out, workers=0))
        assert list(batch(pipeline, [], out)) == []

    def test_row_in_python_with_a_relative_file_is_made_in_its_time(
        self, archive: Path, monkeypatch: pytest.MonkeyPatch
    ):
        monkeypatch.chdir(archive)  # not the folder of the pipeline file
        limits: list[float] = []

        class Timed(Here):
            def map(self, work, jobs, chunk=1, timeout_s=1.0):
                limits.append(timeout_s)
                return super().map(work, jobs, chunk, timeout_s)

        monkeypatch.setattr(running, "Farm", Timed)
        pipeline = Pipeline.from_yaml(archive.parent / "mine.yaml")
        [row] = batch(pipeline, [{"scene.photo": "p0.png"}], archive.parent / "out", timeout_s=7.0)
        assert (row["id"], row["scene"], limits) == ("0", str(archive / "p0.png"), [7.0])

    def test_scene_whose_worker_died_is_a_row_that_failed_and_is_repeated_on_request(
        self, archive: Path, monkeypatch: pytest.MonkeyPatch
    ):
        class Dying(Here):
            def map(self, work, jobs, chunk=1, timeout_s=1.0):
                for done in super().map(work, jobs, chunk, timeout_s):
                    yield Done(done.job, None, "its worker died of it") if done.job.id == "p2" else done

        monkeypatch.setattr(running, "Farm", Dying)
        pipeline, out = Pipeline.from_yaml(archive.parent / "mine.yaml"), archive.parent / "out"
        rows = [{"id": f"p{number}", "scene.photo": archive / f"p{number}.png"} for number in (3, 2, 9, 0)]
        first = list(batch(pipeline, rows, out))
        assert [row["id"] for row in first] == [row["id"] for row in rows_in(out)] == ["p3", "p2", "p9", "p0"]
        assert [row["outcome"] for row in first] == ["ok", "failed", "failed", "ok"]
        assert (first[1]["error"], first[1]["seconds"], first[1]["folder"]) == (
            "its worker died of it",
            None,
            "scenes/p2",
        )
        assert "p9.png: there is no such file" in first[2]["error"]
        monkeypatch.setattr(running, "Farm", Here)
        assert list(batch(pipeline, rows, out)) == first, "nothing is made again unasked"
        again = list(batch(pipeline, rows, out, retry=True))
        assert [(row["id"], row["outcome"]) for row in again] == [
            ("p3", "ok"), ("p0", "ok"), ("p2", "ok"), ("p9", "failed"),
        ]  # fmt: skip
        assert [row["id"] for row in rows_in(out)] == ["p3", "p2", "p9", "p0", "p2", "p9"]
        write_png(archive / "p9.png", picture(9))
        assert [row["outcome"] for row in batch(pipeline, rows, out)] == ["ok"] * 4, "the file is there now"

    @pytest.mark.usefixtures("unchecked_shapes")
    def test_batch_of_something_else_is_refused(self):
        with pytest.raises(ArgumentError, match=r"pipeline: is .*; it must be a Pipeline"):
            list(batch("mine.yaml", []))  # pyright: ignore[reportArgumentType]

    def test_progress_counts_scenes_of_before_and_now(self, archive: Path, monkeypatch: pytest.MonkeyPatch):
        from tangible_core.plugins import hooks

        told: list[tuple[str, str]] = []
        tell = hooks.tell

        def listen(plugins, hook, **values):
            if hook == "tangible_stage_started" and values["method"] == "mine":
                told.append((values["product"].partition(",")[0], values["product"].endswith(" left)")))
            tell(plugins, hook, **values)

        self.run(archive.parent)
        for name in ("p1", "p3"):
            (archive / f"{name}.png").write_bytes(b"no")
        monkeypatch.setattr(hooks, "tell", listen)
        assert self.run(archive.parent).returncode == 1
        assert told == [("3 of 4 scenes (1 failed", True), ("4 of 4 scenes (2 failed", True)]

    @pytest.mark.parametrize("of_a_file", [True, False])
    def test_sweep_in_python_is_made_again_where_the_picture_has_changed(
        self, archive: Path, monkeypatch: pytest.MonkeyPatch, of_a_file: bool
    ):
        from tangible_depth import Luminance

        monkeypatch.chdir(archive)  # not the folder of the pipeline file
        (archive.parent / "mine.yaml").write_text(CONFIG.replace("builtin/brick", "{photo: archive/p0.png}"))
        of_python = Pipeline(Scene.photo(archive / "p0.png"), depth=Luminance(), workspace={"width_m": 0.04})
        pipeline = Pipeline.from_yaml(archive.parent / "mine.yaml") if of_a_file else of_python
        made = []
        for seed in (None, None, 5):
            if seed:
                write_png(archive / "p0.png", picture(seed, (20, 20)))
            [row] = batch(pipeline, [{"want": "relief", "workspace.smooth_m": 0}], archive.parent / "out")
            assert (row["outcome"], row["scene"]) == ("ok", str(archive / "p0.png")), row
            made.append(len(rows_in(archive.parent / "out")))
        assert made == [1, 1, 2]

    def test_words_of_the_command_reach_the_workers(self, archive: Path, monkeypatch: pytest.MonkeyPatch):
        farms: list[tuple] = []

        class Noted(Here):
            def __init__(self, *words: object) -> None:
                super().__init__()
                farms.append(words)

            def map(self, work, jobs, chunk=1, timeout_s=1.0):
                farms.append((chunk, timeout_s, {(each.threads, each.sheet, each.cache) for each in jobs}))
                return super().map(work, jobs, chunk, timeout_s)

        monkeypatch.setattr(running, "Farm", Noted)
        (archive / "rows.csv").write_text("id\n" + "".join(f"r{number}\n" for number in range(8)))
        (archive.parent / "mine.yaml").write_text(CONFIG.replace("builtin/brick", "{photo: archive/p0.png}"))
        words = ("batch", "mine.yaml", "--over", archive / "rows.csv")
        own = ("--workers", 2, "--threads", 3, "--timeout", 7.5, "--chunk", 3, "--cache", "kept", "--sheets")
        assert tangible(*words, *own, cwd=archive.parent).returncode == 0
        assert farms == [(2, 3, ""), (2, 7.5, {(3, True, str(archive.parent / "kept"))})]  # two of eight: four rounds
        assert list((archive.parent / "kept").glob("*.npz"))
        monkeypatch.setattr(running, "processors", lambda: 6)
        assert tangible(*words, "--out", "o", "--scheduler", "tcp://host:1", cwd=archive.parent).returncode == 0
        assert farms[2:] == [(6, 1, "tcp://host:1"), (2, 3600.0, {(None, False, "")})]
        assert tangible(*words, "--timeout", 0, cwd=archive.parent).returncode == 2

    def test_row_with_another_picture_keeps_the_options_of_the_scene(self, archive: Path):
        (archive.parent / "mine.yaml").write_text(
            CONFIG.replace("builtin/brick", "{left: l.png, right: r.png, rotate: 90}")
        )
        assert self.run(archive.parent).returncode == 0
        from tangible_core.pipeline.engine.cache import read_record

        found = read_record(archive.parent / "out/mine-batch/scenes/p2/relief.npz")
        assert found.height_m.shape == (32, 24)

    def test_scene_with_a_truth_has_the_figures_of_its_disparity(self, archive: Path):
        depth = np.linspace(1, 9, 24 * 32).reshape(24, 32)
        np.save(archive / "found.npy", depth)
        np.save(archive / "truth.npy", depth + 1.5)
        scene = "{photo: archive/p0.png, disparity: archive/found.npy, truth: archive/truth.npy}"
        (archive.parent / "mine.yaml").write_text(f"scene: {scene}\nwant: relief\n")
        (archive / "rows.csv").write_text("id,workspace.width_m\none,0.05\n")
        done = tangible("batch", "mine.yaml", "--over", archive / "rows.csv", cwd=archive.parent)
        assert done.returncode == 0, done.stderr
        [row] = rows_in(archive.parent / "out/mine-batch")
        assert row["figures"]["disparity"]["average_px"] == pytest.approx(1.5)

    def test_mistake_in_the_file_ends_the_batch_before_the_first_scene(self, archive: Path):
        (archive.parent / "mine.yaml").write_text(CONFIG + "textur: gabor\n")
        done = self.run(archive.parent)
        assert done.returncode == 2
        [line] = done.stderr.splitlines()
        assert "mine.yaml" in line
        assert "textur" in line
        assert not (archive.parent / "out").exists()

    def test_mistake_in_a_row_fails_that_row_only(self, archive: Path):
        (archive / "rows.csv").write_text("id,scene.photo,workspace.width_m\na,p0.png,-1\nb,p1.png,0.1\n")
        done = tangible("batch", "mine.yaml", "--over", archive / "rows.csv", cwd=archive.parent)
        assert done.returncode == 1
        rows = by_id(rows_in(archive.parent / "out/mine-batch"))
        assert "workspace.width_m" in rows["a"]["error"]
        assert rows["b"]["outcome"] == "ok"

    def test_sweep_with_a_changed_picture_is_made_again(self, archive: Path):
        (archive.parent / "mine.yaml").write_text(CONFIG.replace("builtin/brick", "{photo: archive/p0.png}"))
        (archive / "rows.csv").write_text("workspace.width_m\n0.05\n0.1\n")
        words = ("batch", "mine.yaml", "--over", archive / "rows.csv", "--json")
        made = []
        for seed in (None, None, 5):
            if seed:
                write_png(archive / "p0.png", picture(seed, (20, 20)))
            made.append(json.loads(tangible(*words, cwd=archive.parent).stdout)["made"])
        assert made == [2, 0, 2]

    @pytest.mark.parametrize("name", ["Krug ä", "\N{AMPHORA}", 'a "quoted" one', "two\nlines", "b\udcff"])
    def test_picture_with_any_name_is_made(self, archive: Path, name: str):
        for each in archive.iterdir():
            each.unlink()
        write_png(archive / f"{name}.png", picture(0))
        tally = []
        for seed in (0, 0, 3):
            if seed:
                write_png(archive / f"{name}.png", picture(seed, (16, 16)))
            tally.append(json.loads(self.run(archive.parent, "--json").stdout))
        assert [each["made"] for each in tally] == [1, 0, 1]
        [row] = rows_in(archive.parent / "out/mine-batch")[1:]
        assert row["id"] == name
        if name != "b\udcff":  # no YAML holds half a character
            assert row["outcome"] == "ok", row["error"]

    def test_pictures_in_the_results_are_left_out(self, archive: Path):
        words = ("batch", "mine.yaml", "--over", ".", "--json")
        tally = [json.loads(tangible(*words, cwd=archive.parent).stdout) for _ in range(2)]
        assert [each["wanted"] for each in tally] == [4, 4]

    def test_table_leaves_out_scenes_that_are_gone(self, archive: Path):
        import pyarrow.parquet as pq

        out = archive.parent / "out/mine-batch"
        self.run(archive.parent)
        (archive / "p0.png").unlink()
        self.run(archive.parent)
        assert sorted(by_id(rows_in(out))) == ["p0", "p1", "p2", "p3"]
        assert pq.read_table(out / "index.parquet")["id"].to_pylist() == ["p1", "p2", "p3"]
        assert "p0" not in (out / "gallery.html").read_text()

    def test_scene_with_deleted_files_is_made_again(self, archive: Path):
        import shutil

        self.run(archive.parent)
        shutil.rmtree(archive.parent / "out/mine-batch/scenes/p2")
        assert json.loads(self.run(archive.parent, "--json").stdout)["made"] == 1

    @pytest.mark.parametrize("want", ["segments", "disparity", "materials", "surface"])
    def test_wanted_product_has_a_card(self, archive: Path, want: str):
        from PIL import Image

        (archive.parent / "mine.yaml").write_text(
            f"scene: builtin/brick\nwant: {want}\ntexture: {{use: histogram, segments: 2}}\n"
            + ("" if want in ("segments", "materials") else "depth: luminance\n")
        )
        done = self.run(archive.parent)
        assert done.returncode == 0, done.stderr
        with Image.open(archive.parent / "out/mine-batch/scenes/p1/card.jpg") as card:
            assert card.width == 2 * 160

    def test_exports_of_the_file_are_in_each_scene_s_folder(self, archive: Path):
        (archive.parent / "mine.yaml").write_text(CONFIG + "texture: {use: histogram, segments: 2}\nexport: [text]\n")
        (archive / "p3.png").write_bytes(b"no")
        assert self.run(archive.parent).returncode == 1
        out = archive.parent / "out/mine-batch"
        for row in rows_in(out):
            if row["outcome"] == "ok":
                exported = {Path(name).suffix for name in row["files"]}
                assert {".txt", ".html"} <= exported, row
                assert all((out / row["folder"] / name).is_file() for name in row["files"])
        (archive / "p2.png").touch()
        os.utime(archive / "p2.png", (1, 1))
        write_png(archive / "p3.png", picture(3))
        assert json.loads(self.run(archive.parent, "--json").stdout)["made"] == 2

    def test_failing_exporter_fails_its_scene(self, archive: Path, monkeypatch: pytest.MonkeyPatch):
        from tangible_report import Text

        def fails(*_: object) -> None:
            raise OutputError("the ink is dry")

        monkeypatch.setattr(Text, "write", fails)
        (archive.parent / "mine.yaml").write_text(CONFIG + "texture: {use: histogram, segments: 2}\nexport: [text]\n")
        done = self.run(archive.parent)
        assert done.returncode == 1
        assert "the ink is dry" in rows_in(archive.parent / "out/mine-batch")[0]["error"]

    def test_second_batch_in_the_same_folder_is_refused(self, archive: Path):
        from tangible_core.files.json_lines import JsonLines

        with JsonLines(archive.parent / "out/mine-batch/rows.jsonl", alone=True) as file:
            file.add({"id": "other"})
            done = self.run(archive.parent)
        assert done.returncode == 2
        assert "another program is writing to it; wait for that one or choose another folder" in done.stderr
        assert len(rows_in(archive.parent / "out/mine-batch")) == 1

    def test_batch_without_the_extra_is_refused_before_the_work(self, archive: Path, monkeypatch: pytest.MonkeyPatch):
        from tangible_batch import extra

        monkeypatch.setattr(extra, "find_spec", lambda name: None)
        done = self.run(archive.parent)
        assert done.returncode == 2
        assert "pip install distributed pyarrow" in done.stderr
        with pytest.raises(BatchError, match=r"needs nowhere_at_all \(No module .*\); pip install distributed pyarrow"):
            extra.need("nowhere_at_all")

    def test_folder_names_are_safe_on_any_system(self, archive: Path, tmp_path: Path):
        rows = [
            {"id": name, "scene.photo": str(archive / "p0.png")} for name in ("a/b", "a_b", "..", "ä:*?", "x" * 300)
        ]
        made = list(batch(Pipeline.from_yaml(tmp_path / "mine.yaml"), rows, tmp_path / "out"))
        folders = {row["folder"] for row in made}
        assert len(folders) == len(rows)
        assert [row["error"] for row in made] == [None] * len(rows)
        assert all(Path(tmp_path / "out", each).resolve().parent == tmp_path / "out/scenes" for each in folders)


def test_workforce_uses_all_cores_by_default(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(running, "processors", lambda: 8)
    shares = {(None, None): (8, 1), (2, None): (2, 4), (None, 4): (2, 4), (16, None): (16, 1), (3, 9): (3, 9)}
    who = {said: running.Workforce(*said) for said in shares}
    assert {said: (each.workers_here, each.threads_each) for said, each in who.items()} == shares
    elsewhere = running.Workforce(scheduler="tcp://host:8786")
    assert elsewhere.threads_each is None  # of cores that are not here


def test_gallery_has_every_scene_once_and_its_error_as_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(results, "PER_PAGE", 2)
    names = [f"s{number}" for number in range(5)]
    lines = [{"id": name, "outcome": "failed", "error": "<b>no</b> & never", "folder": name} for name in names]
    (tmp_path / "rows.jsonl").write_text("".join(f"{json.dumps(each)}\n" for each in lines))
    pages = [path.read_text() for path in results.write_gallery(tmp_path, names)]
    assert [[name for name in names if f"<figcaption>{name} <br>" in page] for page in pages] == [
        ["s0", "s1"], ["s2", "s3"], ["s4"],
    ]  # fmt: skip
    assert all("<em>&lt;b&gt;no&lt;/b&gt; &amp; never</em>" in page for page in pages)
    assert [re.findall('href="([^"]+)">(\\d)<|<strong>(\\d)<', page) for page in pages] == [
        [("", "", "1"), ("gallery1.html", "2", ""), ("gallery2.html", "3", "")],
        [("gallery.html", "1", ""), ("", "", "2"), ("gallery2.html", "3", "")],
        [("gallery.html", "1", ""), ("gallery1.html", "2", ""), ("", "", "3")],
    ]


def test_gallery_links_files_of_any_name_and_tells_all_that_a_row_knows(tmp_path: Path):
    figures = {
        "surface": {"width_mm": 40.4, "length_mm": 29.6, "height_mm": 5.25, "segments": 7},
        "disparity": {"bad2": 12.6},
        "force": {"peak_force_n": 1.26},
    }
    row = {
        "id": "a<b", "outcome": "ok", "seconds": 1.234, "folder": "scenes/50 %#1", "card": "card.jpg",
        "scene": "/home/me/a&b.png", "figures": figures, "notes": ["one <odd> thing"],
        "files": ["surface.npz", "recording.npz", "sheet.svg", "a&b 5%#-page.html", "card.jpg"],
    }  # fmt: skip
    plain = {**row, "id": "b", "figures": {"materials": [1, 2, 3]}, "notes": [], "files": ["relief.npz", "card.jpg"]}
    (tmp_path / "rows.jsonl").write_text("".join(f"{json.dumps(each)}\n" for each in (row, plain)))
    [page] = (each.read_text() for each in results.write_gallery(tmp_path, ["a<b", "b"]))
    first, second = re.findall(r'<figure class="ok">.*?</figure>', page)
    folder = "scenes/50%20%25%231"
    assert re.findall('href="([^"]+)"', first) == [
        f"{folder}/sheet.svg", f"{folder}/", f"{folder}/a%26b%205%25%23-page.html",
    ]  # fmt: skip
    assert re.findall('(?:src|title|alt)="([^"]+)"', first) == [
        f"{folder}/card.jpg", "a&amp;b.png", "a&lt;b: the picture, and the surface made of it",
    ]  # fmt: skip
    assert re.findall(">([^<]+)<", first) == [
        "a&lt;b", " · ", "a&amp;b 5%#-page.html", " ",
        "surface made in 1.2 s; 40 x 30 mm, 5.25 mm high; 13 % of the pixels are off by more than 2 px; 7 segments; "
        "felt with up to 1.3 N; warning: one &lt;odd&gt; thing",
    ]  # fmt: skip
    assert re.findall('href="([^"]+)"', second) == [f"{folder}/card.jpg", f"{folder}/"]
    assert second.endswith("<br>relief made in 1.2 s; 3 segments</figcaption></figure>")


def test_table_column_with_a_text_is_text(tmp_path: Path):
    import pyarrow.parquet as pq

    lines = [{"id": "a", "figures": {"of": "n/a"}}, {"id": "b", "figures": {"of": 2.5}}, {"id": "c"}]
    (tmp_path / "rows.jsonl").write_text("".join(f"{json.dumps(each)}\n" for each in lines))
    table = pq.read_table(results.write_index(tmp_path, "abc"))
    assert table["figures.of"].to_pylist() == ["n/a", "2.5", None]


def test_text_of_any_length_stands_in_the_table(tmp_path: Path):
    import pyarrow.parquet as pq

    error = "no\n" * 1_000_000
    (tmp_path / "rows.jsonl").write_text("".join(f"{json.dumps({'id': each, 'error': error})}\n" for each in "ab"))
    assert pq.read_table(results.write_index(tmp_path, "ab"))["error"].to_pylist() == [error, error]


def test_table_is_written_without_pandas(tmp_path: Path):
    (tmp_path / "rows.jsonl").write_text('{"id": "a", "seconds": 1}\n')
    code = (
        "import sys; from pathlib import Path; from tangible_batch.results import write_index; "
        f"write_index(Path({str(tmp_path)!r}), ['a']); assert 'pandas' not in sys.modules"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_figures_that_are_not_finite_are_none_in_a_row():
    found = job._plain({"a": float("nan"), "b": {"c": float("inf"), "d": 1.5}, 2: -float("inf")})  # pyright: ignore[reportPrivateUsage]
    assert found == {"a": None, "b": {"c": None, "d": 1.5}, "2": None}


def test_scene_that_raises_is_a_row(tmp_path: Path):
    row = make_scene(Job("a", "k", "scene: {photo: no.png}\ndepth: luminance\n", str(tmp_path / "m.yaml"), (), "f"))
    assert row["outcome"] == "failed"
    assert "no.png" in row["error"]

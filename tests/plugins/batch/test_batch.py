"""Batches: many scenes through one pipeline; failures are rows, and unchanged scenes are not made again."""

import json
import re
import shutil
from pathlib import Path
from threading import Event

import numpy as np
import pyarrow.parquet as pq
import pytest

from command_line import tangible
from farm_here import Here
from pictures import write_png
from tangible_batch import batch, extra, job, results, running
from tangible_batch.farm import Done
from tangible_core import Pipeline, Scene
from tangible_core.errors import ArgumentError, BatchError, OutputError, ResultsError, Stopped
from tangible_core.files.line_file import JsonLines
from tangible_core.pipeline.engine.cache import read_entry
from tangible_depth import Luminance

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


ROW = {"id": "a\udcff", "key": "k", "outcome": "ok", "error": None, "seconds": 1, "folder": "scenes/a"}
"""As little as a row has; a name may have bytes that are not characters."""


DAMAGE = (
    ({"id": None}, "id"), ({"outcome": "done"}, "outcome"), ({"seconds": "1"}, "seconds"),
    ({"seconds": 10**400}, "seconds"),
    ({"figures": {"surface": {"width_mm": 4.0, "length_mm": 3.0}}}, "figures.surface.height_mm"),
    ({"figures": {"force": {}}}, "figures.force.peak_force_n"), ({"notes": "dark"}, "notes"),
)  # fmt: skip


def test_damaged_row_is_refused_with_its_line_and_field(tmp_path: Path):
    for change, place in DAMAGE:
        (tmp_path / "rows.jsonl").write_text("".join(json.dumps(row) + "\n" for row in (ROW, ROW | change)))
        with pytest.raises(ResultsError, match=rf"rows\.jsonl:2: {place}: "):
            results.last_rows(tmp_path)
    (tmp_path / "rows.jsonl").write_text(json.dumps(ROW) + "\n")
    assert results.last_rows(tmp_path) == {ROW["id"]: ROW}


class TestScenes:
    @pytest.fixture(autouse=True)
    def one_process(self, here):
        pass

    def run(self, cwd: Path, *words: object):
        return tangible("batch", "mine.yaml", "--over", "archive", *words, cwd=cwd)

    def test_folder_gives_rows_files_a_table_and_a_gallery(self, archive: Path):
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

    def test_scene_equals_that_of_a_run(self, archive: Path, tmp_path: Path):
        self.run(archive.parent, "--set", "workspace.width_m=0.06")
        found = read_entry(tmp_path / "out/mine-batch/scenes/p2/relief.npz").record
        scene = Scene.photo(archive / "p2.png")
        same = Pipeline(scene, depth=Luminance(), workspace={"width_m": 0.06}, cached=False).relief
        assert found.digest() == same.digest()

    def test_scene_with_a_truth_has_the_figures_of_its_disparity(self, archive: Path):
        depth = np.linspace(1, 9, 24 * 32).reshape(24, 32)
        np.save(archive / "found.npy", depth)
        for number, off in enumerate((1.5, np.nan)):  # without any truth no figure is finite, and JSON has no NaN
            np.save(archive / "truth.npy", depth + off)
            scene = "{photo: archive/p0.png, disparity: archive/found.npy, truth: archive/truth.npy}"
            (archive.parent / "mine.yaml").write_text(f"scene: {scene}\nwant: relief\n")
            (archive / "rows.csv").write_text("id,workspace.width_m\none,0.05\n")
            done = tangible("batch", "mine.yaml", "--over", archive / "rows.csv", cwd=archive.parent)
            assert done.returncode == 0, done.stderr
            figures = rows_in(archive.parent / "out/mine-batch")[number]["figures"]["disparity"]
            assert figures["average_px"] == (None if number else pytest.approx(1.5))

    def test_second_batch_makes_again_what_has_changed(self, archive: Path, monkeypatch: pytest.MonkeyPatch):
        out, tally = archive.parent / "out/mine-batch", list[int]()

        def make(*words: str) -> None:
            found = json.loads(self.run(archive.parent, "--json", *words).stdout)
            assert found["made"] + found["kept"] == found["wanted"]
            tally.append(found["made"])

        make()
        make()
        write_png(archive / "p1.png", picture(9, (30, 30)))
        make()
        shutil.rmtree(out / "scenes/p2")
        make()
        (archive / "p0.png").unlink()
        make("--set", "want=surface")
        assert sorted(by_id(rows_in(out))) == ["p0", "p1", "p2", "p3"]
        assert pq.read_table(out / "index.parquet")["id"].to_pylist() == ["p1", "p2", "p3"]
        assert "p0" not in (out / "gallery.html").read_text()
        make("--set", "want=surface", "--sheets")
        monkeypatch.setattr("tangible_batch.running.metadata.version", lambda name: "1000.0")
        make("--set", "want=surface", "--sheets")
        assert tally == [4, 0, 1, 1, 3, 3, 3]

    def test_manifest_rows_set_keys_and_name_files(self, archive: Path):
        table = "id,scene.photo,workspace.width_m\nwide,p0.png,0.1\nown,,0.03\nbad,p1.png,-1\n"
        (archive / "rows.csv").write_text(table)
        (archive.parent / "mine.yaml").write_text(CONFIG.replace("relief", "surface"))
        done = tangible("batch", "mine.yaml", "--over", archive / "rows.csv", "--json", cwd=archive.parent)
        assert done.returncode == 1 and json.loads(done.stdout)["failed"] == 1, done.stderr
        rows = by_id(rows_in(archive.parent / "out/mine-batch"))
        assert (rows["own"]["scene"], rows["wide"]["scene"]) == ("builtin/brick", str(archive / "p0.png"))
        assert [rows[name]["figures"]["surface"]["width_mm"] for name in ("wide", "own")] == [100, 30]
        assert "workspace.width_m" in rows["bad"]["error"]

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

    @pytest.mark.parametrize("of_a_file", [True, False])
    def test_sweep_in_python_is_made_again_where_the_picture_has_changed(
        self, archive: Path, monkeypatch: pytest.MonkeyPatch, of_a_file: bool
    ):
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

    def test_gallery_is_in_the_language_of_the_terminal(self, archive: Path):
        (archive / "p3.png").write_bytes(b"no")
        assert self.run(archive.parent, "--lang", "de").returncode == 1
        page = (archive.parent / "out/mine-batch/gallery.html").read_text()
        assert '<html lang="de">' in page and re.search(r"Relief in [\d,e-]+ s berechnet", page)
        assert "ist kein Bild" in page, "the error of a picture too"

    def test_pictures_that_a_shell_expanded_are_taken(self, archive: Path):
        pictures = [f"archive/p{number}.png" for number in range(3)]
        done = tangible("batch", "--over", *pictures, "mine.yaml", "--json", cwd=archive.parent)
        assert json.loads(done.stdout)["made"] == 3, done.stderr
        odd = tangible("batch", "mine.yaml", "--over", *pictures, "archive/nothing.png", cwd=archive.parent)
        assert odd.returncode == 2 and "archive/nothing.png" in odd.stderr

    def test_bad_pictures_are_rows_with_the_usual_errors(self, tmp_path: Path):
        folder = tmp_path / "archive"
        folder.mkdir()
        (tmp_path / "mine.yaml").write_text(CONFIG.replace("luminance", "semi-global"))
        pair = picture(1, (48, 90))
        for name in ("good", "cut", "sizes", "alone"):
            write_png(folder / f"{name}_left.png", pair)
            write_png(folder / f"{name}_right.png", np.roll(pair, -3, axis=1))
        whole = (folder / "cut_left.png").read_bytes()
        (folder / "cut_left.png").write_bytes(whole[: len(whole) // 2])
        write_png(folder / "sizes_right.png", pair[:20])
        (folder / "alone_right.png").unlink()
        done = self.run(tmp_path, "--set", "workspace.width_m=0.05")
        assert done.returncode == 1
        errors = {name: row["error"] for name, row in by_id(rows_in(tmp_path / "out/mine-batch")).items()}
        assert errors.pop("good") is None
        for name, said in {"cut": "cut_left.png", "sizes": "one size", "alone_left": "two views"}.items():
            assert said in errors.pop(name)
            assert f"{name}: " in done.stderr
        assert not errors and "3 failed: --retry repeats these" in done.stdout

    def test_warning_names_its_picture(self, archive: Path):
        done = self.run(archive.parent, "--set", "depth=auto", "--set", "relief=disparity")
        assert sorted(re.findall(r"(p\d): one picture", done.stderr)) == ["p0", "p1", "p2", "p3"], done.stderr

    @pytest.mark.parametrize(
        ("over", "said"),
        [
            ("nowhere/*.png", "no picture"),
            ("rows.csv", "No such file"),
            ("twice.csv", "'a'"),
            ("broken.parquet", "Parquet"),
            ("cells.csv", "more cells"),
            ("latin.csv", "latin.csv"),
            ("wrong", "unknown key"),
        ],
    )
    def test_command_with_a_mistake_reports_one_line_and_leaves_nothing(self, archive: Path, over: str, said: str):
        folder = archive.parent
        (folder / "twice.csv").write_text("id,scene.photo\na,archive/p0.png\na,archive/p1.png\n")
        (folder / "broken.parquet").write_text("PAR?")
        (folder / "latin.csv").write_bytes("id,title\na,Krüge\n".encode("latin-1"))
        (folder / "cells.csv").write_text("id,scene.photo\na,archive/p0.png,more\n")
        words = (archive, "--set", "unknown=1") if over == "wrong" else (over,)
        done = tangible("batch", "mine.yaml", "--over", *words, cwd=folder)
        assert done.returncode == 2
        [line] = done.stderr.splitlines()
        assert said in line
        assert not (folder / "out").exists()

    def test_batch_in_python_yields_rows_and_stops(self, archive: Path, tmp_path: Path):
        pipeline, stop, seen = Pipeline.from_yaml(tmp_path / "mine.yaml"), Event(), []
        rows = [{"id": path.stem, "scene.photo": str(path)} for path in sorted(archive.glob("*.png"))]
        with pytest.raises(Stopped):
            for row in batch(pipeline, rows, tmp_path / "out", stop=stop):
                seen.append(row["id"])
                stop.set()
        assert seen == ["p0"]
        assert [row["id"] for row in batch(pipeline, rows, tmp_path / "out")] == ["p0", "p1", "p2", "p3"]

    @pytest.mark.usefixtures("unchecked_shapes")
    def test_batch_in_python_with_a_mistake_is_refused(self, archive: Path, tmp_path: Path):
        pipeline, out = Pipeline.from_yaml(tmp_path / "mine.yaml"), tmp_path / "out"
        photo = {"scene.photo": str(archive / "p0.png")}
        with pytest.raises(BatchError, match="two rows"):
            list(batch(pipeline, [{"id": "a", **photo}, {"id": "a", **photo}], out))
        with pytest.raises(ArgumentError, match="workers"):
            list(batch(pipeline, [photo], out, workers=0))
        with pytest.raises(ArgumentError, match="pipeline"):
            list(batch("mine.yaml", []))  # pyright: ignore[reportArgumentType]
        assert list(batch(pipeline, [], out)) == []

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
        own = ("--workers", 2, "--threads", 3, "--timeout", 7.5, "--chunk", 3, "--cache", "kept")
        assert tangible(*words, *own, cwd=archive.parent).returncode == 0
        assert farms == [(2, 3, ""), (2, 7.5, {(3, False, str(archive.parent / "kept"))})]  # two of eight: four rounds
        assert list((archive.parent / "kept").glob("*.npz"))
        monkeypatch.setattr(running, "processors", lambda: 6)
        assert tangible(*words, "--out", "o", "--scheduler", "tcp://host:1", cwd=archive.parent).returncode == 0
        assert farms[2:] == [(6, 1, "tcp://host:1"), (2, 3600.0, {(None, False, "")})]
        assert tangible(*words, "--timeout", 0, cwd=archive.parent).returncode == 2
        monkeypatch.chdir(archive)  # not the folder of the pipeline file
        pipeline = Pipeline.from_yaml(archive.parent / "mine.yaml")
        [row] = batch(pipeline, [{"scene.photo": "p0.png"}], archive.parent / "out", timeout_s=7.0)
        assert (row["id"], row["scene"], farms[-1][1]) == ("0", str(archive / "p0.png"), 7.0)

    def test_row_with_another_picture_keeps_the_options_of_the_scene(self, archive: Path):
        text = CONFIG.replace("builtin/brick", "{left: l.png, right: r.png, rotate: 90}")
        (archive.parent / "mine.yaml").write_text(text)
        assert self.run(archive.parent).returncode == 0
        assert read_entry(archive.parent / "out/mine-batch/scenes/p2/relief.npz").record.height_m.shape == (32, 24)

    @pytest.mark.parametrize("name", ['Ä "quoted" one', "two\nlines", "b\udcff"])
    def test_picture_with_any_name_is_made(self, archive: Path, name: str):
        for path in archive.iterdir():
            path.unlink()
        write_png(archive / f"{name}.png", picture(0))
        tally = [json.loads(self.run(archive.parent, "--json").stdout) for _ in range(2)]
        assert [each["made"] for each in tally] == [1, 0]
        [row] = rows_in(archive.parent / "out/mine-batch")
        assert row["id"] == name
        if name != "b\udcff":  # no YAML holds half a character
            assert row["outcome"] == "ok", row["error"]

    def test_exports_of_the_file_are_in_each_scene_s_folder(self, archive: Path, monkeypatch: pytest.MonkeyPatch):
        (archive.parent / "mine.yaml").write_text(CONFIG + "texture: {use: histogram, segments: 2}\nexport: [text]\n")
        words = ("batch", "mine.yaml", "--over", "archive/p0.png", "--sheets")
        assert tangible(*words, cwd=archive.parent).returncode == 0
        out = archive.parent / "out/mine-batch"
        [row] = rows_in(out)
        assert {".txt", ".html", ".npz"} <= {Path(name).suffix for name in row["files"]}
        assert all((out / row["folder"] / name).is_file() for name in row["files"])
        monkeypatch.setattr("tangible_report.Text.write", _fail)
        assert self.run(archive.parent).returncode == 1
        assert "the ink is dry" in rows_in(out)[-1]["error"]

    def test_second_batch_or_one_without_the_extra_is_refused(self, archive: Path, monkeypatch: pytest.MonkeyPatch):
        with JsonLines(archive.parent / "out/mine-batch/rows.jsonl", alone=True) as file:
            file.add_row({"id": "other"})
            done = self.run(archive.parent)
        assert done.returncode == 2 and "another program" in done.stderr
        assert len(rows_in(archive.parent / "out/mine-batch")) == 1
        monkeypatch.setattr(extra, "find_spec", lambda name: None)
        done = self.run(archive.parent)
        assert done.returncode == 2 and "pip install" in done.stderr
        with pytest.raises(BatchError, match="nowhere_at_all"):
            extra.need("nowhere_at_all")

    def test_folder_names_are_safe_on_any_system(self, archive: Path, tmp_path: Path):
        names = ("a/b", "a_b", "..", "ä:*?", "x" * 300)
        rows = [{"id": name, "scene.photo": str(archive / "p0.png")} for name in names]
        made = list(batch(Pipeline.from_yaml(tmp_path / "mine.yaml"), rows, tmp_path / "out"))
        folders = {row["folder"] for row in made}
        assert len(folders) == len(rows)
        assert [row["error"] for row in made] == [None] * len(rows)
        assert all(Path(tmp_path / "out", folder).resolve().parent == tmp_path / "out/scenes" for folder in folders)


def _fail(*_: object) -> None:
    raise OutputError("the ink is dry")


def test_workforce_uses_all_cores_by_default(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(running, "processors", lambda: 8)
    shares = {(None, None): (8, 1), (2, None): (2, 4), (None, 4): (2, 4), (16, None): (16, 1), (3, 9): (3, 9)}
    who = {said: running.Workforce(*said) for said in shares}
    assert {said: (each.workers_here, each.threads_each) for said, each in who.items()} == shares
    elsewhere = running.Workforce(scheduler="tcp://host:8786")
    assert elsewhere.threads_each is None  # of cores that are not here


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


def test_pages_and_table_of_many_rows_have_every_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(results, "PER_PAGE", 2)
    names = [f"s{number}" for number in range(5)]
    figures = [{"of": "n/a", "b": 10**400, "c": [1, "\udcff"]}, {"of": 2.5}, {}, {}, {}]
    lines = [{"id": name, "outcome": "failed", "error": "<b>no</b>", "folder": name} for name in names]
    text = (json.dumps({**line, "figures": figure}) + "\n" for line, figure in zip(lines, figures, strict=True))
    (tmp_path / "rows.jsonl").write_text("".join(text))
    pages = [path.read_text() for path in results.write_gallery(tmp_path, names)]
    shown = [[name for name in names if f"<figcaption>{name} <br>" in page] for page in pages]
    assert shown == [["s0", "s1"], ["s2", "s3"], ["s4"]]
    assert all("<em>&lt;b&gt;no&lt;/b&gt;</em>" in page for page in pages)
    assert re.findall('href="([^"]+)">(\\d)<|<strong>(\\d)<', pages[1]) == [
        ("gallery.html", "1", ""), ("", "", "2"), ("gallery2.html", "3", ""),
    ]  # fmt: skip
    table = pq.read_table(results.write_index(tmp_path, names)).to_pydict()
    assert table["id"] == names and table["figures.of"] == ["n/a", "2.5", None, None, None]
    assert (table["figures.b"][0], table["figures.c"][0]) == (1e300, "1; ?")

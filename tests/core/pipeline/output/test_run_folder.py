"""The folder of a run. Otherwise a run would delete somebody's files, or leave a result of another run in it."""

import json
import shutil
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from command_line import tangible
from tangible_core import Pipeline, Scene
from tangible_core.data.products import Product
from tangible_core.errors import ConfigError, OutputError
from tangible_core.pipeline.output import runs
from tangible_core.pipeline.output.result_folders import NAMES, default_folder, move, read_manifest, rewriting
from tangible_core.pipeline.output.runs import _figures
from tangible_devices import Mock
from tangible_render import Penalty

HEIGHTS = np.arange(16.0).reshape(4, 4)


@pytest.fixture(autouse=True)
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Drawing takes most of the time of a run."""
    sheet = SimpleNamespace(draw=lambda work, path: str(path.write_bytes(b"a sheet")))
    monkeypatch.setattr(runs, "drawing", lambda: sheet)


def run(out: Path, want: Product = "touch", heights: np.ndarray = HEIGHTS):
    return Pipeline(Scene.heights(heights), render=Penalty(), cached=False).run(out, want, seconds=0.01)


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def digests(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_run_deletes_only_the_files_of_earlier_runs(tmp_path: Path):
    out, other = tmp_path / "a", tmp_path / "b"
    out.mkdir()
    (out / "notes.txt").write_text("my own")
    first = run(out)
    assert names(out) == {file.name for file in first.files} | {"manifest.json", "notes.txt"}
    assert "surface.npz" in names(out)
    shutil.copytree(out, other, copy_function=shutil.copy)
    second = run(out, "relief")
    assert names(out) == {file.name for file in second.files} | {"manifest.json", "notes.txt"}
    assert "surface.npz" not in names(out)
    manifest = read_manifest(out)
    assert manifest is not None and manifest.complete and manifest.files.keys() == {file.name for file in second.files}
    run(other, "relief")
    assert "surface.npz" not in names(other), "a copied folder"


@pytest.mark.parametrize("name", ["surface.npz", "outcomes.json"])
def test_changed_file_stops_the_run_before_the_work(tmp_path: Path, name: str):
    (tmp_path / name).write_text("my own")
    with pytest.raises(OutputError, match=f"{name}: exists, and is not an unchanged file of a run"):
        run(tmp_path)
    assert digests(tmp_path) == {name: b"my own"}
    run(tmp_path / "x")
    (tmp_path / "x" / name).write_text("changed")
    with pytest.raises(OutputError, match="exists, and is not an unchanged file of a run"):
        run(tmp_path / "x", "relief")


class Killed(BaseException):
    """An end that no `except Exception` catches."""


@pytest.mark.parametrize("written", range(4))
def test_killed_run_leaves_no_wrong_description(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, written: int):
    @contextmanager
    def stop_midway(*words: Any) -> Iterator[Callable[[str], Path]]:
        with rewriting(*words) as place:
            yield lambda name: place(name) if len(names(tmp_path) & set(NAMES)) < written else end()

    def end() -> Path:
        raise Killed

    run(tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(runs, "rewriting", stop_midway)
        with pytest.raises(Killed):
            run(tmp_path, "surface", HEIGHTS[::-1])
    manifest = read_manifest(tmp_path)
    assert manifest is not None and not manifest.complete
    left = names(tmp_path) & set(NAMES)
    assert len(left) == written and "outcomes.json" not in left
    done = run(tmp_path, "relief")
    assert names(tmp_path) == {file.name for file in done.files} | {"manifest.json"}


def test_failed_run_keeps_the_earlier_results(tmp_path: Path):
    run(tmp_path)
    before = digests(tmp_path)
    with pytest.raises(ConfigError, match="seconds"):
        Pipeline(Scene.heights(HEIGHTS), render=Penalty(), device=Mock(), cached=False).run(tmp_path, seconds=-1)
    assert digests(tmp_path) == before


During = Callable[[Callable[[], None]], AbstractContextManager[None]]


@contextmanager
def while_drawing(do: Callable[[], None]) -> Iterator[None]:
    """Let a run do something when its products are written and its sheet is not."""

    def draw(work: Any, path: Path) -> str:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(runs, "drawing", drawing)
            do()
        return str(path.write_bytes(b"a sheet"))

    drawing = runs.drawing
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runs, "drawing", lambda: SimpleNamespace(draw=draw))
        yield


@contextmanager
def before_writing(do: Callable[[], None]) -> Iterator[None]:
    """Let a run do something when its products are made and not written."""

    def figures(*words: Any) -> Any:
        do()
        return _figures(*words)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runs, "_figures", figures)
        yield


@pytest.mark.parametrize("when", [before_writing, while_drawing])
def test_second_run_into_a_folder_is_refused_during_the_first(tmp_path: Path, when: During):
    def run_another() -> None:
        with pytest.raises(OutputError, match="another program is writing"):
            run(tmp_path, "relief", HEIGHTS[::-1])

    with when(run_another):
        first = run(tmp_path)
    assert names(tmp_path) == {file.name for file in first.files} | {"manifest.json"}
    assert run(tmp_path, "relief").files


def test_export_during_a_run_waits_and_does_not_replace_its_files(tmp_path: Path):
    exported, moves = tmp_path / "of another" / "sheet.png", list[Future[tuple[Path, ...]]]()
    exported.parent.mkdir()
    exported.write_bytes(b"an export")

    def export() -> None:
        moves.append(pool.submit(move, [exported], tmp_path / "out", "other.yaml", "sheet", force=False))
        wait(moves, timeout=0.3)  # time enough to be there before the sheet, if nothing holds it

    with ThreadPoolExecutor(1) as pool, while_drawing(export):
        run(tmp_path / "out")
    with pytest.raises(OutputError, match=r"sheet\.png: is there already, and is not an unchanged export"):
        moves[0].result()
    assert (tmp_path / "out" / "sheet.png").read_bytes() == b"a sheet"
    assert not (tmp_path / "out" / ".exports.json").exists()


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"source": "", "complete": true, "files": {"../mine": "x", "a": 3}}', "\0", "[" * 9999]
)
def test_invalid_manifest_deletes_nothing(tmp_path: Path, text: str):
    (tmp_path / "mine").write_text("my own")
    (tmp_path / "x").mkdir()
    (tmp_path / "x" / "manifest.json").write_text(text)
    run(tmp_path / "x")
    assert (tmp_path / "mine").read_text() == "my own"


class TestDefault:
    def test_default_folder_is_that_of_the_same_file_or_a_new_one(self, tmp_path: Path):
        np.save(tmp_path / "h.npy", HEIGHTS)
        for folder in ("a", "b"):
            (tmp_path / folder).mkdir()
            (tmp_path / folder / "mine.yaml").write_text("scene: {height: ../h.npy}\n")
        for file, out in (("a/mine.yaml", "mine"), ("b/mine.yaml", "mine-2"), ("a/mine.yaml", "mine")):
            done = tangible("run", file, "--json", cwd=tmp_path)
            assert f"out/{out}/surface.npz" in json.loads(done.stdout)["files"], done.stderr
            assert ("out/mine holds other results" in done.stderr) == (out == "mine-2")
        before = digests(tmp_path / "out/mine")
        done = tangible("run", "out/mine/config.yaml", "--set", "workspace.width_m=0.05", "--json", cwd=tmp_path)
        assert "out/mine-3/surface.npz" in json.loads(done.stdout)["files"]
        assert digests(tmp_path / "out/mine") == before
        again = tangible("run", "out/mine/config.yaml", "--out", "out/mine", cwd=tmp_path)
        assert again.returncode == 0, again.stderr

    def test_default_folder_avoids_a_folder_with_other_files(self, tmp_path: Path):
        (tmp_path / "out/mine").mkdir(parents=True)
        source = tmp_path / "mine.yaml"
        assert default_folder(source, tmp_path / "out") == tmp_path / "out/mine"
        (tmp_path / "out/mine/sheet.png").write_text("my own")
        assert default_folder(source, tmp_path / "out") == tmp_path / "out/mine-2"

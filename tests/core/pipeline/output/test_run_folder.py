"""The folder of a run: all of its files, none of an earlier run, and every other file untouched."""

import json
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from command_line import tangible
from tangible_core import Pipeline, Scene
from tangible_core.data.products import Product
from tangible_core.errors import OutputError
from tangible_core.pipeline.output import runs
from tangible_core.pipeline.output.run_folder import NAMES, default_folder, read_manifest, rewriting
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
    return {each.name for each in folder.iterdir()}


def digests(folder: Path) -> dict[str, bytes]:
    return {each.name: each.read_bytes() for each in folder.iterdir()}


def test_run_deletes_only_the_files_of_earlier_runs(tmp_path: Path):
    (tmp_path / "notes.txt").write_text("my own")
    first = run(tmp_path)
    assert names(tmp_path) == {each.name for each in first.files} | {"manifest.json", "notes.txt"}
    assert "surface.npz" in names(tmp_path)
    second = run(tmp_path, "relief")
    assert names(tmp_path) == {each.name for each in second.files} | {"manifest.json", "notes.txt"}
    assert "surface.npz" not in names(tmp_path)
    manifest = read_manifest(tmp_path)
    assert manifest is not None and manifest.complete and manifest.files.keys() == {each.name for each in second.files}


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


def test_folder_of_a_version_without_manifests_is_overwritten(tmp_path: Path):
    run(tmp_path)
    (tmp_path / "manifest.json").unlink()
    run(tmp_path, "relief")
    assert "surface.npz" not in names(tmp_path)


@pytest.mark.parametrize("text", ["", "[1]"])
def test_folder_with_a_damaged_manifest_is_not_overwritten(tmp_path: Path, text: str):
    run(tmp_path)
    (tmp_path / "surface.npz").write_text("changed")
    (tmp_path / "manifest.json").write_text(text)
    before = digests(tmp_path)
    with pytest.raises(OutputError, match="exists, and is not an unchanged file of a run"):
        run(tmp_path)
    assert digests(tmp_path) == before


def test_copied_folder_is_overwritten(tmp_path: Path):
    run(tmp_path / "a")
    shutil.copytree(tmp_path / "a", tmp_path / "b", copy_function=shutil.copy)
    run(tmp_path / "b", "relief")
    assert "surface.npz" not in names(tmp_path / "b")


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
    assert names(tmp_path) == {each.name for each in done.files} | {"manifest.json"}


def test_failed_run_keeps_the_earlier_results(tmp_path: Path):
    run(tmp_path)
    before = digests(tmp_path)
    with pytest.raises(Exception, match="seconds"):
        Pipeline(Scene.heights(HEIGHTS), render=Penalty(), device=Mock(), cached=False).run(tmp_path, seconds=-1)
    assert digests(tmp_path) == before


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

    def test_edited_configuration_is_run_in_its_folder(self, tmp_path: Path):
        np.save(tmp_path / "h.npy", HEIGHTS)
        (tmp_path / "mine.yaml").write_text("scene: {height: h.npy}\n")
        assert tangible("run", "mine.yaml", cwd=tmp_path).returncode == 0
        config = tmp_path / "out/mine/config.yaml"
        config.write_text(config.read_text().replace("want: surface", "want: relief"))
        done = tangible("run", "out/mine/config.yaml", "--out", "out/mine", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert "surface.npz" not in names(tmp_path / "out/mine")

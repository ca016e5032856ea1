"""Files that pages send or name: otherwise one is cut short, lands elsewhere, or opens as another kind."""

import asyncio
import errno
from collections.abc import AsyncIterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tangible_core import load_pipeline
from tangible_core.errors import ConfigError
from tangible_core.pipeline.config.editing import read_values
from tangible_core.session import Recording
from tangible_core.session.recording.tick_file import About
from tangible_ui.state.uploads import UploadStore
from tangible_ui.worker.jobs import document as opening
from tangible_ui.worker.state import WorkerState
from videos import greys


@pytest.fixture
def store(tmp_path: Path) -> UploadStore:
    return UploadStore(tmp_path / "kept", tmp_path / "incoming")


async def body(*parts: bytes, then: Exception | None = None) -> AsyncIterator[bytes]:
    for part in parts:
        yield part
    if then is not None:
        raise then


def put(store: UploadStore, batch: str, name: str, *parts: bytes, then: Exception | None = None) -> None:
    asyncio.run(store.put(batch, name, body(*parts, then=then)))


def picture(path: Path, columns: int = 8) -> Path:
    Image.fromarray(np.arange(6 * columns, dtype=np.uint8).reshape(6, columns)).save(path)
    return path


class TestUploadStore:
    def test_batch_is_stored_once_by_its_content(self, store: UploadStore) -> None:
        def kept(*names: str) -> list[Path]:
            batch, contents = store.batch(), {"a.png": [b"left"], "b.png": [b"right", b" hand"], "c.png": [b""]}
            for name in names:
                put(store, batch, name, *contents[name])
            return store.keep(batch)

        first = kept("b.png", "c.png", "a.png")
        assert [path.name for path in first] == ["a.png", "b.png", "c.png"]
        assert first[1].read_bytes() == b"right hand"
        assert kept("a.png", "c.png", "b.png") == first
        places = {first[0].parent}
        for name, content in (("a.png", b"one"), ("a.png", b"two"), ("b.png", b"one")):
            batch = store.batch()
            put(store, batch, name, content)
            places.add(store.keep(batch)[0].parent)
        assert len(places) == 4, "other contents or names"

    def test_batch_of_a_single_file_has_one_until_it_is_dropped(self, store: UploadStore) -> None:
        batch = store.batch()
        with pytest.raises(ConfigError, match="0 files were sent where one is wanted"):
            store.single(batch)
        put(store, batch, "labels.gz", b"x")
        assert store.single(batch).read_bytes() == b"x"
        put(store, batch, "more.gz", b"y")
        with pytest.raises(ConfigError, match="2 files were sent where one is wanted"):
            store.single(batch)
        store.drop(batch)
        with pytest.raises(ConfigError, match="send them again"):
            store.single(batch)

    def test_upload_in_many_pieces_is_whole(self, store: UploadStore, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("tangible_ui.state.uploads.AT_ONCE_BYTES", 4)
        batch = store.batch()
        put(store, batch, "a.png", b"ab", b"cde", b"", b"fghijk", b"l")
        assert store.single(batch).read_bytes() == b"abcdefghijkl"

    def test_upload_that_leads_elsewhere_is_refused(self, store: UploadStore, tmp_path: Path) -> None:
        batch, longest = store.batch(), "\N{AMPHORA}" * 40
        for name in ("", ".", "..", "../a.png", "a/b.png", "a\\b.png", "a\0b", "a\nb", "x" * 200, longest, " "):
            with pytest.raises(ConfigError, match="cannot be kept"):
                put(store, batch, name, b"x")
        for other in ("", "..", "0" * 16, "../kept"):
            with pytest.raises(ConfigError, match="send them again"):
                put(store, other, "a.png", b"x")
        assert not [path for path in tmp_path.rglob("*") if path.is_file()]

    def test_upload_that_breaks_off_or_fills_the_disk_leaves_nothing(self, store: UploadStore, tmp_path: Path) -> None:
        batch = store.batch()
        with pytest.raises(RuntimeError):
            put(store, batch, "a.png", b"half", then=RuntimeError("gone"))
        with pytest.raises(ConfigError, match="free some space"):
            put(store, batch, "a.png", b"half", then=OSError(errno.ENOSPC, "No space left on device"))
        assert not [path for path in tmp_path.rglob("*") if path.is_file()]

    def test_upload_bounds_are_kept(self, store: UploadStore, monkeypatch: pytest.MonkeyPatch) -> None:
        batch = store.batch()
        for number in range(15):
            put(store, batch, f"{number}.png", b"x")
        put(store, batch, "x" * 116 + ".png", b"x")
        with pytest.raises(ConfigError, match="cannot be kept"):
            put(store, batch, "x" * 117 + ".png", b"x")
        put(store, batch, "0.png", b"again")
        with pytest.raises(ConfigError, match="more than 16 files at once"):
            put(store, batch, "more.png", b"x")
        monkeypatch.setattr("tangible_ui.state.uploads.MAX_BYTES", 10)
        with pytest.raises(ConfigError, match="holds more than"):
            put(store, batch, "0.png", b"x" * 6, b"x" * 5)
        put(store, batch, "1.png", b"x" * 6, b"x" * 4)


class TestBegin:
    def test_picture_opens_with_a_new_pipeline(self, worker_state: WorkerState, tmp_path: Path) -> None:
        found = opening.begin(worker_state, [picture(tmp_path / "cat.png")])
        assert "photo:" in found["text"]
        assert found["path"] == Path.cwd() / "cat.yaml"

    def test_video_opens_with_a_new_pipeline(self, worker_state: WorkerState, tmp_path: Path) -> None:
        path = greys(tmp_path / "walk.avi", 3)
        assert read_values(opening.begin(worker_state, [path])["text"], path)["scene"] == {"video": str(path)}
        assert {"name": "walk.avi", "kind": "video"} in opening.folder(worker_state, str(tmp_path))["entries"]

    def test_two_pictures_open_as_a_pair_and_can_be_exchanged(self, worker_state: WorkerState, tmp_path: Path) -> None:
        found = opening.begin(worker_state, [picture(tmp_path / "l.png"), picture(tmp_path / "r.png")])
        scene = read_values(found["text"], found["path"])["scene"]
        assert (scene["left"].endswith("l.png"), scene["right"].endswith("r.png")) == (True, True)
        exchanged = opening.exchange(worker_state, found["text"], found["path"])
        assert read_values(exchanged, found["path"])["scene"] == {"left": scene["right"], "right": scene["left"]}
        with pytest.raises(ConfigError, match="not a pair"):
            opening.exchange(worker_state, "scene: builtin/brick\n", tmp_path / "a.yaml")

    @pytest.mark.parametrize("suffix", [".npz", ".NC"])
    def test_recording_opens_as_its_path(self, worker_state: WorkerState, tmp_path: Path, suffix: str) -> None:
        written = tmp_path / f"felt{suffix.lower()}"
        Recording(np.zeros((3, 17)), "", About("mock", "penalty", "scene: x")).save(written)
        path = written.rename(tmp_path / f"felt{suffix}")
        assert opening.begin(worker_state, [path]) == {"recording": str(path)}

    def test_array_opens_as_a_height_map(self, worker_state: WorkerState, tmp_path: Path) -> None:
        np.savez(tmp_path / "hill.npz", height=np.eye(4))
        np.save(tmp_path / "hill.npy", np.eye(4))
        assert "height:" in opening.begin(worker_state, [tmp_path / "hill.npy"])["text"]
        assert "recording" not in opening.begin(worker_state, [tmp_path / "hill.npz"])


class TestSave:
    def test_document_saved_elsewhere_names_the_same_files(self, worker_state: WorkerState, tmp_path: Path) -> None:
        picture(tmp_path / "cat.png")
        text = "# mine\nscene: {photo: cat.png}  # the cat\n"
        out = tmp_path / "other" / "mine.yaml"
        opening.save(worker_state, text, tmp_path / "mine.yaml", out)
        assert load_pipeline(out).scene.views is not None
        assert out.read_text().startswith("# mine\n")
        assert "# the cat" in out.read_text()

    def test_document_saved_in_place_is_its_text(self, worker_state: WorkerState, tmp_path: Path) -> None:
        text = "scene:   builtin/brick # as it was written\n"
        opening.save(worker_state, text, tmp_path / "mine.yaml", tmp_path / "mine.yaml")
        assert (tmp_path / "mine.yaml").read_text() == text


def test_folder_lists_what_can_be_opened(
    worker_state: WorkerState, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("b.PNG", "a.yaml", ".hidden.png", "note.txt", "felt.nc", "hill.npy"):
        (tmp_path / name).touch()
    (tmp_path / "more").mkdir()
    found = opening.folder(worker_state, str(tmp_path))
    assert [(each["name"], each["kind"]) for each in found["entries"]] == [
        ("a.yaml", "pipeline"),
        ("b.PNG", "picture"),
        ("felt.nc", "recording"),
        ("hill.npy", "heights"),
        ("more", "folder"),
    ]
    assert found["more"] == 0
    monkeypatch.setattr(opening, "MOST", 3)
    bounded = opening.folder(worker_state, str(tmp_path))
    assert (bounded["entries"], bounded["more"]) == (found["entries"][:3], 2)
    with pytest.raises(ConfigError, match="name a folder"):
        opening.folder(worker_state, str(tmp_path / "missing"))

"""Drafts that outlive the program, and files that pages send: otherwise an evening is lost, or a file cut short."""

import asyncio
import errno
import os
import stat
import subprocess
import sys
from collections.abc import AsyncIterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tangible_core import load_pipeline
from tangible_core.errors import ConfigError, OutputError
from tangible_core.pipeline.config.editing import read_values
from tangible_core.session import Recording
from tangible_core.session.recording.tick_file import About
from tangible_ui import stale_files as left_behind
from tangible_ui.stale_files import channel_of_this_process, folder_of_this_process, left_in
from tangible_ui.state import document as drafts
from tangible_ui.state.document import MAX_LEFT, MAX_STEPS, Drafts, Text, Texts
from tangible_ui.state.uploads import UploadStore
from tangible_ui.worker import jobs, process
from tangible_ui.worker.jobs import document as opening
from tangible_ui.worker.messages import JobFailure, JobRequest
from tangible_ui.worker.state import WorkerState
from videos import greys

OPENED = "scene: builtin/brick\n"


@pytest.fixture
def gone() -> int:
    """The number of a process that is there no more."""
    with subprocess.Popen([sys.executable, "-c", ""]) as ended:
        ended.wait()
    return ended.pid


def keep(kept: Drafts, *texts: str) -> None:
    async def all_at_once() -> None:
        await asyncio.gather(*(kept.keep(Text(each, Path("/a/mine.yaml"))) for each in texts))

    asyncio.run(all_at_once())


def after_a_crash(folder: Path, gone: int) -> Drafts:
    """A program after the one of this process, which is gone."""
    (folder / f"{os.getpid()}.json").rename(folder / f"{gone}.json")
    return Drafts(folder)


class TestDrafts:
    def test_draft_survives_a_crash(self, tmp_path: Path, gone: int) -> None:
        kept = Drafts(tmp_path)
        kept.remember_opened(OPENED)
        keep(kept, "first", "edited\n")
        (file,) = tmp_path.glob("*.json")
        assert stat.S_IMODE(file.stat().st_mode) == 0o600
        assert Drafts(tmp_path).look() is None  # of a program that lives
        found = after_a_crash(tmp_path, gone)
        draft = found.look()
        assert draft is not None
        assert draft.text == Text("edited\n", Path("/a/mine.yaml"))
        found.drop()
        assert found.earlier is None
        assert not list(tmp_path.iterdir())

    def test_damaged_draft_is_not_offered(self, tmp_path: Path, gone: int) -> None:
        for text in ("", "{", "[]", "3", '{"text": 1}', "[" * 3000 + "]" * 3000, '{"text": ' + "[" * 3000):
            (tmp_path / f"{gone}.json").write_text(text)
            assert Drafts(tmp_path).look() is None

    def test_draft_of_a_saved_text_is_not_written(self, tmp_path: Path) -> None:
        kept = Drafts(tmp_path)
        kept.remember_opened(OPENED)
        keep(kept, OPENED)
        assert not list(tmp_path.iterdir())
        keep(kept, "edited\n")
        assert len(list(tmp_path.iterdir())) == 1
        kept.remember_opened("edited\n")  # it was saved
        keep(kept, "other", "edited\n")
        assert not list(tmp_path.iterdir())

    def test_drafts_newest_is_offered_and_old_ones_are_removed(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(left_behind, "is_alive", lambda process: False)
        for number in range(1, MAX_LEFT + 4):
            file = tmp_path / f"{number}.json"
            file.write_text(f'{{"text": "{number}", "path": "/a"}}')
            os.utime(file, (number, number))
        for number, wrong in ((999, "no draft"), (998, "null"), (997, '{"text": "x"}')):
            (tmp_path / f"{number}.json").write_text(wrong)
        draft = Drafts(tmp_path).look()
        assert draft is not None
        assert (draft.text.text, draft.at_s) == (str(MAX_LEFT + 3), MAX_LEFT + 3)
        assert len(list(tmp_path.glob("*.json"))) == MAX_LEFT + 3

    def test_full_disk_is_warned_of_once(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
    ) -> None:
        def full(file: Path, text: str, private: bool) -> None:
            raise OutputError("no space left on device")

        kept = Drafts(tmp_path)
        warning = "unsaved edits are not kept for the next start: no space left on device"
        for count in (1, 2):  # it is told again once there was room in between
            with monkeypatch.context() as patch:
                patch.setattr(drafts, "write_text", full)
                for text in ("one", "two"):
                    keep(kept, text)
            keep(kept, "three")
            assert [record.message for record in caplog.records] == [warning] * count


class TestLeftBehind:
    def test_stale_files_are_those_of_dead_processes(self, tmp_path: Path, gone: int) -> None:
        for name in (f"x-{gone}-ab_c", f"x-{os.getpid()}-abc", f"x-{gone}abc", f"y-{gone}-abc", f"x-{gone}.json"):
            (tmp_path / name).touch()
        (tmp_path / f"x-{gone}-link").symlink_to(tmp_path)
        assert [path.name for path in left_in(tmp_path, "x-*")] == [f"x-{gone}-ab_c", f"x-{gone}.json"]
        assert not list(left_in(tmp_path / "nothing", "*"))

    def test_stale_folder_and_channel_are_removed(
        self, tmp_path: Path, gone: int, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
        monkeypatch.setenv("TANGIBLE_RUNTIME_DIR", str(tmp_path))
        left = tmp_path / f"tangible-ui-{gone}-abc"
        (left / "deep").mkdir(parents=True)
        (tmp_path / f"ui-{gone}.pointer").touch()
        with folder_of_this_process() as folder, channel_of_this_process() as channel:
            assert [path.name for path in tmp_path.iterdir()] == [folder.name]
            assert folder.stat().st_mode & 0o077 == 0
            (folder / "file").touch()
            (tmp_path / f"{channel}.device").touch()
            (tmp_path / f"{channel}0.device").touch()  # another one's
        assert [path.name for path in tmp_path.iterdir()] == [f"{channel}0.device"]


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS])
def test_full_disk_is_reported_in_one_sentence_and_a_folder_that_is_gone_is_made_again(
    tmp_path: Path, number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(worker_state: Any) -> None:
        raise OSError(number, os.strerror(number), "/tmp/height.f32")

    monkeypatch.setitem(jobs.JOBS, "fails", jobs.Job(fails))
    state: Any = SimpleNamespace(folder=tmp_path / "gone" / "deep", shown="abc")
    said = process.answer(state, JobRequest(7, "fails", {}))
    assert isinstance(said, JobFailure) and isinstance(said.error, OutputError)
    assert (said.number, str(said.error)) == (7, f"/tmp/height.f32: {os.strerror(number)}; free some space")
    assert process.full(FileNotFoundError(errno.ENOENT, "no such file")) is None
    assert state.folder.is_dir()
    assert state.shown_digest == "", "what pages fetch has to be written again"


AT = Path("/a/mine.yaml")


def text(number: int) -> Text:
    return Text(f"text {number}\n", AT)


def steps(texts: Texts, now: Text, *, back: bool) -> list[str]:
    """The texts of all steps in one direction."""
    found: list[str] = []
    while (other := texts.next(back=back)) is not None:
        texts.step(now, back=back)
        now = other
        found.append(now.text)
    return found


def edited(count: int) -> Texts:
    """The history of so many edits; the last text is the current one."""
    texts = Texts()
    for number in range(count - 1):
        texts.leave(text(number))
    return texts


def test_steps_are_undone_in_their_order_and_stay_bounded():
    texts = edited(4)
    assert steps(texts, text(3), back=True) == [text(number).text for number in (2, 1, 0)]
    assert (texts.next(back=True), texts.next(back=False)) == (None, text(1))
    assert texts.all == [text(number).text for number in (3, 2, 1)]
    assert steps(texts, text(0), back=False) == [text(number).text for number in (1, 2, 3)]
    assert (texts.next(back=True), texts.next(back=False)) == (text(2), None)
    texts.step(text(3), back=True)
    texts.leave(text(2))
    assert (texts.next(back=False), texts.next(back=True)) == (None, text(2))
    texts = edited(4)
    texts.step(text(3), back=True)
    texts.rewrite({text(number).text: f"moved {number}\n" for number in (0, 3)})
    assert texts.all == ["moved 0\n", text(1).text, "moved 3\n"]
    for number in range(MAX_STEPS + 5):
        texts.leave(text(number))
    assert len(texts.all) == MAX_STEPS


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
    def test_picture_video_or_pair_opens_with_a_new_pipeline(self, worker_state: WorkerState, tmp_path: Path) -> None:
        found = opening.begin(worker_state, [picture(tmp_path / "cat.png")])
        assert "photo:" in found["text"]
        assert found["path"] == Path.cwd() / "cat.yaml"
        path = greys(tmp_path / "walk.avi", 3)
        assert read_values(opening.begin(worker_state, [path])["text"], path)["scene"] == {"video": str(path)}
        assert {"name": "walk.avi", "kind": "video"} in opening.folder(worker_state, str(tmp_path))["entries"]
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
    def test_document_is_saved_in_place_or_elsewhere(self, worker_state: WorkerState, tmp_path: Path) -> None:
        text = "scene:   builtin/brick # as it was written\n"
        opening.save(worker_state, text, tmp_path / "mine.yaml", tmp_path / "mine.yaml")
        assert (tmp_path / "mine.yaml").read_text() == text
        picture(tmp_path / "cat.png")
        text = "# mine\nscene: {photo: cat.png}  # the cat\n"
        out = tmp_path / "other" / "mine.yaml"
        opening.save(worker_state, text, tmp_path / "mine.yaml", out)
        assert load_pipeline(out).scene.views is not None
        assert out.read_text().startswith("# mine\n")
        assert "# the cat" in out.read_text()


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

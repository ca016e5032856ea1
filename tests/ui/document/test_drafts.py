"""Drafts outlive the program; temporary files of a dead program do not."""

import asyncio
import errno
import json
import os
import stat
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tangible_core.errors import OutputError
from tangible_ui import stale_files as left_behind
from tangible_ui.stale_files import channel_of_this_process, folder_of_this_process, left_in
from tangible_ui.state import drafts
from tangible_ui.state.drafts import MOST_LEFT, Drafts
from tangible_ui.state.texts import Text
from tangible_ui.worker import process
from tangible_ui.worker.messages import JobFailure, JobRequest

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
    def test_draft_and_its_folder_are_the_users_alone(self, tmp_path: Path) -> None:
        keep(Drafts(tmp_path / "unsaved"), "mine")
        (file,) = (tmp_path / "unsaved").iterdir()
        assert [stat.S_IMODE(each.stat().st_mode) for each in (file.parent, file)] == [0o700, 0o600]

    def test_draft_survives_a_crash(self, tmp_path: Path, gone: int) -> None:
        kept = Drafts(tmp_path)
        kept.remember_opened(OPENED)
        keep(kept, "first", "edited\n")
        assert Drafts(tmp_path).look() is None  # of a program that lives
        found = after_a_crash(tmp_path, gone)
        draft = found.look()
        assert draft is not None
        assert draft.text == Text("edited\n", Path("/a/mine.yaml"))
        found.drop()
        assert found.left is None
        assert not list(tmp_path.iterdir())

    @pytest.mark.parametrize(
        "text", ["", "{", "[]", "3", '{"text": 1}', "[" * 3000 + "]" * 3000, '{"text": ' + "[" * 3000]
    )
    def test_damaged_draft_is_not_offered(self, tmp_path: Path, gone: int, text: str) -> None:
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
        for number in range(1, MOST_LEFT + 4):
            file = tmp_path / f"{number}.json"
            file.write_text(f'{{"text": "{number}", "path": "/a"}}')
            os.utime(file, (number, number))
        for number, wrong in ((999, "no draft"), (998, "null"), (997, '{"text": "x"}')):
            (tmp_path / f"{number}.json").write_text(wrong)
        draft = Drafts(tmp_path).look()
        assert draft is not None
        assert (draft.text.text, draft.at_s) == (str(MOST_LEFT + 3), MOST_LEFT + 3)
        assert len(list(tmp_path.glob("*.json"))) == MOST_LEFT + 3

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

    def test_draft_of_many_edits_at_once_skips_those_that_a_newer_one_replaced(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        written: list[str] = []
        monkeypatch.setattr(drafts, "write_text", lambda file, text, private: written.append(json.loads(text)["text"]))
        keep(Drafts(tmp_path), *(f"edit {number}" for number in range(20)))
        assert written == ["edit 0", "edit 19"]


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

    def test_temporary_folder_without_room_raises_output_error(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "nothing"))
        with pytest.raises(OutputError, match="name one in TMPDIR"), folder_of_this_process():
            pass


class WorkerState:
    """Minimal state of a worker for a job."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.shown = folder, "abc"


class TestMaker:
    def test_worker_folder_that_was_removed_is_made_again(self, tmp_path: Path) -> None:
        worker_state = WorkerState(tmp_path)
        process.keep_folder(worker_state)
        assert worker_state.shown == "abc"
        worker_state = WorkerState(tmp_path / "gone" / "deep")
        process.keep_folder(worker_state)
        assert worker_state.folder.is_dir()
        assert worker_state.shown == ""  # what pages fetch has to be written again

    @pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS])
    def test_full_disk_is_reported_in_one_sentence(
        self, tmp_path: Path, number: int, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fails(worker_state: Any) -> None:
            raise OSError(number, os.strerror(number), "/tmp/height.f32")

        from tangible_ui.worker import jobs
        from tangible_ui.worker.jobs import Job

        monkeypatch.setitem(jobs.JOBS, "fails", Job(fails))
        said = process.answer(WorkerState(tmp_path), JobRequest(7, "fails", {}))
        assert isinstance(said, JobFailure)
        assert isinstance(said.error, OutputError)
        assert (said.number, str(said.error)) == (7, f"/tmp/height.f32: {os.strerror(number)}; free some space")
        assert process.full(FileNotFoundError(errno.ENOENT, "no such file")) is None

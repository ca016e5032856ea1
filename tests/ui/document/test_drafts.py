"""Drafts outlive the program, its temporary files do not: otherwise an evening of edits is lost, or a disk fills."""

import asyncio
import errno
import os
import stat
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tangible_core.errors import OutputError
from tangible_ui import stale_files as left_behind
from tangible_ui.stale_files import channel_of_this_process, folder_of_this_process, left_in
from tangible_ui.state import document as drafts
from tangible_ui.state.document import MAX_LEFT, MAX_STEPS, Drafts, Text, Texts
from tangible_ui.worker import jobs, process
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
    while (other := texts.before() if back else texts.after()) is not None:
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


def test_steps_are_undone_and_redone_in_their_order():
    texts = edited(4)
    assert steps(texts, text(3), back=True) == [text(number).text for number in (2, 1, 0)]
    assert (texts.can_undo, texts.can_redo) == (False, True)
    assert texts.all == [text(number).text for number in (3, 2, 1)]
    assert steps(texts, text(0), back=False) == [text(number).text for number in (1, 2, 3)]
    assert (texts.can_undo, texts.can_redo) == (True, False)
    texts.step(text(3), back=True)
    texts.leave(text(2))
    assert (texts.after(), texts.before()) == (None, text(2))


def test_texts_are_rewritten_on_both_sides_and_stay_bounded():
    texts = edited(4)
    texts.step(text(3), back=True)
    texts.rewrite({text(number).text: f"moved {number}\n" for number in (0, 3)})
    assert texts.all == ["moved 0\n", text(1).text, "moved 3\n"]
    for number in range(MAX_STEPS + 5):
        texts.leave(text(number))
    assert len(texts.all) == MAX_STEPS

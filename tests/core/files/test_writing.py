"""If one of these fails, a file is lost, half written or written by two programs at once."""

import errno
import os
import signal
import stat
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from tangible_core.errors import OutputError
from tangible_core.files.writing import atomic_write, open_alone, sole_writer, sweep, temporary_folder, write_text


class FullDisk:
    """A file on a disk that has no room left."""

    def __init__(self, file):
        self.file = file

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()

    def write(self, data):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def names_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_atomic_write_shows_a_whole_file_or_the_old_one(tmp_path):
    path = tmp_path / "c.bin"
    with atomic_write(path) as file:
        file.write(b"half")
        file.flush()
        assert not path.exists()
        (part,) = tmp_path.iterdir()  # on the same disk, as names_in there a file gets its name at once
        assert part.read_bytes() == b"half"
    assert path.read_bytes() == b"half"
    write_text(path, "old")
    with pytest.raises(ZeroDivisionError), atomic_write(path) as file:
        file.write(b"new")
        raise ZeroDivisionError
    assert (path.read_text(), names_in(tmp_path)) == ("old", ["c.bin"])


def test_full_disk_gives_one_clear_error_and_leaves_nothing(tmp_path, monkeypatch):
    path = tmp_path / "c.txt"

    real = os.fdopen
    monkeypatch.setattr("tangible_core.files.writing.os.fdopen", lambda handle, mode: FullDisk(real(handle, mode)))
    with pytest.raises(OutputError, match=rf"{path}: cannot be written: No space left on device; free some space"):
        write_text(path, "new")
    assert names_in(tmp_path) == []


@pytest.mark.parametrize("path", ["", ".", "/", "..", "folder", "file/c.txt"])
def test_path_of_no_file_is_an_output_error(tmp_path, monkeypatch, path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="cannot be written"):
        write_text(Path(path), "new")
    assert names_in(tmp_path) == ["file", "folder"]


@pytest.mark.parametrize("write", [write_text, lambda path, text, private: open_alone(path, private=private).close()])
def test_private_file_and_its_new_folder_are_the_users_alone(tmp_path, write):
    (tmp_path / "there").mkdir(mode=0o755)
    write(tmp_path / "there" / "new" / "c.txt", "mine", private=True)
    modes = [
        stat.S_IMODE(path.stat().st_mode) for path in (tmp_path / "there" / "new", tmp_path / "there" / "new" / "c.txt")
    ]
    assert modes == [0o700, 0o600]
    write(tmp_path / "there" / "d.txt", "mine", private=True)
    assert stat.S_IMODE((tmp_path / "there").stat().st_mode) == 0o755  # somebody else's folder is left alone


def test_sweep_removes_what_killed_processes_left_and_nothing_else(tmp_path):
    """Who writes holds a lock; what is new may be made this moment."""

    def leave(path: Path, age_s: float) -> None:
        os.utime(path, (time.time() - age_s,) * 2)

    left, new, others = ".a.0123456789ab.tangible", ".new.0123456789ab.tangible", [".a.0123456789ab", "a.tangible"]
    for name in (left, new, *others):
        (tmp_path / name).write_text("x")
        leave(tmp_path / name, 0 if "new" in name else 61)
    (tmp_path / ".b.abcdefabcdef.tangible" / "in").mkdir(parents=True)
    (tmp_path / ".link.abcdefabcdef.tangible").symlink_to(tmp_path)
    leave(tmp_path / ".b.abcdefabcdef.tangible", 61)
    os.utime(tmp_path / ".link.abcdefabcdef.tangible", (1, 1), follow_symlinks=False)
    with atomic_write(tmp_path / "c.txt") as file, temporary_folder(tmp_path / "d") as folder:
        (part,) = tmp_path.glob(".c.txt.*")
        leave(part, 61)
        leave(folder, 61)
        sweep(tmp_path)
        assert part.exists() and folder.is_dir()
        file.write(b"whole")
    assert names_in(tmp_path) == sorted([".link.abcdefabcdef.tangible", new, "c.txt", *others])


def test_names_as_long_as_they_may_be_are_written_by_one_writer(tmp_path):
    for letter in "aä🙂":
        path = tmp_path / (letter * (255 // len(letter.encode())))
        write_text(path, "new")
        assert path.read_text() == "new"
    path = tmp_path / "a" / "b.bin"
    write_text(path, "old")
    with open_alone(path) as file:
        assert path.read_bytes() == b""
        file.write(b"new")
        with pytest.raises(OutputError, match="another program is writing"):
            open_alone(path)
        assert path.read_bytes() == b"new"
    open_alone(path).close()
    assert path.read_bytes() == b""


def test_concurrent_writers_leave_one_whole_file(tmp_path):
    path = tmp_path / "c.txt"
    texts = [letter * 100_000 for letter in "abcdefgh"]
    with ThreadPoolExecutor(8) as pool:
        for each in [pool.submit(write_text, path, text) for text in texts * 5]:
            each.result()
    assert path.read_text() in texts
    assert names_in(tmp_path) == ["c.txt"]


class TestSoleWriter:
    def test_block_excludes_others_of_its_path_alone(self, tmp_path):
        path = tmp_path / "new" / ("long " * 40 + "one")
        with sole_writer(path):
            with pytest.raises(OutputError, match="another program is writing the same files"):
                sole_writer(path).__enter__()
            with sole_writer(path.with_name("long " * 40 + "other")):
                pass
            os.utime(next(path.parent.iterdir()), (1, 1))
            sweep(path.parent)
            with pytest.raises(OutputError, match="another program is writing"):
                sole_writer(path).__enter__()
        assert names_in(path.parent) == []
        with sole_writer(path):
            pass

    def test_killed_process_excludes_nobody(self, tmp_path):
        code = (
            "import sys, time; from pathlib import Path; from tangible_core.files.writing import sole_writer\n"
            "with sole_writer(Path(sys.argv[1])): print('in', flush=True); time.sleep(1000)"
        )
        path = tmp_path / "mine"
        with subprocess.Popen([sys.executable, "-c", code, path], stdout=subprocess.PIPE, text=True) as writer:
            assert writer.stdout and writer.stdout.readline() == "in\n"
            with pytest.raises(OutputError, match="another program is writing"):
                sole_writer(path).__enter__()
            writer.send_signal(signal.SIGKILL)
        assert len(names_in(tmp_path)) == 1
        with sole_writer(path):
            pass
        assert names_in(tmp_path) == []

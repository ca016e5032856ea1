"""If one of these fails, a device, a pipe or a huge file hangs the program or fills its memory."""

import os
import stat
from pathlib import Path

import pytest

from tangible_core.files.reading import MAX_BYTES, MAX_PIXELS, TooLargeError, check_size, content_digest, read_bytes


def test_file_within_the_limit_is_read_whole(tmp_path: Path):
    (tmp_path / "a").write_bytes(bytes(200_000))
    assert read_bytes(tmp_path / "a") == bytes(200_000)
    assert read_bytes(tmp_path / "a", 200_000) == bytes(200_000)


@pytest.mark.timeout(20)
@pytest.mark.parametrize("name", [".", os.devnull, "/dev/zero", "pipe", "link"])
def test_folder_pipe_and_device_are_refused(tmp_path: Path, name: str):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("/dev/zero")
    with pytest.raises(OSError) as error:
        read_bytes(tmp_path / name)
    assert error.value.strerror == "it is not a file but a folder or a device"


def test_file_over_the_limit_is_not_read(tmp_path: Path):
    (tmp_path / "a").write_bytes(bytes(11))
    with pytest.raises(OSError, match="it holds more than 1e-05 MB"):
        read_bytes(tmp_path / "a", 10)


def test_file_of_unknown_size_is_read_up_to_a_bound(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Some files of Linux, such as /proc/self/pagemap, give their size as 0 and have no end."""
    (tmp_path / "a").write_bytes(bytes(100_000))
    monkeypatch.setattr(Path, "stat", lambda self: os.stat_result((stat.S_IFREG, *[0] * 9)))
    assert len(read_bytes(tmp_path / "a")) == 1 << 16


SIDE = int(MAX_PIXELS**0.5)


@pytest.mark.parametrize(
    ("shape", "itemsize", "why"),
    [
        ((SIDE + 1, SIDE + 1), 1, "89 megapixels"),
        ((1, MAX_PIXELS + 1), 1, "89 megapixels"),
        ((1, MAX_PIXELS, 4), 5, "1424 MB"),
        ((MAX_BYTES + 1,), 1, "1424 MB"),
        ((MAX_BYTES // 8 + 1,), 8, "1424 MB"),
        ((1 << 62, 1 << 62, 1 << 62), 8, "89 megapixels"),
        ((3, 3, 1 << 62), 8, "1424 MB"),
    ],
)
def test_array_size_over_a_limit_is_refused(shape: tuple[int, ...], itemsize: int, why: str):
    with pytest.raises(TooLargeError, match=why):
        check_size(shape, itemsize)


@pytest.mark.parametrize(
    ("shape", "itemsize"),
    [((1, MAX_PIXELS, 4), 4), ((1, MAX_PIXELS), 8), ((MAX_BYTES,), 1), ((), 8), ((0, 1 << 62), 8)],
)
def test_array_size_at_the_limit_is_accepted(shape: tuple[int, ...], itemsize: int):
    check_size(shape, itemsize)


@pytest.mark.parametrize("name", ["", "missing", "a\0b", "half \ud800", "x" * 300, "folder"])
def test_digest_of_what_is_no_file_is_empty(tmp_path: Path, name: str):
    (tmp_path / "folder").mkdir()
    assert content_digest(tmp_path / name) == ""

"""What is looked at before a file is read."""

import os
import stat
from pathlib import Path

import pytest

from tangible_core.files.reading import MOST_BYTES, MOST_PIXELS, TooLargeError, check_file, check_size, read_bytes


def test_a_file_is_read_whole(tmp_path: Path):
    (tmp_path / "a").write_bytes(bytes(200_000))
    assert read_bytes(tmp_path / "a") == bytes(200_000)
    assert read_bytes(tmp_path / "a", 200_000) == bytes(200_000)


@pytest.mark.timeout(20)
@pytest.mark.parametrize("name", [".", os.devnull, "/dev/zero", "pipe", "link"])
def test_a_folder_a_pipe_and_a_device_are_no_files(tmp_path: Path, name: str):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("/dev/zero")
    with pytest.raises(OSError) as error:
        read_bytes(tmp_path / name)
    assert error.value.strerror == "it is not a file but a folder or a device"


def test_a_file_of_more_than_is_asked_for_is_not_read(tmp_path: Path):
    (tmp_path / "a").write_bytes(bytes(11))
    with pytest.raises(OSError, match="it holds more than 1e-05 MB"):
        read_bytes(tmp_path / "a", 10)


def test_a_file_full_of_holes_is_as_large_as_it_says(tmp_path: Path):
    with (tmp_path / "a").open("wb") as file:
        file.truncate(MOST_BYTES + 1)
    with pytest.raises(OSError, match="it holds more than 1424 MB"):
        check_file(tmp_path / "a")


def test_a_name_that_no_file_can_have(tmp_path: Path):
    with pytest.raises(OSError, match="no file can have this name"):
        check_file(tmp_path / "a\0b")


def test_a_missing_file_is_missing(tmp_path: Path):
    with pytest.raises(FileNotFoundError):
        read_bytes(tmp_path / "a")


def test_of_a_file_that_grows_while_it_is_read_there_is_an_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """As with those of Linux that say that they are empty and have no end, such as /proc/self/pagemap."""
    (tmp_path / "a").write_bytes(bytes(100_000))
    monkeypatch.setattr(Path, "stat", lambda self: os.stat_result((stat.S_IFREG, *[0] * 9)))
    assert len(read_bytes(tmp_path / "a")) == 1 << 16


SIDE = int(MOST_PIXELS**0.5)


@pytest.mark.parametrize(
    ("shape", "itemsize", "why"),
    [
        ((SIDE + 1, SIDE + 1), 1, "89 megapixels"),
        ((1, MOST_PIXELS + 1), 1, "89 megapixels"),
        ((1, MOST_PIXELS, 4), 5, "1424 MB"),
        ((MOST_BYTES + 1,), 1, "1424 MB"),
        ((MOST_BYTES // 8 + 1,), 8, "1424 MB"),
        ((1 << 62, 1 << 62, 1 << 62), 8, "89 megapixels"),
        ((3, 3, 1 << 62), 8, "1424 MB"),
    ],
)
def test_what_is_too_large(shape: tuple[int, ...], itemsize: int, why: str):
    with pytest.raises(TooLargeError, match=why):
        check_size(shape, itemsize)


@pytest.mark.parametrize(
    ("shape", "itemsize"),
    [((1, MOST_PIXELS, 4), 4), ((1, MOST_PIXELS), 8), ((MOST_BYTES,), 1), ((), 8), ((0, 1 << 62), 8)],
)
def test_what_is_just_not(shape: tuple[int, ...], itemsize: int):
    check_size(shape, itemsize)

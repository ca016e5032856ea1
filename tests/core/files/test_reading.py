"""If one of these fails, a path is not found, or a device, a pipe or a huge file hangs the program."""

import os
import stat
from pathlib import Path

import pytest

from tangible_core.errors import ArgumentError, ConfigError
from tangible_core.files.paths import MAX_NAME_BYTES, MAX_PATH_BYTES, as_path
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


def test_file_over_the_limit_or_of_unknown_size_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "a").write_bytes(bytes(11))
    with pytest.raises(OSError, match="it holds more than 1e-05 MB"):
        read_bytes(tmp_path / "a", 10)
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


def test_path_with_a_tilde_starts_in_that_users_home(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("HOME", "/somewhere")
    assert as_path("~/a.png") == Path("/somewhere/a.png")
    assert as_path(Path("~")) == Path("/somewhere")
    assert as_path("b/~/a.png") == Path("b/~/a.png")
    assert as_path("~root/a") == Path("~root").expanduser() / "a"
    with pytest.raises(ConfigError, match="~nobody-here/a: no user here is named 'nobody-here'"):
        as_path("~nobody-here/a")


@pytest.mark.parametrize("other", [7, None, b"a", ["a"]])
def test_value_that_is_not_a_path_is_refused_by_name(other: object):
    with pytest.raises(ArgumentError, match=r"record: is .*; it must be a path"):
        as_path(other, "record")


@pytest.mark.parametrize("name", ["a\0b", "\0", "a/\ud800.png"])
def test_name_that_no_file_can_have_is_refused(name: str):
    with pytest.raises(ConfigError, match="no file can have this name"):
        as_path(name)


@pytest.mark.parametrize("letter", ["a", "ä", "漢", "🙂"])
def test_longest_name_is_counted_in_bytes(letter: str):
    most = MAX_NAME_BYTES // len(letter.encode())
    assert as_path("b/" + letter * most) == Path("b") / (letter * most)
    for name in (letter * (most + 1), letter * (most + 1) + "/b"):
        with pytest.raises(ConfigError, match="has at most 255 bytes; use a shorter one"):
            as_path(name)


def test_longest_path_is_counted_in_bytes():
    most = "d/" * (MAX_PATH_BYTES // 2) + "x"
    assert as_path(most) == Path(most)
    with pytest.raises(ConfigError, match="a path has at most 4095 bytes; use fewer folders"):
        as_path(most + "x")

"""If one of these fails, a path that people write is not found, or an impossible one gives a traceback."""

from pathlib import Path

import pytest

from tangible_core.errors import ArgumentError, ConfigError
from tangible_core.files.paths import MAX_NAME_BYTES, MAX_PATH_BYTES, as_path


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

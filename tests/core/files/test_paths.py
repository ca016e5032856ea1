"""`~` is a home, of whoever it names; what is no path is said."""

from pathlib import Path

import pytest

from tangible_core.errors import ArgumentError, ConfigError
from tangible_core.files.paths import as_path


def test_homes(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("HOME", "/somewhere")
    assert as_path("~/a.png") == Path("/somewhere/a.png")
    assert as_path(Path("~")) == Path("/somewhere")
    assert as_path("b/~/a.png") == Path("b/~/a.png")
    assert as_path("~root/a") == Path("~root").expanduser() / "a"
    with pytest.raises(ConfigError, match="~nobody-here/a: no user here is named 'nobody-here'"):
        as_path("~nobody-here/a")


@pytest.mark.parametrize("other", [7, None, b"a", ["a"]])
def test_what_is_no_path(other: object):
    with pytest.raises(ArgumentError, match=r"record: is .*; it must be a path"):
        as_path(other, "record")

"""Paths as people write them: `~`, and values that are not paths."""

from pathlib import Path

import pytest

from tangible_core.errors import ArgumentError, ConfigError
from tangible_core.files.paths import as_path


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

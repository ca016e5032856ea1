"""What `--help` says fits a narrow terminal, whole."""

from pathlib import Path

import pytest

from command_line import tangible


@pytest.mark.parametrize("words", [[], ["devices"], ["materials"]])
def test_no_summary_is_cut_off(words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("COLUMNS", "80")
    lines = tangible(*words, "--help", cwd=tmp_path).stdout.splitlines()
    assert len(lines) > 5
    assert max(map(len, lines)) <= 80
    assert not [line for line in lines if line.endswith("...") and not line.startswith("Usage")]

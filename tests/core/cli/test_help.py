"""The output of `--help` on a narrow terminal, and the imports it needs."""

import subprocess
import sys
from pathlib import Path

import pytest

from command_line import tangible


@pytest.mark.parametrize("words", [[], ["devices"], ["materials"]])
def test_help_on_eighty_columns_cuts_no_summary(words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("COLUMNS", "80")
    lines = tangible(*words, "--help", cwd=tmp_path).stdout.splitlines()
    assert len(lines) > 5
    assert max(map(len, lines)) <= 80
    assert not [line for line in lines if line.endswith("...") and not line.startswith("Usage")]


def test_help_imports_neither_numpy_nor_the_pipeline():
    """It appears at once, whatever packages add commands."""
    code = (
        "import sys; sys.argv[1:] = ['--help']\nfrom tangible_core.cli import main\ntry: main()\nfinally: "
        "print([name for name in sys.modules if name in ('numpy', 'tangible_core.pipeline')], file=sys.stderr)"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stderr.strip() == "[]"

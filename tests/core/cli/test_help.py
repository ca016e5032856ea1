"""What `--help` says fits a narrow terminal, whole."""

import pytest
import typer.main

from tangible_core.cli.app import app
from tangible_core.plugins import hooks
from tangible_core.plugins.registry import default_registry


@pytest.fixture(scope="module", autouse=True)
def _with_the_commands_of_plugins() -> None:
    if not any(each.callback and each.callback.__name__ == "pointer" for each in app.registered_commands):
        hooks.tell(default_registry().plugins, "tangible_commands", app=app)


@pytest.mark.parametrize("words", [[], ["devices"], ["materials"]])
def test_no_summary_is_cut_off(words: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("COLUMNS", "80")
    typer.main.get_command(app).main([*words, "--help"], "tangible", standalone_mode=False)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) > 5
    assert max(map(len, lines)) <= 80
    assert not [line for line in lines if line.endswith("...") and not line.startswith("Usage")]

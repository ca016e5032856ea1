"""The cards of networks."""

from pathlib import Path

import pytest

from tangible_depth.network.card import PRESETS, read_card


def test_name_of_a_shipped_card_goes_before_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    Path("midas-v2.1-small").write_text("output: {means: depth}\n")
    assert read_card("midas-v2.1-small") is PRESETS["midas-v2.1-small"]

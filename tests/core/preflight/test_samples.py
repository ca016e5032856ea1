"""The pipeline files that come with the house keep what they ask of others: nothing in them is unsafe."""

from pathlib import Path

import pytest

from tangible_core import load_pipeline
from tangible_core.preflight import Loop

ROOT = Path(__file__).parents[3]
FOLDERS = "configs", "tangible_core"


def felt() -> list[Path]:
    """Those with a law and a device; examples name devices that are installed with them."""
    files = [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.yaml"))]
    texts = {path: path.read_text(encoding="utf-8").splitlines() for path in files}
    keys = {path: {line.partition(":")[0] for line in lines} for path, lines in texts.items()}
    return [path for path, named in keys.items() if {"scene", "render", "device"} <= named]


def test_the_samples_are_found():
    assert {path.name for path in felt()} >= {"demo.yaml", "feel.yaml"}


@pytest.mark.parametrize("path", felt(), ids=lambda path: str(path.relative_to(ROOT)))
def test_no_verdict_on_a_sample_is_unsafe(path: Path):
    verdicts = load_pipeline(path).preflight(loop=Loop(seconds=0.05))
    assert len(verdicts) > 10
    assert [each for each in verdicts if each.verdict == "unsafe"] == []

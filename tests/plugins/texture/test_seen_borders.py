"""`hierarchy` with a network of borders: else it cuts where nobody would, or old results outlive the network."""

from pathlib import Path

import numpy as np
import pytest

import drawn_parts
from benchmarks.regions import covering
from onnx_models import mono
from tangible_bench.metrics.segments import contingency
from tangible_core import Pipeline, Scene
from tangible_networks.fetching import add_network
from tangible_networks.store import known_networks
from tangible_texture import Hierarchy


def scene() -> np.ndarray:
    """A grey corner on a dark ground, and a bright line, which is what a network of brightness sees."""
    picture = np.zeros((120, 160, 3), np.uint8)
    picture[:40, :60] = 120
    picture[:, 100:102] = 255
    return picture


def test_network_decides_which_borders_people_would_draw(models: Path) -> None:
    before = Pipeline(Scene.photo(scene()), texture=Hierarchy()).segments
    mono(models / "own.onnx")
    (models / "own.yaml").write_text("task: borders\noutput: {means: borders}\n")
    within = Pipeline(Scene.photo(scene()), texture=Hierarchy())
    left, right = within.segments.labels[:, :98], within.segments.labels[:, 104:]
    assert len({before.labels[place] for place in ((10, 10), (100, 10), (60, 150))}) == 3
    assert (left == 0).all(), "the corner belongs to the ground"
    assert (right == 1).all()
    why = {outcome.product: outcome.why for outcome in within.outcomes}["segments"]
    assert "borders: seen by the network own" in why
    assert Hierarchy().reads() == (models / "own.onnx",)
    (models / "own.onnx").unlink()
    after = Pipeline(Scene.photo(scene()), texture=Hierarchy(), cached=False).segments
    assert np.array_equal(after.labels, before.labels)
    assert np.array_equal(after.confidence, before.confidence)


@pytest.mark.parametrize("shape", [(1, 1), (1, 2), (3, 5), (200, 1)])
def test_network_sees_pictures_of_any_size(models: Path, shape: tuple[int, int]) -> None:
    mono(models / "own.onnx")
    (models / "own.yaml").write_text("task: borders\noutput: {means: borders}\n")
    picture = np.arange(shape[0] * shape[1], dtype=np.uint16).reshape(shape) * 300
    assert Hierarchy().segment(picture).labels.shape == shape


@pytest.mark.nightly
def test_published_network_finds_what_people_drew(models: Path) -> None:
    drawings = [drawn_parts.drawn(name) for name in ("astronaut", "camera", "chelsea", "coffee", "rocket")]

    def cover() -> list[float]:
        found = [Hierarchy().segment(drawing.picture).labels for drawing in drawings]
        return [covering(contingency(*pair)) for pair in zip(found, (d.parts.labels for d in drawings), strict=True)]

    before = cover()
    add_network(known_networks()["hed"])
    assert (np.subtract(cover(), before) > 0.05).all()

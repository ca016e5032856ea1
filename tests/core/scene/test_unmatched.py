"""A map in which hardly anything was matched."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from tangible_core import Pipeline, Scene
from tangible_core.data import DisparityMap, Views
from tangible_core.plugins import DepthEstimator
from tangible_core.scene.pair_checks import hardly_matched, same_twice

SHAPE = 10, 20


def matched(share: float, **kind: str) -> DisparityMap:
    """So much of it, from the top, with a confidence."""
    confidence = np.full(SHAPE, 0.1, np.float32)
    confidence[: round(share * SHAPE[0])] = 0.9
    return DisparityMap(np.full(SHAPE, 5, np.float32), confidence, **kind)  # pyright: ignore[reportArgumentType]


def test_it_is_said_where_most_of_the_map_is_filled_in():
    assert "found for 20% of the left one" in hardly_matched(matched(0.2))
    assert hardly_matched(matched(0.3)) == ""
    assert hardly_matched(matched(0.2, unit="relative")) == ""


def test_what_shows_nothing_does_not_count():
    known = np.zeros(SHAPE, bool)
    assert hardly_matched(matched(0.2), known) == ""
    known[:4] = True
    assert hardly_matched(matched(0.2), known) == ""
    known[:] = True
    assert hardly_matched(matched(0.2), known)


def test_one_picture_twice_is_said():
    left, right = np.random.default_rng(1).random((2, *SHAPE))
    twice = Scene.of(left=left, right=left.copy()).views
    two = Scene.of(left=left, right=right).views
    assert twice is not None and two is not None
    assert "one and the same picture: " in same_twice(twice, matched(1))
    assert same_twice(two, matched(1)) == ""
    assert same_twice(twice, matched(1, unit="relative")) == ""
    same = Pipeline(Scene.of(left=left, right=left), depth=Guesses(), cached=False)
    same.make("disparity")
    [doubt] = same.outcomes.doubts
    assert doubt.text.startswith("left and right are one and the same picture: ")


class Guesses(DepthEstimator):
    """Matches nothing."""

    def estimate(self, views: Views) -> DisparityMap:
        return DisparityMap(np.ones(views.shape, np.float32), np.zeros(views.shape, np.float32))


def test_it_is_in_the_log_the_outcomes_and_the_title_of_the_sheet(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
):
    from tangible_core.pipeline.output import runs

    titles: list[str] = []
    sheet = SimpleNamespace(draw=lambda work, path: titles.append(work.title) or "")
    monkeypatch.setattr(runs, "drawing", lambda: sheet)
    picture = np.random.default_rng(0).random((8, 8))
    Pipeline(Scene.of(left=picture, right=picture[::-1]), depth=Guesses(), cached=False).run(tmp_path, "relief")
    [message] = [each.message for each in caplog.records]
    outcomes = {each["product"]: each for each in json.loads((tmp_path / "outcomes.json").read_text())["outcomes"]}
    assert outcomes["disparity"]["notes"] == [{"text": message, "kind": "doubt"}]
    assert message.startswith("hardly anything matches in the two pictures: a depth was found for 0%")
    assert titles == ["arrays (doubtful: hardly anything matches in the two pictures)"]
    alone = Pipeline(Scene.of(photo=picture), depth=Guesses(), cached=False)
    alone.make("disparity")
    assert not alone.outcomes.doubts

"""Summaries of results, from figures that are given: each figure in its place, unit and number."""

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from tangible_core.cli import sentences
from tangible_core.cli.commands.run import LINES
from tangible_core.data import HapticSurface, Outcome
from tangible_core.data.outcome import OutcomeKind

FORCE = {"force": {"peak_force_n": 2.04, "seconds": 4.96}}


def run(products: dict[str, Any], outcomes: Sequence[Outcome] = (), figures: dict[str, Any] | None = None) -> Any:
    return SimpleNamespace(scene="/home/me/dot.png", products=products, outcomes=outcomes, figures=figures or {})


def outcome(product: str, kind: OutcomeKind) -> Outcome:
    return Outcome(product, kind, "")


def surface() -> HapticSurface:
    """A surface of 80 x 40 mm, 12.5 mm high."""
    return HapticSurface.from_heights(np.float32([[0, 0.0125, 0, 0], [0, 0, 0, 0]]), 0.08)


@pytest.mark.parametrize(
    ("products", "figures", "sentence"),
    [
        ({"relief": 1, "parts": None}, {}, "dot.png is done: its relief is made."),
        ({"segments": 1}, {}, "dot.png is done: its segments are made."),
        ({"disparity": 1, "parts": 1, "relief": 1}, {}, "dot.png is done: its disparity, parts and relief are made."),
        ({"parts": None}, {}, "dot.png is done: nothing of it had to be made."),
        ({"surface": "it", "touch": 1}, FORCE, "dot.png can now be felt, as a surface of 80 x 40 mm, 12.5 mm high. "
         "A simulated hand felt it for 5.0 s, with forces of up to 2.0 N."),
        ({"surface": "it"}, {}, "dot.png is done: its surface is made, as a surface of 80 x 40 mm, 12.5 mm high."),
    ],
)  # fmt: skip
def test_run_summary_names_products_size_and_forces(products: dict[str, Any], figures: dict[str, Any], sentence: str):
    made = {name: surface() if value == "it" else value for name, value in products.items()}
    assert sentences.run_summary(run(made, (), figures)) == sentence


@pytest.mark.parametrize(
    ("kind", "simpler"), [("ran", True), ("cached", True), ("skipped", False), ("failed", False)]
)  # fmt: skip
def test_parts_are_said_to_be_simplified_where_they_were(kind: OutcomeKind, simpler: bool):
    outcomes = [outcome("relief", "ran"), outcome("simplified", kind)]
    expected = "dot.png, its parts simplified, is done: " if simpler else "dot.png is done: "
    assert sentences.run_summary(run({"relief": 1}, outcomes)).startswith(expected)


@pytest.mark.parametrize(
    ("written", "failed", "sentence"),
    [
        (("swell", "stl", "text"), (), "dot.png is written as swell, stl and text."),
        (("swell",), ("stl", "text"), "dot.png is written as swell. stl and text could not be written."),
        ((), ("stl",), "Nothing of dot.png was written."),
    ],
)
def test_export_summary_names_what_was_written_and_what_was_not(
    written: tuple[str, ...], failed: tuple[str, ...], sentence: str
):
    done = [SimpleNamespace(name=name, files=(Path("x"),), made=()) for name in written]
    done += [SimpleNamespace(name=name, files=(), made=()) for name in failed]
    assert sentences.export_summary("dot.png", cast(Any, SimpleNamespace(exports=done))) == sentence


@pytest.mark.parametrize(
    ("steps", "sentence"),
    [
        ("rr", "`run` would make a and b. Nothing is run now."),
        ("rc", "`run` would make a, and take 1 result of earlier runs from the cache. Nothing is run now."),
        ("crc", "`run` would make b, and take 2 results of earlier runs from the cache. Nothing is run now."),
        ("cc", "Nothing is left to run: all products are cached from earlier runs, or come with the scene."),
    ],
)
def test_plan_summary_counts_what_is_left_and_what_is_cached(steps: str, sentence: str):
    kinds: dict[str, OutcomeKind] = {"r": "ran", "c": "cached"}
    plan = [outcome(name, kinds[step]) for name, step in zip("abc", steps, strict=False)]
    assert sentences.plan_summary(plan) == sentence


def test_check_summary_counts_the_checks_that_fail():
    results = cast(Any, [SimpleNamespace(as_declared=each) for each in (True, False, True, False, True)])
    assert sentences.check_summary("it", results) == "it fails 2 of 5 conformance checks."
    assert sentences.check_summary("it", results[::2]) == "it passes all 3 conformance checks."


def test_replay_summary_tells_both_shares():
    figures = {"compared": 7, "error_percent": 12.4, "noticed_percent": 80.6}
    assert sentences.replay_summary("proxy", figures) == (
        "The forces of proxy differ by 12 % from those that were recorded; a hand would notice it in 81 % of the time "
        "in contact."
    )
    for nothing in ({"compared": 0}, {"error_percent": float("nan")}):
        assert sentences.replay_summary("proxy", {**figures, **nothing}) == (
            "Nothing was felt in this recording that the forces of proxy could be compared with."
        )


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (7.4, "a few seconds"),
        (7.6, "about 10 s"),
        (89, "about 90 s"),
        (90, "about 2 min"),
        (89 * 60, "about 89 min"),
        (90 * 60, "about 1 h 30 min"),
        (2 * 3600 + 11 * 60, "about 2 h 10 min"),
    ],
)
def test_estimated_time_is_rounded_to_what_a_person_needs(seconds: float, words: str):
    assert sentences.approximately(seconds) == words


@pytest.mark.parametrize(
    ("what", "figures", "lines"),
    [
        ("disparity", {"bad1": 12.5, "bad2": 6.25, "average_px": 0.75, "rms_px": 1.5, "density": 90.0},
         ["12.50 % of the pixels are off by more than 1 px (bad1), 6.25 % by more than 2 px (bad2); unknown ones count "
          "as bad", "average 0.750 px, rms 1.500 px over the 90.0 % that are known"]),
        ("force", {"peak_force_n": 2.5, "median_contact_force_n": 1.25, "contact_share": 0.75, "seconds": 4.0,
                   "ticks": 4000},
         ["peak 2.50 N, median in contact 1.25 N, in contact 75 % of 4.0 s (4000 ticks)"]),
        ("parts", {"0": {"name": "sea", "height_m": 0.0, "material": "ice", "why": ""},
                   "1": {"name": "", "height_m": 0.0125, "material": "", "why": "it is near"},
                   "2": {"name": "land", "height_m": None, "material": "sand", "why": "it is far"}},
         ["1: sea, 0 mm high, ice", "2: 12.5 mm high (it is near)", "3: land, sand (it is far)"]),
        ("materials", {"0": {"name": "ice", "why": "segment 1: it is smooth -> ice"}}, ["1: ice (it is smooth)"]),
    ],
)  # fmt: skip
def test_lines_of_a_run_have_each_figure_in_its_place(what: str, figures: dict[str, Any], lines: list[str]):
    assert LINES[what][1](figures) == lines

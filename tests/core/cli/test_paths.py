"""Paths and sentences of commands: otherwise they are refused late, or read by nobody."""

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import typer

from tangible_core.cli import sentences
from tangible_core.cli.app import app
from tangible_core.cli.command_table import COMMANDS, check_paths, load
from tangible_core.cli.commands.run import LINES
from tangible_core.data import HapticSurface, Outcome
from tangible_core.data.outcome import OutcomeKind
from tangible_core.errors import ConfigError
from tangible_core.plugins import hooks
from tangible_core.plugins.registry import default_registry

TOO_LONG = "a" * 300 + ".jpg"

hooks.tell(default_registry().plugins, "tangible_commands", app=app)


def leaves(words: tuple[str, ...], command: Any) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield the commands below one, each with its words."""
    below = getattr(command, "commands", {})
    if not below:
        yield words, command
    for name, each in below.items():
        yield from leaves((*words, name), each)


def calls(name: str) -> Iterator[list[str]]:
    """Yield a call for each argument and option that takes a path, with the path in it, and what else is needed."""
    for words, command in leaves((), load(name)):
        for path in command.params:
            if "pathlib.Path" in str(path.type_descriptor):
                yield [*words, *(word for param in command.params for word in given(param, path))]


def given(parameter: Any, path: Any) -> list[str]:
    """Return what a call says of a parameter: the long path, or "x" where something must stand."""
    if parameter is not path and not parameter.required:
        return []
    value = TOO_LONG if parameter is path else "x"
    return [value] if parameter.param_type_name == "argument" else [parameter.opts[0], value]


def test_every_path_of_every_command_is_refused_where_its_name_is_too_long():
    tried = [(name, call) for name in COMMANDS for call in calls(name)]
    assert len(tried) > 30
    for name, call in tried:
        with pytest.raises(ConfigError, match="at most 255 bytes; use a shorter one"):
            load(name).main(call, standalone_mode=False)


def test_command_that_a_plugin_adds_to_the_app_itself_has_its_paths_checked_once():
    seen: list[Path] = []
    group = typer.Typer()

    @group.command()
    def mine(file: Path) -> None:  # pyright: ignore[reportUnusedFunction] - typer calls it
        seen.append(file)

    for _ in range(2):
        check_paths(group)
    command = typer.main.get_command(group)
    command.main(["~"], standalone_mode=False)
    assert seen == [Path.home()]
    with pytest.raises(ConfigError, match="at most 255 bytes"):
        command.main([TOO_LONG], standalone_mode=False)


def surface() -> HapticSurface:
    """A surface of 80 x 40 mm, 12.5 mm high."""
    return HapticSurface.from_heights(np.float32([[0, 0.0125, 0, 0], [0, 0, 0, 0]]), 0.08)


FORCE = {"force": {"peak_force_n": 2.04, "seconds": 4.96}}
SIMPLER = [Outcome("simplified", "cached", "")]
FIGURES = {"compared": 7, "error_percent": 12.4, "noticed_percent": 80.6}


def run_summary(products: dict[str, Any], figures: Any, outcomes: Any = ()) -> str:
    made = {name: surface() if value == "it" else value for name, value in products.items()}
    run: Any = SimpleNamespace(scene="/home/me/dot.png", products=made, outcomes=outcomes, figures=figures)
    return sentences.run_summary(run)


def export_summary(written: str, failed: str) -> str:
    done = [
        SimpleNamespace(name=name, files=("x",) * (name in written), made=SIMPLER * (name == "b"))
        for name in written + failed
    ]
    return sentences.export_summary("dot.png", cast(Any, SimpleNamespace(exports=done)))


def plan_summary(steps: str) -> str:
    kinds: dict[str, OutcomeKind] = {"r": "ran", "c": "cached"}
    return sentences.plan_summary([Outcome(name, kinds[step], "") for name, step in zip("abc", steps, strict=False)])


def check_summary(results: tuple[bool, ...]) -> str:
    return sentences.check_summary("it", cast(Any, [SimpleNamespace(as_declared=result) for result in results]))


@pytest.mark.parametrize(
    ("found", "words"),
    [
        (run_summary({"relief": 1, "parts": None}, {}), ("relief is made",)),
        (run_summary({"disparity": 1, "parts": 1, "relief": 1}, {}), ("disparity, parts and relief are made",)),
        (run_summary({"parts": None}, {}), ("nothing of it",)),
        (run_summary({"surface": "it", "touch": 1}, FORCE), ("80 x 40 mm, 12.5 mm high", "5.0 s", "up to 2.0 N")),
        (run_summary({"surface": "it"}, {}), ("done", "80 x 40 mm, 12.5 mm high")),
        (run_summary({"relief": 1}, {}, SIMPLER), ("simplified", "relief is made")),
        (export_summary("abc", ""), ("written as `a`, `b`, `c`; parts are simplified.",)),
        (export_summary("a", "bc"), ("written as `a`; `b`, `c` could not be written.",)),
        (export_summary("", "a"), ("Nothing of dot.png",)),
        (plan_summary("rr"), ("make a and b.",)),
        (plan_summary("rc"), ("make a, and take 1 result ",)),
        (plan_summary("crc"), ("make b, and take 2 results ",)),
        (plan_summary("cc"), ("Nothing is left",)),
        (check_summary((True, False, True, False, True)), ("fails 2 of 5",)),
        (check_summary((True,) * 3), ("passes all 3",)),
        (sentences.replay_summary("proxy", FIGURES), ("proxy", "12 %", "81 %")),
        (sentences.replay_summary("proxy", {**FIGURES, "compared": 0}), ("Nothing was felt",)),
        (sentences.replay_summary("proxy", {**FIGURES, "error_percent": float("nan")}), ("Nothing was felt",)),
    ],
)
def test_summary_has_its_figures_in_their_order(found: str, words: tuple[str, ...]):
    places = [found.find(word) for word in words]
    assert places == sorted(places) and -1 not in places, found


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

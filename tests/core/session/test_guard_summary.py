"""The summary of a session: a person is not told that the guard changed most of the forces, and what helps."""

from pathlib import Path

import numpy as np
import pytest

from command_line import tangible
from tangible_core.session import guard_summary

STIFF = "scene: {height: level.npy}\nwant: touch\nrender: {use: proxy, stiffness_n_per_m: 5000}\ndevice: {use: mock}\n"
SOFTENED = "100 % of the ticks in contact the force was scaled down, because the force law is stiffer"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A pipeline whose law is too stiff for its device."""
    np.save(tmp_path / "level.npy", np.zeros((8, 8)))
    (tmp_path / "p.yaml").write_text(STIFF)
    return tmp_path


@pytest.mark.parametrize(
    ("flagged", "said"),
    [
        ({}, ""),
        ({"TOUCHING": 1000, "RAMPING": 1000, "OVERRUN": 1000}, ""),
        ({"TOUCHING": 1000, "STIFFNESS_LIMITED": 500}, ""),
        ({"TOUCHING": 1000, "STIFFNESS_LIMITED": 501}, "In 50 % of the ticks in contact the force was scaled down"),
        (
            {"TOUCHING": 10, "FORCE_LIMITED": 6, "SLEW_LIMITED": 9},
            "In 90 % of the ticks in contact the force was delayed",
        ),
        ({"TOUCHING": 10, "FORCE_LIMITED": 9}, "In 90 % of the ticks in contact the force exceeded the greatest"),
        ({"TOUCHING": 10, "DAMPED": 9}, "In 90 % of the ticks in contact the hand was damped"),
        ({"TOUCHING": 10, "NOT_FINITE": 30}, "In 75 % of the ticks in contact the force was set to zero"),
        ({"STALE": 5}, "In 100 % of the ticks in contact the force was set to zero, because no new position came"),
    ],
)
def test_guard_summary_reports_limits_of_most_ticks(flagged: dict[str, int], said: str):
    found = guard_summary(flagged)
    assert found[: len(said)] == said
    assert bool(found) == bool(said)


def test_run_prints_the_guard_summary(folder: Path):
    done = tangible("run", "p.yaml", "--seconds", 0.5, cwd=folder)
    assert done.returncode == 0, done.stderr
    assert SOFTENED in done.stdout
    assert SOFTENED in (folder / "out/p/outcomes.json").read_text()

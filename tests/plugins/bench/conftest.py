"""Fake methods, installed for this process and for the workers that it starts."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from ctrl_c import HEARING
from distributions import distribution
from measuring_here import measure_here
from tangible_core.plugins.registry import Registry

FAKES = """
import os, signal, time
from pathlib import Path
from typing import Annotated
import numpy as np
from pydantic import Field
from tangible_core.data import DisparityMap
from tangible_core.errors import PictureError
from tangible_core.plugins.interfaces import DepthEstimator


def flat(views, value_px):
    return DisparityMap(np.full(views.shape, value_px, np.float32))


class Constant(DepthEstimator):
    '''One disparity everywhere.'''

    value_px: float = 4.0
    seconds: float = 0.0

    def estimate(self, views):
        time.sleep(self.seconds)
        return flat(views, self.value_px)


class Half(DepthEstimator):
    '''The right half is unknown.'''

    value_px: float = 4.0

    def estimate(self, views):
        found = np.full(views.shape, self.value_px, np.float32)
        found[:, views.shape[1] // 2 :] = np.nan
        return DisparityMap(found)


class Hungry(DepthEstimator):
    '''Takes 64 MB and gives them back.'''

    def estimate(self, views):
        np.ones(8_000_000)
        return flat(views, 4)


class Talks(DepthEstimator):
    '''Prints where answers are expected.'''

    def estimate(self, views):
        print('{"seconds": 1}')
        os.system("echo more")
        return flat(views, 4)


class Ranged(DepthEstimator):
    '''Finds the end of its range.'''

    max_disparity_px: Annotated[int, Field(le=1000)] = 8

    def estimate(self, views):
        return flat(views, self.max_disparity_px)


class Raises(DepthEstimator):
    '''Cannot.'''

    def estimate(self, views):
        raise PictureError("not this picture")


class Fails(DepthEstimator):
    '''Has a bug.'''

    def estimate(self, views):
        return [][0]


class Dies(DepthEstimator):
    '''Takes its process along.'''

    how: str = "SIGKILL"

    def estimate(self, views):
        os.write(2, b"last words")
        os._exit(7) if self.how == "exit" else os.kill(os.getpid(), getattr(signal, self.how))


class Sleeps(DepthEstimator):
    '''Never ends.'''

    pid_file: Path | None = None

    def estimate(self, views):
        if self.pid_file:
            self.pid_file.write_text(str(os.getpid()))
        time.sleep(600)


class Relative(DepthEstimator):
    '''Nearness without a unit.'''

    def estimate(self, views):
        return DisparityMap(np.zeros(views.shape, np.float32), unit="relative")
"""
NAMES = ("constant", "half", "hungry", "talks", "ranged", "raises", "fails", "dies", "sleeps", "relative")


@pytest.fixture
def registry(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Registry:
    """A registry of installed methods and the fakes; started processes find them too."""
    points = {"tangible.depth": {name: f"bench_fakes:{name.capitalize()}" for name in NAMES}}
    site = distribution(tmp_path / "site", "fakes", points, bench_fakes=FAKES)
    monkeypatch.syspath_prepend(site)
    monkeypatch.setenv("PYTHONPATH", str(site), prepend=os.pathsep)
    monkeypatch.delitem(sys.modules, "bench_fakes", raising=False)
    return Registry()


@pytest.fixture
def cells_here(registry: Registry, monkeypatch: pytest.MonkeyPatch) -> None:
    """Measure in this process, not each cell in its own, but for cells of `dies`; draw no plot."""
    monkeypatch.setattr("tangible_core.plugins.registry.default_registry", lambda: registry)
    monkeypatch.setattr("tangible_bench.comparing.draw_plot", lambda path, _: path.touch() is None)
    measure_here(monkeypatch)


Command = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def tangible(registry: Registry) -> Iterator[Command]:
    """Start the command line in a new process, which does not outlive the test."""
    started: list[subprocess.Popen[str]] = []

    def start(*words: str | Path) -> "subprocess.Popen[str]":
        program = [sys.executable, "-c", "from tangible_core.cli import main; main()"]
        started.append(
            subprocess.Popen(
                [*HEARING, *program, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
            )
        )
        return started[-1]

    yield start
    for process in started:
        with process:
            process.kill()

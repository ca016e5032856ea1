"""The digest of code that is in no file: another one for every change that can change a result."""

import linecache
import sys
from itertools import count
from types import ModuleType

import pytest

from tangible_core.provenance.source import source_digest

CELL = '''
import math
from functools import reduce
from typing import Annotated, Literal
import numpy as np
from pydantic import Field
from tangible_core import DisparityMap, Views
from tangible_core.plugins import DepthEstimator
GAIN = 2.0
TABLE = np.zeros(3)
def inner(x): return x + 1
def helper(x): return GAIN * inner(x)
class Base:
    def lift(self): return 1
class Mine(Base, DepthEstimator):
    """Mine."""
    k: Annotated[int, Field(ge=1)] = 3
    mode: Literal["a", "b"] = "a"
    def estimate(self, views: Views) -> DisparityMap:
        return DisparityMap(np.full(views.shape, helper(self.k) + math.sqrt(2), np.float32))
'''
CELLS = count()


@pytest.fixture(autouse=True)
def _no_cell_left(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "cell", ModuleType("cell"))
    before = dict(linecache.cache)
    yield
    linecache.cache.clear()
    linecache.cache.update(before)


def run(text: str, kept: bool = True) -> type:
    """The class of a cell, as a notebook runs it: in a module without a file, its lines known by a made-up name."""
    module, name = sys.modules["cell"], f"<cell {next(CELLS)}>"
    if kept:
        linecache.cache[name] = len(text), None, text.splitlines(True), name
    exec(compile(text, name, "exec"), vars(module))
    return module.Mine


def test_the_same_cell_has_the_same_digest():
    assert source_digest(run(CELL)) == source_digest(run(CELL)) is not None


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("GAIN = 2.0", "GAIN = 3.0"),
        ("return x + 1", "return x + 2"),
        ("GAIN * inner(x)", "GAIN + inner(x)"),
        ("def lift(self): return 1", "def lift(self): return 2"),
        ("= 3\n", "= 4\n"),
        ("math.sqrt(2)", "math.sqrt(3)"),
        ("import math", "import cmath as math"),
    ],
)
def test_what_it_names_counts(before: str, after: str):
    assert before in CELL
    assert source_digest(run(CELL)) != source_digest(run(CELL.replace(before, after))) is not None


def test_what_it_does_not_name_does_not_count():
    assert source_digest(run(CELL)) == source_digest(run(CELL + "\nOTHER = 5\ndef spare(): pass\n"))


@pytest.mark.parametrize(
    "text",
    [
        CELL.replace("helper(self.k)", "TABLE[0]"),
        "\n".join(["def make(k):", *("    " + line for line in CELL.splitlines()), "    return Mine", "Mine = make(1)"])
        .replace("helper(self.k)", "k"),
    ],
    ids=["an array", "what a function around it knew"],
)  # fmt: skip
def test_what_cannot_be_told_has_none(text: str):
    assert source_digest(run(text)) is None


def test_nor_has_a_source_that_nobody_kept():
    assert source_digest(run(CELL, kept=False)) is None

"""The digest of code without a file. Otherwise an edited cell of a notebook would be answered by an old result."""

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
    """Return the class of a cell, run as in a notebook: without a file, with a made-up name for its lines."""
    module, name = sys.modules["cell"], f"<cell {next(CELLS)}>"
    if kept:
        linecache.cache[name] = len(text), None, text.splitlines(True), name
    exec(compile(text, name, "exec"), vars(module))
    return module.Mine


def test_digest_of_the_same_cell_is_the_same():
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
def test_digest_changes_with_everything_the_class_refers_to(before: str, after: str):
    assert before in CELL
    assert source_digest(run(CELL)) != source_digest(run(CELL.replace(before, after))) is not None


def test_digest_ignores_what_the_class_does_not_refer_to():
    assert source_digest(run(CELL)) == source_digest(run(CELL + "\nOTHER = 5\ndef spare(): pass\n"))


@pytest.mark.parametrize(
    "text",
    [
        CELL.replace("helper(self.k)", "TABLE[0]"),
        "\n".join(["def make(k):", *("    " + line for line in CELL.splitlines()), "    return Mine", "Mine = make(1)"])
        .replace("helper(self.k)", "k"),
    ],
    ids=["an array", "a variable of a function around it"],
)  # fmt: skip
def test_digest_of_a_class_with_unknown_content_is_none(text: str):
    assert source_digest(run(text)) is None

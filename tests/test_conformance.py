"""A method that breaks a rule of its kind would end a run or give a wrong force: the kit checks every shipped one."""

import os
from collections.abc import Iterator
from contextlib import closing
from types import SimpleNamespace

import pytest

from forks import Forks
from tangible_core.plugins.registry import default_registry
from tangible_core.runtime.child_process import python
from tangible_core.testing import conforms, every_method

PEERS = {("depth", "report"), ("depth", "kornia-report"), ("texture", "report"), ("texture", "kornia-gabor")}
"""Methods that others replace, and that take a second for a picture."""
DRAWN = {("export", "swell"), ("export", "sheet")}
"""Exporters that draw pages, which takes a second each."""
LONG = {"every_picture_type_is_taken", "every_picture_type_is_segmented", "every_work_is_answered"}
"""Checks of a dozen pictures each; methods beside these have them daily."""

for listing in default_registry().listings:
    if listing.distribution == "tangible-images":
        test = conforms(listing.kind, listing.name)
        if (listing.kind, listing.name) in PEERS | DRAWN:
            ring = pytest.mark.whole if (listing.kind, listing.name) in DRAWN else pytest.mark.nightly
            name, cases = test.pytestmark.pop().args
            cases = [pytest.param(*case.values, id=case.id, marks=ring if case.id in LONG else ()) for case in cases]
            test = pytest.mark.parametrize(name, cases)(test)
        globals()[f"test_{listing.kind}_{listing.name}".replace("-", "_")] = test
del test  # pytest would collect it once more


@pytest.fixture(scope="module")
def forks() -> Iterator[Forks]:
    with closing(Forks(python("import tangible_core.plugins.interfaces\n"))) as forks:
        yield forks


@pytest.fixture(autouse=True)
def imports_are_seen_in_forks(forks: Forks, monkeypatch: pytest.MonkeyPatch) -> None:
    """A check that starts Python for each method asks for a fork of one process, which has imported what all do."""
    if hasattr(os, "fork"):
        run = SimpleNamespace(run=lambda command, **_: forks.run(command[-1]))
        monkeypatch.setattr(every_method, "subprocess", run)

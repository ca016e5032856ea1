"""Every check of the conformance kit, over every method that is shipped."""

from collections.abc import Iterator
from contextlib import closing
from types import SimpleNamespace

import pytest

from forks import Forks
from tangible_core.plugins.registry import default_registry
from tangible_core.runtime.child_process import python
from tangible_core.testing import conforms, every_method

for each in default_registry().listings:
    if each.distribution == "tangible-images":
        test = conforms(each.kind, each.name)
        globals()[f"test_{each.kind}_{each.name}".replace("-", "_")] = test
del test  # pytest would collect it once more


@pytest.fixture(scope="module")
def forks() -> Iterator[Forks]:
    with closing(Forks(python("import tangible_core.plugins.interfaces\n"))) as forks:
        yield forks


@pytest.fixture(autouse=True)
def imports_are_seen_in_forks(forks: Forks, monkeypatch: pytest.MonkeyPatch) -> None:
    """A check that starts Python for each method asks for a fork of one process, which has imported what all do."""
    run = SimpleNamespace(run=lambda command, **_: forks.run(command[-1]))
    monkeypatch.setattr(every_method, "subprocess", run)

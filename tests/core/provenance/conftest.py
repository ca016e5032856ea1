"""Made-up packages, and a provenance with empty caches."""

import sys
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tangible_core.provenance import closure, versions

Write = Callable[..., Path]


def forget() -> None:
    """Empty the caches, as in a new process."""
    for module in (closure, versions):
        for each in vars(module).values():
            if hasattr(each, "cache_clear"):
                each.cache_clear()


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Write]:
    """`write("lib/site-packages", **{"acme/kernels.py": text})`: write files below a folder on the search path."""

    def write(folder: str, **files: str) -> Path:
        for name, text in files.items():
            path = tmp_path / folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(textwrap.dedent(text))
        if str(tmp_path / folder) not in sys.path:
            monkeypatch.syspath_prepend(tmp_path / folder)
        forget()
        return tmp_path / folder

    forget()
    yield write
    forget()

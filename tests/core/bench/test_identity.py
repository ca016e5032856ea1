"""What a measurement depends on beside its options: code, versions, memory."""

from pathlib import Path

import numpy as np
import pytest

from tangible_core.bench.identity import code_digest, machine, versions
from tangible_core.bench.memory import held_bytes, start_peak


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A method, its kernel, what the kernel uses, and a neighbour that nobody uses; a cycle among them."""
    folder = tmp_path / "digested"
    folder.mkdir()
    for name, text in {
        "__init__": "",
        "method": "def verb():\n    from .kernel import fast\n    import numpy\n",
        "kernel": "from digested import deep\nfast = 1\n",
        "deep": "from . import method\n",
        "neighbour": "",
    }.items():
        (folder / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    code_digest.cache_clear()
    return folder


@pytest.mark.parametrize(
    ("changed", "same"), [("neighbour", True), ("method", False), ("kernel", False), ("deep", False)]
)
def test_code_counts_as_far_as_it_is_imported(package: Path, changed: str, same: bool):
    before = code_digest("digested.method")
    (package / f"{changed}.py").write_text(f"{(package / f'{changed}.py').read_text()}# changed\n")
    code_digest.cache_clear()
    assert (code_digest("digested.method") == before) is same


def test_a_module_without_a_file_has_a_digest_too():
    assert code_digest("sys") == code_digest("nowhere.at.all")


def test_versions_name_what_is_installed():
    found = versions("pytest", "no-such-distribution")
    assert found["pytest"] == pytest.__version__
    assert "no-such-distribution" not in found
    assert {"python", "numpy", "tangible-images"} <= found.keys()
    assert machine()["cores"] >= 1


def test_a_peak_is_seen_after_it_has_passed_and_an_earlier_one_is_not():
    np.ones(40_000_000, np.uint8)
    peak = start_peak()
    np.ones(20_000_000, np.uint8)
    assert peak() == pytest.approx(20_000_000, rel=0.1)


def test_bytes_that_are_held():
    assert held_bytes(lambda: np.ones(10_000)) == pytest.approx(80_000, rel=0.01)
    assert held_bytes(lambda: np.ones(10_000).sum()) < 1000

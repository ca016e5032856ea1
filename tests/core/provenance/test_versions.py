"""Versions of libraries. Otherwise a result of an older library would be taken for one of the newer."""

import subprocess
import sys
from importlib import metadata

import pytest

from tangible_core.provenance import versions as reading
from tangible_core.provenance.versions import LIBRARIES, of_imported, versions

NAMED = {name for names in LIBRARIES.values() for name in names if not name.startswith("opencv")}


def test_versions_has_installed_distributions_only():
    found = versions("pytest", "no-such-distribution")
    assert found["pytest"] == pytest.__version__
    assert "no-such-distribution" not in found
    assert {"python", "tangible-images"} | NAMED <= found.keys()
    assert found["numpy"] == metadata.version("numpy")


@pytest.mark.parametrize(
    ("top", "distributions"),
    [
        ("json", set()),
        ("nowhere_at_all", set()),
        ("pytest", {"pytest"}),
        ("ruamel", {"ruamel.yaml"}),
        ("_pytest", {"pytest"}),
        ("kornia", {"kornia", "torch"}),
        ("numba", {"numba", "llvmlite", "numpy"}),
    ],
)
def test_versions_of_an_import_name_has_its_distributions(top: str, distributions: set[str]):
    assert set(of_imported([top])) == {"python"} | distributions


def test_versions_has_that_of_python(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(reading.sys, "version_info", (3, 99, 0))
    assert of_imported([]) == {"python": "3.99.0"}


def test_plan_imports_no_library_for_its_version():
    code = (
        "import sys; from tangible_core import load_pipeline;"
        "pipe = load_pipeline('configs/demo.yaml', ['depth.use=kornia-zncc', 'texture.use=kornia-gabor']); pipe.plan();"
        "print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    imported = set(done.stdout.split())
    assert "tangible_depth.kornia_zncc" in imported
    assert not imported & {"torch", "kornia", "numba", "skimage"}

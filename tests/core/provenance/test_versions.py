"""Versions and imports of a module: else an old result is used after an update, or an edit of a file."""

import ast
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

from tangible_core.provenance import closure as reading_closure
from tangible_core.provenance import versions as reading
from tangible_core.provenance.closure import Import, definitions, imports
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


ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("import a, b.c as d", [Import("a"), Import("b.c")]),
        ("from a.b import c as d, e", [Import("a.b", "c", "d"), Import("a.b", "e", "e")]),
        ("from . import a", [Import("", "a", "a", 1)]),
        ("from ..a import *", [Import("a", "*", "*", 2)]),
        ("from a import (\n    b,\n    c,\n)\n", [Import("a", "b", "b"), Import("a", "c", "c")]),
        ("from a import (  # (why)\n    b,  # how)\n)\n", [Import("a", "b", "b")]),
        ("def f():\n    import a\n", [Import("a")]),
        ("if x: import a\nelse: import b", [Import("a"), Import("b")]),
        ("x = 1; import a; import b", [Import("a"), Import("b")]),
        ("import a; import b", [Import("a"), Import("b")]),
        ("from a \\\n    import b", [Import("a", "b", "b")]),
        ("from \\\n    a import b", [Import("a", "b", "b")]),
        ("'''where\nimport x'''; import a", [Import("a")]),
        ("try:\n    import a\r\nexcept ImportError: import b\r\n", [Import("a"), Import("b")]),
        ("'''To import it,\nimport it (or not'''\nimport a", [Import("a")]),
        ("import_module('a.b'); __import__(\n\"c\")", [Import("a.b"), Import("c")]),
        ("import_module('..a', __package__)", [Import("a", level=2)]),
        ("important = 1; import_module(name)", []),
    ],
)
def test_import_is_found_in_every_form(text: str, expected: list[Import]):
    assert [each for each in imports(text.encode()) if each.module != "x"] == expected


@pytest.mark.whole
def test_imports_of_every_module_equal_those_of_a_full_parse():
    """About a hundred of these modules are read at the start of a force loop."""
    for path in (file for folder in ("tangible_core", "plugins", "tests") for file in (ROOT / folder).rglob("*.py")):
        source = path.read_bytes()
        whole = {each for node in ast.walk(ast.parse(source)) for each in _each(node)}
        assert whole <= set(imports(source)), path


def _each(node: ast.AST) -> list[Import]:
    return reading_closure._node_imports(node) if isinstance(node, ast.Import | ast.ImportFrom) else []


def test_definitions_are_found_at_any_depth():
    text = b"from a import b\ndef f(): c = 1\nclass D: pass\nasync def g(): pass\nb.x = e\nfor h in b: pass\n"
    assert definitions(text) == {"f", "c", "D", "g", "h"}

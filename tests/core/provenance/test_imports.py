"""The imports of a module. Otherwise an edit of an imported file would not be noticed, and an old result be used."""

import ast
from pathlib import Path

import pytest

from tangible_core.provenance import closure as reading
from tangible_core.provenance.closure import Import, definitions, imports

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
    return reading._node_imports(node) if isinstance(node, ast.Import | ast.ImportFrom) else []


def test_definitions_are_found_at_any_depth():
    text = b"from a import b\ndef f(): c = 1\nclass D: pass\nasync def g(): pass\nb.x = e\nfor h in b: pass\n"
    assert definitions(text) == {"f", "c", "D", "g", "h"}

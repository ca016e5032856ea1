"""What a text imports, however it is written."""

import ast
from pathlib import Path

import pytest

from tangible_core.provenance import imports as reading
from tangible_core.provenance.imports import Import, bound, imports

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize(
    ("text", "found"),
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
def test_every_way_of_writing_an_import_is_found(text: str, found: list[Import]):
    assert [each for each in imports(text.encode()) if each.module != "x"] == found


@pytest.mark.slow
def test_the_short_way_finds_all_that_the_long_one_does():
    """Each module of Tangible Images, a hundred or so of which are read at the start of the loop."""
    for path in (file for folder in ("tangible_core", "plugins", "tests") for file in (ROOT / folder).rglob("*.py")):
        source = path.read_bytes()
        whole = {each for node in ast.walk(ast.parse(source)) for each in _each(node)}
        assert whole <= set(imports(source)), path


def _each(node: ast.AST) -> list[Import]:
    return reading._each(node) if isinstance(node, ast.Import | ast.ImportFrom) else []


def test_names_that_a_text_makes_itself():
    text = b"from a import b\ndef f(): c = 1\nclass D: pass\nasync def g(): pass\nb.x = e\nfor h in b: pass\n"
    assert bound(text) == {"f", "c", "D", "g", "h"}

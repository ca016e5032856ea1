"""What a source text imports, read without running it."""

import ast
import re
from collections.abc import Iterable
from typing import NamedTuple

_WORD = re.compile(rb"\bimport\b")
_LINE = re.compile(
    rb"(?<!\\\n)(?<!\\\r\n)^[ \t]*((?:from|import)\b[^\n('\"\\]*(?:\([^)#]*\))?[^\n('\"\\]*)$", re.MULTILINE
)
"""An import that has its lines to itself, and hides no other one behind a quote, a bracket or the end of a line."""
_CALL = re.compile(rb"\b(?:import_module|__import__)\(\s*['\"](\.*)([\w.]+)['\"]")


class Import(NamedTuple):
    """`import module`, or `from module import name as bound`, with `level` dots before the module."""

    module: str
    name: str = ""
    bound: str = ""
    level: int = 0


def imports(source: bytes) -> list[Import]:
    """Every import that stands in a text, inside functions and for type checkers too; not one by a computed name.

    Raises: SyntaxError, ValueError for a text that is no Python.
    """
    called = [Import(name.decode(), level=len(dots)) for dots, name in _CALL.findall(source)]
    return called + [found for node in _statements(source) for found in _each(node)]


def bound(source: bytes) -> frozenset[str]:
    """Names that a text makes itself: by an assignment, a function or a class, at any depth.

    Raises: SyntaxError, ValueError for a text that is no Python.
    """
    return frozenset(name for node in ast.walk(ast.parse(source)) if (name := _made(node)))


def _made(node: ast.AST) -> str | None:
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        return node.name
    return node.id if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load) else None


def _statements(source: bytes) -> list[ast.Import | ast.ImportFrom]:
    """Parsed apart from the rest, which takes a sixth of the time; the whole text where `import` stands elsewhere."""
    lines = _LINE.findall(source)
    text = b"\n".join(lines)
    if len(_WORD.findall(text)) == len(_WORD.findall(source)):
        try:
            return _of(ast.parse(text).body)
        except SyntaxError:  # prose that looks like an import
            pass
    return _of(ast.walk(ast.parse(source)))


def _of(nodes: Iterable[ast.AST]) -> list[ast.Import | ast.ImportFrom]:
    return [node for node in nodes if isinstance(node, ast.Import | ast.ImportFrom)]


def _each(node: ast.Import | ast.ImportFrom) -> list[Import]:
    if isinstance(node, ast.Import):
        return [Import(each.name) for each in node.names]
    return [Import(node.module or "", each.name, each.asname or each.name, node.level) for each in node.names]

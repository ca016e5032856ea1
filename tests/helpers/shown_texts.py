"""The English texts that the program can show a person: templates in its source, descriptions of options, help."""

import ast
import re
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

from tangible_legibility.words.languages import TABLES

ROOT = Path(__file__).parents[2]
FOR_PROGRAMMERS = {
    "ValueError", "TypeError", "RuntimeError", "AssertionError", "NotImplementedError", "KeyError", "StopIteration",
    "AttributeError", "Protocol", "TypeVar", "NewType", "compile", "getLogger", "cast", "njit", "inner",
    "field_validator", "mark", "fullmatch", "match", "search", "findall", "sub", "Popen", "tell_service_manager",
}  # fmt: skip
"""Calls whose texts are not for people who use the program."""
MAX_FORMS = 6
"""The most texts that one template with conditions stands for; with more, a condition is a placeholder."""
CODE = re.compile(
    r"</|/>|=\"|^[a-z_]+\.[a-z_]+|^\W*$|::|\\\\|^:root|'self'|^<img|^import |^%\(|max-age|^\S+: \[|^Glyph|^compare: "
    r"|^[a-z]+: \{|^\w+=\{|^<"
)
"""Texts in another language than English: HTML, CSS, YAML, Python."""
CONVERSION = re.compile(r"%(?:\.\d)?[sdfgr]")
SMALL = {"of", "in", "at", "on", "to", "by", "or", "is", "as"}
WORD = re.compile(r"[A-Za-z][a-z']+")


def python_files() -> list[Path]:
    """Return the modules of the program that have texts for people."""
    packages = (ROOT / "tangible_core", *sorted(ROOT.glob("plugins/*/tangible_*")))
    return [
        path for package in packages for path in sorted(package.rglob("*.py"))
        if not any(path.is_relative_to(ROOT / each) for each in NOT_SHOWN)
    ]  # fmt: skip


NOT_SHOWN = (
    "tangible_core/translation",  # is in the language itself
    "plugins/legibility/tangible_legibility/words",  # has its own words in each language
    "plugins/authoring/tangible_authoring/editor_schema.py",  # writes a file that is English throughout
)


def literals(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the line and the template of each text that people may see."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    hidden = set(_hidden(tree))
    for node in ast.walk(tree):
        if node not in hidden and isinstance(node, ast.Constant | ast.JoinedStr | ast.BinOp):
            forms = _forms(node)
            if forms is None:
                continue
            hidden.update(_inside(node))
            for form in forms:
                yield node.lineno, _unique(CONVERSION.sub("{value}", form) if is_log(form) else form).strip()


def is_log(text: str) -> bool:
    """Return True for a text of a log message, whose placeholders are those of `%`."""
    return bool(CONVERSION.search(text)) and not re.search(r"\{\w+\}|\d ?%|%-?[.\d]+[a-z]-", text)


def is_prose(template: str) -> bool:
    """Return True for a template that reads as words for people."""
    text = re.sub(r"\{\w*\}", "{}", template)
    words = WORD.findall(text.replace("{}", " "))
    if CODE.search(text) or template in TABLES["en"].words or template in NAMES or not re.search(r"\s", text.strip()):
        return False
    long = [word for word in words if len(word) > 2]
    return len(words) >= 2 or ("{}" in text and (len(long) >= 1 or not SMALL.isdisjoint(words)))


def described() -> Iterator[str]:
    """Yield the demands of checks, the descriptions of options and of what is listed, and the help of commands."""
    import typer

    from tangible_core.cli.app import app
    from tangible_core.cli.command_table import COMMANDS, load
    from tangible_core.materials.assignment import load_library
    from tangible_core.pipeline.config.schema import json_schema, materials_schema
    from tangible_core.plugins import hooks
    from tangible_core.plugins.registry import default_registry
    from tangible_core.testing import kit
    from tangible_networks.card import shipped_cards

    yield from dict.fromkeys(kit.demand(check) for kind in kit.FAMILIES for check in kit.checks(kind))
    for card in shipped_cards().values():
        yield from filter(is_prose, (card.improves, card.trained_on, *card.licence.split("; ")))
    hooks.tell(default_registry().plugins, "tangible_commands", app=app)
    for listings in hooks.tell(default_registry().plugins, "tangible_listings"):
        yield from (listing.summary for listing in listings if listing.distribution == "tangible-images")
    sources = {part for each in load_library().values() for part in re.split(r"; |\w+: ", each.source) if part}
    for source in sorted(sources):
        yield _unique(re.sub(r"(?<![\^\w])[\d.]+", "{number}", source))
    for text in [*_of_schema(json_schema()), *_of_schema(materials_schema()),
                 *(text for name in COMMANDS for text in _of_command(load(name))),
                 *_of_command(typer.main.get_command(app))]:  # fmt: skip
        paragraphs = (" ".join(paragraph.split()) for paragraph in text.split("\n\n"))
        yield from (paragraph for paragraph in paragraphs if paragraph and not paragraph.startswith(">>>"))


def _of_schema(node: Any) -> Iterator[str]:
    if isinstance(node, dict):
        for key in ("description", "title"):
            text = node.get(key)
            if isinstance(text, str) and (key == "description" or text[:1].isupper()):
                yield text
    for each in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
        yield from _of_schema(each)


def _of_command(command: Any) -> Iterator[str]:
    yield command.help or ""
    yield from (param.help or "" for param in command.params if getattr(param, "help", None))
    for each in getattr(command, "commands", {}).values():
        yield from _of_command(each)


def _hidden(tree: ast.Module) -> Iterator[ast.AST]:
    """Yield the nodes whose texts are for programs: docstrings, annotations, arguments of calls for programmers."""
    for node in ast.walk(tree):
        for block in (getattr(node, "body", None), getattr(node, "orelse", None)):
            for each in block if isinstance(block, list) else []:
                if isinstance(each, ast.Expr) and isinstance(each.value, ast.Constant):
                    yield each.value
        for name in ("annotation", "returns"):
            annotation = getattr(node, name, None)
            if annotation is not None and not _has_help(annotation):
                yield from ast.walk(annotation)
        if isinstance(node, ast.Call):
            function = node.func
            name = getattr(function, "id", getattr(function, "attr", ""))
            if name in FOR_PROGRAMMERS:
                for arg in node.args:
                    yield from ast.walk(arg)


def _has_help(annotation: ast.AST) -> bool:
    return any(isinstance(node, ast.keyword) and node.arg == "help" for node in ast.walk(annotation)) or any(
        isinstance(node, ast.Name) and node.id == "Block" for node in ast.walk(annotation)
    )


def _inside(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the texts that are already part of a template; not those of calls and lists in its placeholders."""
    for child in ast.iter_child_nodes(node):
        yield child
        if isinstance(child, ast.Constant | ast.JoinedStr | ast.BinOp | ast.IfExp | ast.FormattedValue):
            yield from _inside(child)


def _forms(node: ast.AST) -> list[str] | None:
    """Return the templates that a text stands for, one for each way its conditions can turn out; None if not a text."""
    pieces = _pieces(node)
    if pieces is None:
        return None
    forms = 1
    for piece in pieces:
        forms *= len(piece) if isinstance(piece, list) else 1
    if forms > MAX_FORMS:
        pieces = [_placeholder(piece) if isinstance(piece, list) else piece for piece in pieces]
    choices = [piece if isinstance(piece, list) else [piece] for piece in pieces]
    return [_unique("".join(each)) for each in product(*choices)]


def _placeholder(forms: list[str]) -> str:
    """Return a placeholder for a condition, called by the first of its texts."""
    return "{" + re.sub(r"\W+", "_", next(filter(None, forms), "value")).strip("_") + "}"


def _pieces(node: ast.AST) -> list[str | list[str]] | None:
    match node:
        case ast.Constant(value=str(text)):
            return [text]
        case ast.JoinedStr(values=values):
            return [piece for each in values for piece in (_pieces(each) or [])]
        case ast.FormattedValue(value=ast.IfExp() as choice):
            return _pieces(choice) or ["{" + _name(choice.test) + "}"]
        case ast.FormattedValue(value=ast.BinOp(left=ast.Constant(value=str(text)), op=ast.Mult())):
            return [["", text]]
        case ast.FormattedValue(value=value):
            return ["{" + _name(value) + "}"]
        case ast.IfExp(body=body, orelse=orelse):
            both = _forms(body), _forms(orelse)
            return None if None in both else [[*(both[0] or []), *(both[1] or [])]]
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            both = _pieces(left), _pieces(right)
            return None if None in both else [*(both[0] or []), *(both[1] or [])]
        case _:
            return None


def _name(value: ast.AST) -> str:
    """Return a name for a placeholder: the last one in its expression that says what it is."""
    names = [
        node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else str(node.value)
        for node in ast.walk(value)
        if isinstance(node, ast.Name | ast.Attribute)
        or (isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.isidentifier())
    ]
    plain = [name for name in names if name not in DULL]
    return plain[0] if plain else "value"


NAMES = {"Pro Audio", "DejaVu Sans", "tangible parts", "tangible numbers", "outside right upper", "part share {next}"}
"""Texts that are names for programs."""
DULL = {
    "quoted", "shown", "self", "len", "str", "map", "join", "float", "int", "max", "min", "round", "name_of", "sorted",
    "each", "_and", "_number", "repr", "type", "__name__", "sum", "abs", "range", "list", "set", "figures",
}  # fmt: skip
"""Names that do not tell what a placeholder stands for."""


def _unique(template: str) -> str:
    """Return a template whose placeholders all have their own names."""
    seen: dict[str, int] = {}

    def rename(found: re.Match[str]) -> str:
        name = found[1]
        seen[name] = seen.get(name, 0) + 1
        return f"{{{name}{seen[name] if seen[name] > 1 else ''}}}"

    return re.sub(r"\{(\w+)\}", rename, template)

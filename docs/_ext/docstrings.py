"""Our docstrings for Sphinx: plain text, names in backticks, paragraphs that begin with `Raises:` and the like."""

import re
from typing import Any

from docutils import nodes
from pydantic import BaseModel
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.pycode import ModuleAnalyzer
from sphinx.util.nodes import make_refnode

from tangible_core.data.options import field_texts

LABELS = re.compile(r"^(Parameters|Returns|Raises|Source|Frames?|Memory[^:.\n]*): ", re.MULTILINE)
"""What begins a paragraph of its own."""
NAME = re.compile(r"[A-Za-z_][\w.]*")
TOP = ("class", "exception", "function", "data")
"""What a name by itself may mean; a method or field is named with its class."""


def restructured(text: str) -> str:
    """Return a docstring as reStructuredText."""
    paragraphs = LABELS.sub(r"\n\n\g<0>", text).strip("\n").split("\n\n")
    return "\n\n".join(_paragraph(each.strip("\n")) for each in paragraphs)


def _paragraph(text: str) -> str:
    lines = text.splitlines()
    if text.lstrip().startswith(">>>"):
        return text
    if lines and all(line.startswith("    ") for line in lines):
        return "::\n\n" + text
    return LABELS.sub(r"**\1:** ", _inline(" ".join(line.strip() for line in lines)))


def _inline(text: str) -> str:
    """Turn text in backticks into code, and into a link where it is a documented name; escape the rest."""
    prose, code = text.split("`")[::2], text.split("`")[1::2]
    escaped = [re.sub(r"([*_|\\])", r"\\\1", part) for part in prose]
    marked = [f":py:obj:`{part}`" if NAME.fullmatch(part) else f"``{part}``" for part in code]
    return "".join(a + b for a, b in zip(escaped, [*marked, ""], strict=True))


def options(method: type[BaseModel]) -> str:
    """Return the fields of a model, each with its type as it is written, its default and its docstring."""
    home = {name: cls for cls in reversed(method.__mro__) for name in vars(cls).get("__annotations__", ())}
    entries, texts = list[str](), field_texts(method)
    for name, field in method.model_fields.items():
        analyzer = ModuleAnalyzer.for_module(home[name].__module__)
        analyzer.analyze()
        kind = analyzer.annotations.get((home[name].__name__, name), "")
        default = "" if field.is_required() else f" = {field.get_default(call_default_factory=True)!r}"
        text = texts.get(name, field.description or "")
        entries.append(f"``{name}: {kind}{default}``\n    {_inline(' '.join(text.split()))}")
    return "\n\n".join(["", *entries])


def process_docstring(app: Sphinx, what: str, name: str, obj: Any, given: Any, lines: list[str]) -> None:
    """autodoc's event: the docstring is replaced; what NamedTuple says of its own fields is dropped."""
    text = "\n".join(lines)
    text = "" if text.startswith("Alias for field number") else restructured(text)
    if what == "class":
        fields = tuple(obj.model_fields) if _is_model(obj) else ()
        app.env.temp_data["options"] = fields
    if _is_model(obj):
        text += "\n\n" + options(obj)
    lines[:] = [*text.splitlines(), ""]


def process_signature(app: Sphinx, what: str, name: str, obj: Any, *given: Any) -> tuple[str, None] | None:
    """autodoc's event: a model's signature is its options, which are listed below it."""
    return ("", None) if _is_model(obj) else None


def skip_member(app: Sphinx, what: str, name: str, obj: Any, skip: bool, given: Any) -> bool | None:
    """autodoc's event: the fields of the class whose docstring came last are listed there."""
    return True if what == "class" and name in app.env.temp_data.get("options", ()) else None


def _is_model(obj: Any) -> bool:
    return isinstance(obj, type) and issubclass(obj, BaseModel)


def resolve(app: Sphinx, env: BuildEnvironment, node: pending_xref, words: nodes.Element) -> nodes.Element | None:
    """Return a name by its last part, as records are documented in the room that hands them on, not in their file.

    What no page documents stays plain in a signature and in a docstring; what a page refers to must be there.
    """
    if node.get("refdomain") != "py":
        return None
    target, objects = node["reftarget"], env.domains.python_domain.objects
    last = target.rpartition(".")[2]
    found = [name for name, what in objects.items() if name.rpartition(".")[2] == last and what.objtype in TOP]
    if len(found) == 1:
        page = objects[found[0]]
        return make_refnode(app.builder, node["refdoc"], page.docname, page.node_id, words, found[0])
    return None if node["reftype"] != "obj" and "refwarn" in node else words


def setup(app: Sphinx) -> dict[str, bool]:
    """Sphinx calls this."""
    app.connect("autodoc-process-docstring", process_docstring)
    app.connect("autodoc-process-signature", process_signature)
    app.connect("autodoc-skip-member", skip_member)
    app.connect("missing-reference", resolve)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

"""The HTML of a page to send: its own script and style, and a policy that lets it ask nobody for anything."""

from base64 import b64encode
from collections.abc import Mapping
from hashlib import sha256
from html import escape
from importlib.resources import files
from string import Template
from typing import Any

from tangible_legibility.words.languages import Language, Words, one_line

from .packing import as_json


def page_of(
    title: str, language: Language, named_in: str, data: Mapping[str, Any], script: str, style: str, licences: str
) -> str:
    """Return the page. language: of its words; named_in: the tag of the language of title and names.

    Whatever title and names contain is text: it is escaped in HTML, and in JSON written without `<`, `>` and `&`. A
    name that turns the direction of writing does so within itself alone, as it is isolated.
    """
    if "</script" in script.lower() or "</style" in style.lower():
        raise ValueError("script and style must not end their elements")
    name, say = escape(one_line(title)), Words(language)
    described = data.get("describes", {}).get(language)
    return Template(files("tangible_send").joinpath("page.html").read_text(encoding="utf-8")).substitute(
        language=language,
        policy=_policy(script, style),
        title=name or say("untitled"),
        style=style,
        named_in=escape(named_in) if name else language,
        no_script=say("no script"),
        description=_describe(described) if described else "",
        licences=licences.replace("--", "- -"),
        data=as_json(data),
        script=script,
    )


def _policy(script: str, style: str) -> str:
    """Return the policy: only this script and this style, and no connection at all."""
    scripts, styles = (b64encode(sha256(each.encode()).digest()).decode() for each in (script, style))
    allowed = {
        "default-src": "'none'",
        "script-src": f"'sha256-{scripts}'",
        "style-src": f"'sha256-{styles}'",
        "base-uri": "'none'",
        "form-action": "'none'",
    }
    return "; ".join(map(" ".join, allowed.items()))


def _describe(described: Mapping[str, Any]) -> str:
    items = "".join(f"<li><bdi>{escape(label)}</bdi>. {escape(says)}</li>\n" for label, says in described["parts"])
    listed = f"<h2>{escape(described['heading'])}</h2>\n<ul>\n{items}</ul>" if items else ""
    left = f"<p>{escape(described['left_out'])}</p>" if described["left_out"] else ""
    return f"<p>{escape(described['overview'])}</p>\n{listed}{left}"

"""The HTML of a page to send: its own script and style, and a policy that lets it ask nobody for anything."""

from base64 import b64encode
from collections.abc import Mapping
from hashlib import sha256
from html import escape
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
    return f"""<!doctype html>
<html lang="{language}">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{_policy(script, style)}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="referrer" content="no-referrer">
<title>{name or say("untitled")}</title>
<style>{style}</style>
</head>
<body>
<a id="skip" href="#terrain"></a>
<header><h1 lang="{escape(named_in) if name else language}" dir="auto">{name or say("untitled")}</h1></header>
<main>
<p id="how"></p>
<div id="scenery"><canvas id="terrain" tabindex="0" role="application" aria-describedby="how described"></canvas></div>
<p id="described" class="visually-hidden"></p>
<p id="said" role="status" aria-live="polite" dir="auto"></p>
<p id="alerted" role="alert" dir="auto"></p>
<noscript><p>{say("no script")}</p></noscript>
<div id="controls" role="group"></div>
<section id="parts" hidden></section>
<section id="description" lang="{language}">{_describe(described) if described else ""}</section>
<details id="help"></details>
</main>
<!--
{licences.replace("--", "- -")}-->
<script type="application/json" id="data">{as_json(data)}</script>
<script>{script}</script>
</body>
</html>
"""


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

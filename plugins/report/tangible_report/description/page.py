"""A description at length as a page of HTML that needs nothing else and runs nothing."""

from collections.abc import Sequence
from html import escape

from tangible_core.data import HapticSurface
from tangible_core.parts.words.languages import Language, one_line
from tangible_core.scene.workspace import SceneKind

from .at_length import ended, tell
from .facts import PartFacts

_STYLE = """
:root { color-scheme: light dark; }
body { background: Canvas; color: CanvasText; font: 125%/1.6 system-ui, sans-serif; margin: 2rem auto; max-width: 40em;
  padding: 0 1rem; }
h1, h2 { line-height: 1.25; }
li { margin: 0 0 0.75em; padding-left: 0.25em; }
@media print { body { font-size: 14pt; margin: 0; max-width: none; } h2 { break-after: avoid; }
  li { break-inside: avoid; } }
""".strip()


def page_of(
    surface: HapticSurface,
    title: str,
    language: Language = "en",
    parts: Sequence[PartFacts] = (),
    kind: SceneKind | None = None,
    *,
    named_in: str | None = None,
) -> str:
    """`describe_at_length` as HTML: headings, an ordered list of parts, the system's colours, no script.

    named_in: the tag of the language of the title and of names, where that is another one than of the words.
    """
    other = named_in if named_in and named_in != language else ""
    told = tell(surface, title, language, parts, kind, lambda text: _given(text, other))
    items = "".join(
        f"<li><strong>{ended(each.label)}</strong> {' '.join(each.sentences)}</li>\n" for each in told.parts
    )
    listed = f"<h2>{told.heading}</h2>\n<ol>\n{items}</ol>\n" if told.parts else ""
    left = f"<p>{told.left_out}</p>\n" if told.left_out else ""
    return f"""<!doctype html>
<html lang="{language}">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<title>{escape(one_line(title)) or told.title}</title>
<style>
{_STYLE}
</style>
</head>
<body>
<main>
<h1>{told.title}</h1>
<p>{" ".join(told.overview)}</p>
{listed}{left}</main>
</body>
</html>
"""


def _given(text: str, language: str) -> str:
    """Somebody's words in a page: what they are written in is said where it is not the page's language."""
    said = escape(one_line(text))
    return f'<span lang="{escape(language)}" dir="auto">{said}</span>' if language else said

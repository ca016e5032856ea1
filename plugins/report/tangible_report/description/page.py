"""A long description as a self-contained page of HTML without scripts."""

from collections.abc import Sequence
from html import escape

from tangible_core.data import HapticSurface
from tangible_core.scene.workspace import SceneKind
from tangible_legibility.words.languages import Language, one_line

from .at_length import end_sentence, tell
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
    """Return `describe_at_length` as HTML: headings, an ordered list of parts, the system's colours, no script.

    named_in: the tag of the language of the title and names, if it differs from the language of the words.
    """
    other = named_in if named_in and named_in != language else ""
    told = tell(surface, title, language, parts, kind, lambda text: _quote(text, other))
    items = "".join(
        f"<li><strong>{end_sentence(each.label)}</strong> {' '.join(each.sentences)}</li>\n" for each in told.parts
    )
    listed = f"<h2>{told.heading}</h2>\n<ul>\n{items}</ul>\n" if told.parts else ""
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


def _quote(text: str, language: str) -> str:
    """Return a custom name as HTML, marked with its language if that is not the page's."""
    html = escape(one_line(text))
    return f'<span lang="{escape(language)}" dir="auto">{html}</span>' if language else html

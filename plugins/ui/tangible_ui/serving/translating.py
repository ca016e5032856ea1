"""Messages to a tab in its language: texts for people are translated on their way out, names and values are not."""

from typing import Any

from tangible_core.translation import LANGUAGES, translate

from ..feeling.recorder import BY_HAND

TEXTS = frozenset(
    {
        "check", "cure", "description", "finding", "how", "note", "of", "problem", "question", "reason", "refusal",
        "sentence", "source", "stands", "summary", "title", "why",
    }
)  # fmt: skip
"""Keys whose values are texts for people, wherever they stand."""
SPOKEN = frozenset({"refused", "error", "log"})  # events whose `text` is for people
# Keys of a note and of a complaint, whose `text` is for people too; that of a document is YAML.
NOTED = frozenset({"kind", "location"})
VALUES = frozenset({"said", "values", "changes", "says", "names"})
"""Keys of what stands in a document or is named by its user."""
KNOWN = frozenset({BY_HAND, "asked", "button", "scene", "ended"})
"""Reasons that the page knows by these words, and says in its own."""


def tab_language(tag: str) -> str:
    """Return the language of a tab; English for any that the program does not speak."""
    return tag if tag in LANGUAGES else LANGUAGES[0]


def in_language(message: dict[str, Any], language: str) -> dict[str, Any]:
    """Return a message with its texts in a language; itself in English."""
    return message if language == LANGUAGES[0] else _translate(message, language)


def _translate(value: Any, language: str) -> Any:
    if isinstance(value, dict):
        texts = TEXTS | {"text"} if value.get("event") in SPOKEN or not NOTED.isdisjoint(value) else TEXTS
        translation: dict[str, Any] = {}
        for key, item in value.items():
            if isinstance(item, str):
                translation[key] = translate(item, language) if key in texts and item not in KNOWN else item
            else:
                translation[key] = item if key in VALUES else _translate(item, language)
        if value.get("notes") and isinstance(value.get("why"), str):
            translation["why"] = _with_notes(value["why"], value["notes"], translation["notes"], language)
        return translation
    if isinstance(value, list | tuple) and value and not isinstance(value[0], int | float):
        return [_translate(item, language) for item in value]
    return value


def _with_notes(why: str, notes: Any, own: Any, language: str) -> str:
    """Return a reason that ends with the notes, so that it ends with them in the language too."""
    behind, behind_own = ("".join(f"; {note['text']}" for note in all_notes) for all_notes in (notes, own))
    if not why.endswith(behind):
        return translate(why, language)
    return translate(why.removesuffix(behind), language) + behind_own

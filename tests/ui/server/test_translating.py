"""Messages in a tab's language: what is said is translated, what stands in a document is not."""

from typing import Any

import pytest

from tangible_ui.feeling.recorder import BY_HAND
from tangible_ui.serving.translating import in_language, language_of

GONE, GONE_DE = "this file is gone", "diese Datei gibt es nicht mehr"
BROKE, BROKE_DE = "the upload broke off", "das Hochladen brach ab"


def test_english_message_is_sent_as_it_is():
    message = {"event": "error", "text": GONE, "checks": [{"sentence": BROKE}]}
    assert in_language(message, "en") is message


@pytest.mark.parametrize(("tag", "language"), [("de", "de"), ("en", "en"), ("xx", "en"), ("", "en"), ("DE", "en")])
def test_language_that_is_not_spoken_is_english(tag: str, language: str):
    assert language_of(tag) == language


@pytest.mark.parametrize("event", ["refused", "error", "log"])
def test_text_of_what_is_said_is_translated(event: str):
    message = {"event": event, "text": GONE, "number": 3}
    assert in_language(message, "de") == {"event": event, "text": GONE_DE, "number": 3}


@pytest.mark.parametrize(
    ("message", "german"),
    [
        ({"event": "document", "text": GONE}, None),  # the text of a file
        ({"name": GONE, "label": BROKE}, None),
        ({"values": {"title": GONE}, "names": [GONE], "said": {"why": BROKE}, "says": {"en": BROKE}}, None),
        *[({"why": why}, None) for why in ("asked", "button", "scene", "ended", BY_HAND)],
        ({"slow": [0.5, 1], "empty": [], "nothing": None, "wide": True}, None),
        ({"why": GONE}, {"why": GONE_DE}),
        ({"steps": [{"why": BROKE, "product": BROKE}]}, {"steps": [{"why": BROKE_DE, "product": BROKE}]}),
        ({"complaint": {"text": GONE, "location": ["a"]}}, {"complaint": {"text": GONE_DE, "location": ["a"]}}),
        ({"why": f"{GONE}; {BROKE}", "notes": [{"text": BROKE, "kind": "doubt"}]},
         {"why": f"{GONE_DE}; {BROKE_DE}", "notes": [{"text": BROKE_DE, "kind": "doubt"}]}),
        ({"why": GONE, "notes": [{"text": BROKE, "kind": "doubt"}]},
         {"why": GONE_DE, "notes": [{"text": BROKE_DE, "kind": "doubt"}]}),
        ({"why": GONE, "notes": []}, {"why": GONE_DE, "notes": []}),
    ],
)  # fmt: skip
def test_german_message_has_german_texts_alone(message: dict[str, Any], german: dict[str, Any] | None):
    assert in_language(message, "de") == (german or message)

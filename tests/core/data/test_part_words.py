"""Parts and segments have one number for people: their label plus one."""

import re
from pathlib import Path

from tangible_core.data.part_words import label_of_number, name_part, shown_number

HOUSE = Path(__file__).parents[3]
HELPERS = {"part_words.py", "part_words.ts"}
BARE = re.compile(r"\b(?:part|segment|Teil|Segment) \$?\{(?!name_part|shown_number|shownNumber)(\w+)")
"""A label that stands behind the noun in a text."""
SLOTS = {"number", "part"}
"""Slots of tables of words, which are filled with a shown number."""


def test_shown_number_counts_from_one_and_back():
    assert [shown_number(label) for label in range(3)] == [1, 2, 3]
    assert [label_of_number(shown_number(label)) for label in range(3)] == [0, 1, 2]


def test_no_text_names_a_part_by_its_label():
    rooms = [HOUSE / "tangible_core", *(HOUSE / "plugins").glob("*/tangible_*"), HOUSE / "plugins/ui/web/src"]
    files = [each for room in rooms for each in [*room.rglob("*.py"), *room.rglob("*.ts")] if each.name not in HELPERS]
    assert len(files) > 500
    found = [
        f"{path.relative_to(HOUSE)}: {match[0]}"
        for path in files
        for match in BARE.finditer(path.read_text(encoding="utf-8"))
        if not (match[1] in SLOTS and ("words" in path.name or "words" in path.parts))
    ]
    assert found == []


def test_label_in_a_text_would_be_found():
    assert BARE.search('f"part {number} is gone"') and BARE.search("`segment ${label}`")
    assert not BARE.search(f"{name_part(3)} is gone")

"""The page's names of materials are those that descriptions use."""

import json
import re

from page_files import WEB
from tangible_legibility.words.languages import LANGUAGES, TABLES

ROW = re.compile(r"^  (\w+): (\[.*\]),$", re.MULTILINE)


def test_page_names_materials_as_descriptions_do():
    rows = ROW.findall((WEB / "src/words/material_words.ts").read_text(encoding="utf-8"))
    found = {name: json.loads(words) for name, words in rows}
    assert found == {name: [TABLES[each].materials[name] for each in LANGUAGES] for name in TABLES["en"].materials}

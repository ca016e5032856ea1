"""English that was left in a text of another language."""

import re

SMALL = {
    "the", "of", "and", "is", "are", "not", "with", "for", "to", "it", "its", "this", "that", "which", "from", "by",
    "or", "be", "has", "have", "than", "each", "other", "only", "when", "where", "no",
}  # fmt: skip
"""Words that nearly every English sentence has, and German and French do not."""
QUOTED = re.compile(
    r"`[^`]*`|'[^'\n]*'|„[^“]*“|(?<!\w)[\w.~-]*/[\w./~-]*|\bQuellen?: .*|\w+://\S*|[\w-]*-[\w-]+"
    r"|\b\w+: \w+(?=[,\]}])|\{[^}]*\}"
)
"""Names and code, which are the same in every language: what is quoted, paths, sources, options, YAML."""
NAMES = (
    "Guidelines and Standards for Tactile Graphics",
    "Round Table on Information Access for People with Print Disabilities",
)


def english_of(text: str) -> list[str]:
    """Return the lines of a text that have English words."""
    found: list[str] = []
    for line in text.splitlines():
        rest = line
        for name in NAMES:
            rest = rest.replace(name, "")
        words = re.findall(r"\w+", QUOTED.sub(" ", rest))
        if not SMALL.isdisjoint(words) and not line.startswith(">>>"):
            found.append(line.strip())
    return found

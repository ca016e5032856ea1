"""The distribution that an entry point comes from: its name and version, without the parser of e-mail."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from importlib.metadata import Distribution

_HEADER = re.compile(r"^(Name|Version): *(.+?) *$", re.MULTILINE)


class Origin(NamedTuple):
    """A distribution; in words, its name and its version."""

    name: str
    version: str

    def __str__(self) -> str:
        return " ".join(self).rstrip()


@cache
def origin(distribution: Distribution | None) -> Origin:
    """Name and version, from the head of its metadata: `Distribution.name` parses all of it as an e-mail."""
    if distribution is None:
        return Origin("computed by a hook", "")
    text = distribution.read_text("METADATA") or distribution.read_text("PKG-INFO") or ""
    found = dict(_HEADER.findall(text.partition("\n\n")[0].replace("\r", "")))
    return Origin(found.get("Name", "?"), found.get("Version", "?"))

"""The distribution that an entry point comes from: its name and version, without the parser of e-mail."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from importlib.metadata import Distribution

_HEADER = re.compile(r"^(Name|Version): *(.+?) *$", re.MULTILINE)


class Origin(NamedTuple):
    """A distribution."""

    name: str
    version: str


@cache
def origin(distribution: Distribution) -> Origin:
    """Name and version, from the head of its metadata: `Distribution.name` parses all of it as an e-mail."""
    text = distribution.read_text("METADATA") or distribution.read_text("PKG-INFO") or ""
    found = dict(_HEADER.findall(text.partition("\n\n")[0].replace("\r", "")))
    return Origin(found.get("Name", "?"), found.get("Version", "?"))

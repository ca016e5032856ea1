"""What messages call a plugin's object: its kind, its name and its distribution, as far as metadata tells."""

from __future__ import annotations

import re
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import TYPE_CHECKING, Any, NamedTuple

from ..errors import BrokenMethod, what_is

if TYPE_CHECKING:
    from importlib.metadata import Distribution

KIND_NAMES = ("depth", "texture", "render", "device", "export")
GROUPS = "tangible."
"""How the groups of entry points begin; what follows is a kind, or `hooks`."""
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


def named(kind: str, module: str, owner: str) -> str:
    """What to call a class, or with no owner a function, of this module: `depth method zncc (tangible-images 0.1)`.

    It is the method itself, or the only one of its kind in its module or its package; else its package is named.
    """
    of_kind = [each for each in points() if kind in ("", _kind(each))]
    exact = [each for each in of_kind if each.value == f"{module}:{owner}"]
    beside = [each for each in of_kind if each.module == module]
    near = exact or beside or [each for each in of_kind if package(each.module) == package(module)]
    if not near:
        return f"{module}{owner and '.'}{owner}"
    if exact or len(near) == 1:
        return f"{_title(near[0])} ({origin(near[0].dist)})"
    return f"{owner or module} of {origin(near[0].dist)}"


def wrong_result(giver: object, kind: str, verb: str, found: Any, wanted: type) -> BrokenMethod:
    """Make the error of a verb whose result has another type than this; the message names the plugin."""
    who, gave = named(kind, type(giver).__module__, type(giver).__qualname__), what_is(found)
    return BrokenMethod(f"{who}: {verb} gave {gave}; it must give a {wanted.__name__}, as `tangible check` tests")


def points() -> list[EntryPoint]:
    """Of all plugins that are installed."""
    installed = entry_points()
    return [each for kind in (*KIND_NAMES, "hooks") for each in installed.select(group=f"{GROUPS}{kind}")]


def package(module: str) -> str:
    """The outermost package of a module."""
    return module.partition(".")[0]


def _kind(point: EntryPoint) -> str:
    return point.group.removeprefix(GROUPS)


def _title(point: EntryPoint) -> str:
    kind = _kind(point)
    return f"hooks {point.name}" if kind == "hooks" else f"{kind} method {point.name}"

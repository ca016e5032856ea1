"""The names of plugins in messages: kind, name and distribution, from metadata alone."""

from __future__ import annotations

import re
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import TYPE_CHECKING, Any, NamedTuple

from ..errors import BrokenMethod, what_is

if TYPE_CHECKING:
    from importlib.metadata import Distribution

KIND_NAMES = ("depth", "texture", "render", "device", "export")
GROUPS = "tangible."  # the prefix of our groups of entry points; a kind follows, or `hooks`
_HEADER = re.compile(r"^(Name|Version): *(.+?) *$", re.MULTILINE)


class Origin(NamedTuple):
    """The distribution of an entry point, shown as its name and its version."""

    name: str
    version: str

    def __str__(self) -> str:
        return " ".join(self).rstrip()


@cache
def origin(distribution: Distribution | None) -> Origin:
    """Return the name and version of a distribution."""
    if distribution is None:
        return Origin("computed by a hook", "")
    text = distribution.read_text("METADATA") or distribution.read_text("PKG-INFO") or ""
    header = dict(_HEADER.findall(text.partition("\n\n")[0].replace("\r", "")))
    return Origin(header.get("Name", "?"), header.get("Version", "?"))


def plugin_name(kind: str, module: str, owner: str) -> str:
    """Name the plugin of a class, or with no owner of a function: `depth method zncc (tangible-images 0.1)`."""
    of_kind = [point for point in points() if kind in ("", _kind(point))]
    exact = [each for each in of_kind if each.value == f"{module}:{owner}"]
    in_module = [each for each in of_kind if each.module == module]
    near = exact or in_module or [each for each in of_kind if package(each.module) == package(module)]
    if not near:
        return f"{module}{owner and '.'}{owner}"
    if exact or len(near) == 1:
        return f"{_title(near[0])} ({origin(near[0].dist)})"
    return f"{owner or module} of {origin(near[0].dist)}"


def wrong_result(giver: object, kind: str, verb: str, result: Any, cls: type) -> BrokenMethod:
    """Make the error for a plugin whose verb returned another type than `cls`."""
    name = plugin_name(kind, type(giver).__module__, type(giver).__qualname__)
    return BrokenMethod(
        f"{name}: {verb} gave {what_is(result)}; it must give a {cls.__name__}, as `tangible check` tests"
    )


def points() -> list[EntryPoint]:
    """Return the entry points of all installed plugins."""
    all_points = entry_points()
    return [point for kind in (*KIND_NAMES, "hooks") for point in all_points.select(group=f"{GROUPS}{kind}")]


def package(module: str) -> str:
    """Return the outermost package of a module."""
    return module.partition(".")[0]


def _kind(point: EntryPoint) -> str:
    return point.group.removeprefix(GROUPS)


def _title(point: EntryPoint) -> str:
    kind = _kind(point)
    return f"hooks {point.name}" if kind == "hooks" else f"{kind} method {point.name}"

"""The functions that judge and simplify parts for fingers: another package names them by the hook
`tangible_legibility`."""

from collections.abc import Callable
from importlib.metadata import EntryPoint
from typing import Any, Literal

from ...data import PartMap
from ...errors import BrokenMethod, shown
from ...plugins import hooks
from ...plugins.registry import Registry
from ...preflight import Legibility
from ...runtime.failure_log import where_kept

HOOK = "tangible_legibility"


def legibility_point(registry: Registry, name: Literal["judge", "simplify"]) -> EntryPoint:
    """Find the function of this name without importing it; the first of several. Raises: BrokenMethod for none."""
    for answer in hooks.tell(registry.plugins, HOOK):
        if isinstance(answer, dict) and isinstance(value := answer.get(name), str):  # pyright: ignore[reportUnknownMemberType, reportUnknownVariableType]
            return EntryPoint(name, value, HOOK)
    raise BrokenMethod(f"no hook {HOOK} names a function to {name} parts for fingers; reinstall tangible-images")


def judge_function(registry: Registry) -> Callable[..., Legibility]:
    """Import the function that judges the parts on a medium. Raises: BrokenMethod."""
    return _load(legibility_point(registry, "judge"))


def simplify_function(registry: Registry) -> Callable[..., PartMap]:
    """Import the function that makes parts legible. Raises: BrokenMethod."""
    return _load(legibility_point(registry, "simplify"))


def _load(point: EntryPoint) -> Any:
    try:
        return point.load()
    except (Exception, SystemExit) as error:
        raise BrokenMethod(
            f"{point.value}, which {HOOK} names to {point.name} parts, cannot be loaded: {type(error).__name__}: "
            f"{shown(str(error), 500)}; {where_kept(error)}"
        ) from error

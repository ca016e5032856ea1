"""Functions that other packages name by a hook, imported when they are called for."""

from collections.abc import Callable
from importlib.metadata import EntryPoint
from typing import Any, Literal

from ...data import PartMap
from ...errors import BrokenMethod, shown
from ...plugins import hooks
from ...plugins.registry import Registry
from ...preflight import Legibility
from ...runtime.failure_log import where_kept


def hooked_point(registry: Registry, hook: str, name: str, purpose: str) -> EntryPoint:
    """Find the function that a hook names, without importing it; `purpose` is for the message."""
    for answer in hooks.tell(registry.plugins, hook):
        if isinstance(answer, dict) and isinstance(value := answer.get(name), str):  # pyright: ignore[reportUnknownMemberType, reportUnknownVariableType]
            return EntryPoint(name, value, hook)
    raise BrokenMethod(f"no hook {hook} names a function to {purpose}; reinstall tangible-images")


def load_hooked(point: EntryPoint, purpose: str) -> Any:
    """Import a function that a hook names. Raises: BrokenMethod."""
    try:
        return point.load()
    except (Exception, SystemExit) as error:
        raise BrokenMethod(
            f"{point.value}, which {point.group} names to {purpose}, cannot be loaded: {type(error).__name__}: "
            f"{shown(str(error), 500)}; {where_kept(error)}"
        ) from error


HOOK = "tangible_legibility"


def legibility_point(registry: Registry, name: Literal["judge", "simplify"]) -> EntryPoint:
    """Find the function of this name without importing it; the first of several. Raises: BrokenMethod for none."""
    return hooked_point(registry, HOOK, name, f"{name} parts for fingers")


def judge_function(registry: Registry) -> Callable[..., Legibility]:
    """Import the function that judges the parts on a medium. Raises: BrokenMethod."""
    return _load(legibility_point(registry, "judge"))


def simplify_function(registry: Registry) -> Callable[..., PartMap]:
    """Import the function that makes parts legible. Raises: BrokenMethod."""
    return _load(legibility_point(registry, "simplify"))


def _load(point: EntryPoint) -> Any:
    return load_hooked(point, f"{point.name} parts")

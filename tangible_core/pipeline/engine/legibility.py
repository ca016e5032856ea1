"""The functions that judge and simplify parts for fingers: another package names them by the hook
`tangible_legibility`."""

from collections.abc import Callable
from importlib.metadata import EntryPoint
from typing import Any, Literal

from ...data import PartMap
from ...plugins.registry import Registry
from ...preflight import Legibility
from .hooked import hooked_point, load_hooked

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

"""Functions that other packages name by a hook, imported when they are called for."""

from collections.abc import Callable
from importlib.metadata import EntryPoint
from typing import Any, Literal

from ...data import Figure, PartMap, PictureText
from ...errors import BrokenMethod, shown
from ...plugins import hooks
from ...plugins.registry import Registry
from ...preflight import Legibility
from ...runtime.failure_log import where_kept
from ..config.model import PipelineConfig


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


NETWORKS_HOOK, LOOK, READ = "tangible_networks", "look at a photograph", "read texts"


def look_function(registry: Registry) -> Callable[..., Figure]:
    """Import the function that returns what networks see in a picture; tasks, if not all, are its second argument."""
    return load_hooked(hooked_point(registry, NETWORKS_HOOK, "look", LOOK), LOOK)


def networks_identity(registry: Registry, *tasks: str) -> str:
    """Return a text that differs wherever networks for these tasks may see something else; "" without one."""
    purpose = "tell which networks are here"
    return load_hooked(hooked_point(registry, NETWORKS_HOOK, "identity", purpose), purpose)(*tasks)


def read_function(registry: Registry) -> Callable[..., tuple[PictureText, ...]]:
    """Import the function that returns the texts of a picture, its second argument, with what they say."""
    return load_hooked(hooked_point(registry, NETWORKS_HOOK, "read", READ), READ)


def has_figure(config: PipelineConfig, registry: Registry) -> bool:
    """Return True where the relief is made of what networks see, and some are here: other products use it then."""
    return config.relief_kind == "figure" and bool(networks_identity(registry))

"""The function that looks at a photograph with networks: another package names it by the hook `tangible_networks`."""

from collections.abc import Callable

from ...data import Figure, PictureText
from ...plugins.registry import Registry
from ..config.model import PipelineConfig
from .hooked import hooked_point, load_hooked

HOOK, LOOK, READ = "tangible_networks", "look at a photograph", "read texts"


def look_function(registry: Registry) -> Callable[..., Figure]:
    """Import the function that returns what networks see in a picture; tasks, if not all, are its second argument."""
    return load_hooked(hooked_point(registry, HOOK, "look", LOOK), LOOK)


def networks_identity(registry: Registry, *tasks: str) -> str:
    """Return a text that differs wherever networks for these tasks may see something else; "" without one."""
    purpose = "tell which networks are here"
    return load_hooked(hooked_point(registry, HOOK, "identity", purpose), purpose)(*tasks)


def read_function(registry: Registry) -> Callable[..., tuple[PictureText, ...]]:
    """Import the function that returns the texts of a picture, its second argument, with what they say.

    Raises: BrokenMethod.
    """
    return load_hooked(hooked_point(registry, HOOK, "read", READ), READ)


def has_figure(config: PipelineConfig, registry: Registry) -> bool:
    """Return True where the relief is made of what networks see, and some are here: other products use it then."""
    return config.relief_kind == "figure" and bool(networks_identity(registry))

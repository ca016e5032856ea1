"""The function that looks at a photograph with networks: another package names it by the hook `tangible_networks`."""

from collections.abc import Callable

import numpy as np

from ...data import Figure
from ...plugins.registry import Registry
from ..config.model import PipelineConfig
from .hooked import hooked_point, load_hooked

HOOK, LOOK = "tangible_networks", "look at a photograph"


def look_function(registry: Registry) -> Callable[[np.ndarray], Figure]:
    """Import the function that returns what networks see in a picture. Raises: BrokenMethod."""
    return load_hooked(hooked_point(registry, HOOK, "look", LOOK), LOOK)


def networks_identity(registry: Registry) -> str:
    """Return a text that differs wherever networks may see something else. Raises: BrokenMethod."""
    purpose = "tell which networks are here"
    return load_hooked(hooked_point(registry, HOOK, "identity", purpose), purpose)()


def has_figure(config: PipelineConfig, registry: Registry) -> bool:
    """Return True where the relief is made of what networks see, and some are here: other products use it then."""
    return config.relief_kind == "figure" and bool(networks_identity(registry))

"""All that a script needs: the core, and the methods of every family; each is imported at its first use.

>>> import tangible
>>> tangible.Pipeline(tangible.Scene.heights([[0, 1]]), render=tangible.Proxy())
Pipeline('arrays', want='touch', render='proxy')

`Report`, which is a name in two families, stays in `tangible_depth` and `tangible_texture`.
"""

from collections import Counter
from importlib import import_module
from importlib.metadata import version
from typing import Any

from tangible_core.errors import did_you_mean

FAMILIES = (
    "tangible_core",
    "tangible_depth",
    "tangible_texture",
    "tangible_render",
    "tangible_devices",
    "tangible_export",
)
"""The packages whose names are here."""
_NAMES = [(name, family) for family in FAMILIES for name in import_module(family).__all__]
_TIMES = Counter(name for name, _ in _NAMES)
_PLACES = {name: family for name, family in _NAMES if _TIMES[name] == 1}

__all__ = sorted(_PLACES)  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return version("tangible-images")
    if name not in _PLACES:
        raise AttributeError(f"module 'tangible' has no attribute {name!r}{did_you_mean(name, _PLACES)}")
    return getattr(import_module(_PLACES[name]), name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]

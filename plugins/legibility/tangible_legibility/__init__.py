"""Legibility for fingers: the rules of tactile graphics, and parts that are simplified until they meet them."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from tangible_core.lazily import lazily

if TYPE_CHECKING:
    from .legible import legibility as legibility
    from .legible import sizes as sizes
    from .neighbours import apart as apart
    from .rules import PROFILES as PROFILES
    from .rules import Profile as Profile
    from .rules import Rule as Rule
    from .simplifying.simplify import simplify as simplify

ROOMS: dict[str, list[str]] = {
    "legible": ["legibility", "sizes"],
    "neighbours": ["apart"],
    "rules": ["PROFILES", "Profile", "Rule"],
    "simplifying.simplify": ["simplify"],
}
"""The modules of the package's names, each imported on the first use of one."""
__getattr__: Callable[[str], Any]
__all__, __getattr__ = lazily(__name__, ROOMS)  # pyright: ignore[reportUnsupportedDunderAll]

"""Exporters: what was made of a picture, as files for printers, swell paper, pin displays and readers.

Each is imported when it is first used.
"""

from typing import TYPE_CHECKING

from tangible_core.lazily import lazily

if TYPE_CHECKING:
    from .heights import Heights as Heights
    from .text import Text as Text

__all__, __getattr__ = lazily(  # pyright: ignore[reportUnsupportedDunderAll]
    __name__,
    {
        "heights": ["Heights"],
        "text": ["Text"],
    },
)

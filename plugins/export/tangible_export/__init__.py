"""Exporters: what was made of a picture, as files for printers, swell paper, pin displays and readers.

Each is imported when it is first used.
"""

from tangible_core.lazily import lazily

__all__, __getattr__ = lazily(  # pyright: ignore[reportUnsupportedDunderAll]
    __name__,
    {},
)

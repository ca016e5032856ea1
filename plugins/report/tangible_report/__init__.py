"""Two exporters, each imported on first use: a run as a sheet of pictures, and a surface in words."""

from typing import TYPE_CHECKING

from tangible_core.lazily import lazily

if TYPE_CHECKING:
    from .sheet import Sheet as Sheet
    from .text import Text as Text

__all__, __getattr__ = lazily(__name__, {"sheet": ["Sheet"], "text": ["Text"]})  # pyright: ignore[reportUnsupportedDunderAll]

"""Batches: many scenes through one pipeline (an archive, a dataset, a sweep), on all cores or on many machines."""

from typing import TYPE_CHECKING

from tangible_core.lazily import lazily

if TYPE_CHECKING:
    from .running import batch as batch

__all__, __getattr__ = lazily(__name__, {"running": ["batch"]})  # pyright: ignore[reportUnsupportedDunderAll]

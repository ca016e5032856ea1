"""Requests about the surface on the screen: a fine texture at a place, a description in words."""

from typing import Any, Literal

from ..state.session import Session, Tab
from .table import request


@request()
async def texture_patch(
    session: Session, tab: Tab | None, digest: str, x_m: float, y_m: float, side_m: float, pixels: int = 192
) -> dict[str, Any]:
    """Write the heights of the textures in a square around a place; return where a tab fetches them."""
    return await session.worker.ask("texture_patch", digest=digest, x_m=x_m, y_m=y_m, side_m=side_m, pixels=pixels)


@request()
async def description(session: Session, tab: Tab | None, language: Literal["en", "de", "fr"]) -> dict[str, Any] | None:
    """Describe the surface on the screen at length, as text and as HTML; None without a surface."""
    return await session.worker.quick("description", language=language)

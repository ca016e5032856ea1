"""What a tab looks at: a fine texture at a place."""

from typing import Any

from ..desk.desk import Desk, Tab


async def texture_patch(
    desk: Desk, tab: Tab | None, digest: str, x_m: float, y_m: float, side_m: float, pixels: int = 192
) -> dict[str, Any]:
    """Where a tab fetches the heights of the textures in a square round a place."""
    return await desk.maker.ask("texture_patch", digest=digest, x_m=x_m, y_m=y_m, side_m=side_m, pixels=pixels)


ASKS = {"texture_patch": texture_patch}

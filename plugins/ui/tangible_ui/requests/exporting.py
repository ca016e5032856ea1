"""Hand the document on: files for others, and whether fingers can read it."""

from typing import Any

from tangible_core.plugins.interfaces import Medium

from ..state.session import Desk, Tab
from .making import long_job


async def export(desk: Desk, tab: Tab | None, exports: list[dict[str, Any] | str]) -> dict[str, Any] | None:
    """Write files of the document as it is on the screen; None if it was stopped.

    exports: as `export:` of a pipeline file has them. Raises: ConfigError for what none can be.
    """
    return await long_job(desk, "export", "surface", sets=desk.sets, exports=exports)


async def export_zip(desk: Desk, tab: Tab | None, folder: str) -> str:
    """Pack what was exported into one file; its name in the same folder. Raises: ConfigError if it is gone."""
    return await desk.maker.quick("export_zip", folder=folder)


async def legible(desk: Desk, tab: Tab | None, medium: Medium, width_m: float | None = None) -> dict[str, Any] | None:
    """Judge the document by the rules of one medium; None if it was stopped.

    width_m: of the whole picture there; that of the workspace without one.
    """
    return await long_job(desk, "legible", "parts", sets=desk.sets, medium=medium, width_m=width_m)


ASKS = {"export": export, "export_zip": export_zip, "legible": legible}

"""Requests to export files for others."""

from typing import Any

from ..state.session import Session, Tab
from .making import long_job
from .table import request


@request()
async def export(session: Session, tab: Tab | None, exports: list[dict[str, Any] | str]) -> dict[str, Any] | None:
    """Write files of the document as it is on the screen; None if it was stopped.

    exports: as `export:` of a pipeline file has them. Raises: ConfigError for invalid ones.
    """
    return await long_job(session, "export", "surface", sets=session.sets, exports=exports)


@request()
async def export_preview(session: Session, tab: Tab | None, block: dict[str, Any] | str) -> dict[str, Any]:
    """Draw what an exporter would write, for pages to show before anything is written. Raises: TangibleError.

    block: an item of `export:`.
    """
    return await session.worker.quick("export_preview", **session.document(), block=block)


@request()
async def export_zip(session: Session, tab: Tab | None, folder: str) -> str:
    """Pack exported files into one; return its name in the same folder. Raises: ConfigError if they are gone."""
    return await session.worker.quick("export_zip", folder=folder)

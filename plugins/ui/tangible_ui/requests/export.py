"""Requests to export files for others."""

from typing import Any

from ..state.session import Session
from ..state.tabs import Tab
from .making import long_job
from .table import request


@request()
async def export(session: Session, tab: Tab | None, exports: list[dict[str, Any] | str]) -> dict[str, Any] | None:
    """Write files of the document as it is on the screen; None if it was stopped.

    exports: as `export:` of a pipeline file has them. Raises: ConfigError for invalid ones.
    """
    return await long_job(session, "export", "surface", sets=session.document.sets, exports=exports)

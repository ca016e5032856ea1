"""Requests that a tab may send, by name: one module per topic, each with its table."""

from collections.abc import Awaitable, Callable, Mapping
from typing import Any

from . import devices, document, export, feeling, making, parts, preflight, records, surface

Ask = Callable[..., Awaitable[Any]]
"""Called with the desk, the tab, and what the tab says by name; the tab is answered with what it returns, as JSON."""

ASKS: Mapping[str, Ask] = {
    **devices.ASKS,
    **document.ASKS,
    **export.ASKS,
    **feeling.ASKS,
    **making.ASKS,
    **parts.ASKS,
    **preflight.ASKS,
    **records.ASKS,
    **surface.ASKS,
}

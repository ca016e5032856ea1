"""What a tab may ask for, by name: one file each topic, each with its table."""

from collections.abc import Awaitable, Callable, Mapping
from typing import Any

from . import (
    beacons,
    devices,
    document,
    drafts,
    exporting,
    feeling,
    laws,
    making,
    mapping,
    opening,
    parts,
    preflight,
    records,
    seeing,
)

Ask = Callable[..., Awaitable[Any]]
"""Called with the desk, the tab, and what the tab says by name; the tab is answered with what it returns, as JSON."""

ASKS: Mapping[str, Ask] = {
    **document.ASKS,
    **drafts.ASKS,
    **making.ASKS,
    **seeing.ASKS,
    **preflight.ASKS,
    **exporting.ASKS,
    **mapping.ASKS,
    **feeling.ASKS,
    **beacons.ASKS,
    **opening.ASKS,
    **records.ASKS,
    **devices.ASKS,
    **laws.ASKS,
    **parts.ASKS,
}

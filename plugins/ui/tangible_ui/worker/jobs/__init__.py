"""Everything the maker can be asked, by name."""

from ..parts import heights as felt_parts
from ..parts import opening as parts
from ..parts import outlines as snapping
from ..parts import proposals
from ..parts import saving as saved_parts
from . import (
    beacons,
    checking,
    describing,
    devices,
    exporting,
    laws,
    legible,
    making,
    mapping,
    opening,
    preflight,
    records,
    textures,
)

JOBS = {
    **making.JOBS,
    **checking.JOBS,
    **mapping.JOBS,
    **opening.JOBS,
    **describing.JOBS,
    **preflight.JOBS,
    **exporting.JOBS,
    **legible.JOBS,
    **records.JOBS,
    **devices.JOBS,
    **textures.JOBS,
    **laws.JOBS,
    **mapping.JOBS,
    **parts.JOBS,
    **saved_parts.JOBS,
    **proposals.JOBS,
    **snapping.JOBS,
    **felt_parts.JOBS,
    **beacons.JOBS,
}

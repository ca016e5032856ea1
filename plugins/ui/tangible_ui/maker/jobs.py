"""Everything the maker can be asked, by name."""

from . import (
    beacons,
    checking,
    devices,
    felt_parts,
    laws,
    making,
    mapping,
    opening,
    parts,
    preflight,
    proposals,
    records,
    saved_parts,
    snapping,
    textures,
)

JOBS = {
    **making.JOBS,
    **checking.JOBS,
    **mapping.JOBS,
    **opening.JOBS,
    **preflight.JOBS,
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

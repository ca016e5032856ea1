"""Jobs of the worker, by name: one module per topic, each with its table."""

from . import devices, document, export, feeling, making, parts, preflight, records, surface

JOBS = {
    **devices.JOBS,
    **document.JOBS,
    **export.JOBS,
    **feeling.JOBS,
    **making.JOBS,
    **parts.JOBS,
    **preflight.JOBS,
    **records.JOBS,
    **surface.JOBS,
}

"""Everything the maker can be asked, by name."""

from . import checking, making, preflight

JOBS = {**making.JOBS, **checking.JOBS, **preflight.JOBS}

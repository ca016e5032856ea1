"""Everything the maker can be asked, by name."""

from . import checking, devices, making, opening

JOBS = {**making.JOBS, **checking.JOBS, **opening.JOBS, **devices.JOBS}

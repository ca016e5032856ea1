"""Everything the maker can be asked, by name."""

from . import checking, devices, making, opening, records

JOBS = {**making.JOBS, **checking.JOBS, **opening.JOBS, **records.JOBS, **devices.JOBS}

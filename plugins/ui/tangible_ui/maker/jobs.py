"""Everything the maker can be asked, by name."""

from . import checking, making, mapping, opening, records

JOBS = {**making.JOBS, **checking.JOBS, **mapping.JOBS, **opening.JOBS, **records.JOBS}

"""Everything the maker can be asked, by name."""

from . import checking, making, opening

JOBS = {**making.JOBS, **checking.JOBS, **opening.JOBS}

"""Everything the maker can be asked, by name."""

from . import checking, making

JOBS = {**making.JOBS, **checking.JOBS}

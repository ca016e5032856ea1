"""Everything the maker can be asked, by name."""

from . import checking, making, opening, textures

JOBS = {**making.JOBS, **checking.JOBS, **opening.JOBS, **textures.JOBS}

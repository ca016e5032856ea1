"""Many scenes through one pipeline: an archive, a dataset, a sweep of options; on all cores, or on many machines."""

from .running import batch

__all__ = ["batch"]

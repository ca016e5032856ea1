"""Many scenes through one pipeline: an archive, a dataset, a sweep of options; on all cores, or on many machines."""

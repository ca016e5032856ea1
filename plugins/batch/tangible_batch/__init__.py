"""Batches: many scenes through one pipeline (an archive, a dataset, a sweep), on all cores or on many machines."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Two exporters, each imported on first use: a run as a sheet of pictures, and a surface in words."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

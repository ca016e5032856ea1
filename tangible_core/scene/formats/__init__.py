"""Readers of the formats that a scene may be in: pictures, maps, pairs, phone photos, height maps, calibrations."""

import lazy_loader  # pyright: ignore[reportMissingTypeStubs]

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)  # pyright: ignore[reportUnknownVariableType]

"""A session joins a touch and a device: the loop, and what it records."""

import lazy_loader  # pyright: ignore[reportMissingTypeStubs]

# files of this room have the same names: the last to be imported would win
from .parts_felt import parts_felt as parts_felt
from .tracking_error import tracking_error as tracking_error

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)  # pyright: ignore[reportUnknownVariableType]
